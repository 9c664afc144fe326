#include "cli/fit_cache.h"

#include <algorithm>
#include <map>
#include <set>

#include "formats/obj_lines.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

PointCache read_cache(const std::filesystem::path& path, double fps) {
  PointCache cache;
  cache.bytes = formats::read_bytes(path);
  const auto fail = [&](const std::string& what) { throw Error("'" + path.string() + "': " + what); };
  if (cache.bytes.size() >= 32 && std::memcmp(cache.bytes.data(), "POINTCACHE2", 12) == 0) {
    cache.points = cache.word(16);
    cache.frames = cache.word(28);
    cache.first = 32;
    for (size_t f = 0; f < cache.frames && f < cache.bytes.size(); ++f)
      cache.times.push_back(static_cast<double>(f) / fps);
  } else if (extension_of(path) == ".mdd" && cache.bytes.size() >= 8) {
    cache.is_big_endian = true;
    cache.frames = cache.word(0);
    cache.points = cache.word(4);
    cache.first = 8 + 4 * cache.frames;
    for (size_t f = 0; f < cache.frames && 12 + 4 * f <= cache.bytes.size(); ++f)
      cache.times.push_back(cache.real(8 + 4 * f));
  } else {
    fail("it is not a PC2 or MDD point cache");
  }
  if (cache.frames == 0 || cache.points == 0) fail("the point cache holds no frames");
  if ((cache.bytes.size() - std::min(cache.bytes.size(), cache.first)) / 12 / cache.points < cache.frames)
    fail("the point cache is shorter than its header says: it is damaged or truncated");
  for (size_t f = 1; f < cache.times.size(); ++f)
    if (!(cache.times[f] > cache.times[f - 1])) fail("the times of its frames do not rise");
  return cache;
}

namespace {

/// An object of the rig's source whose vertices a cache may hold: OBJ files count each `v` once.
struct CachePart {
  size_t points = 0;
  std::vector<Match> matches;
};

std::vector<CachePart> cache_parts(const fit::Subject& subject) {
  std::map<uint32_t, CachePart> parts;
  const rig::RigFile& file = subject.file();
  formats::Scene source;
  if (file.source.format == "obj") source = formats::read("source.obj", file.source.bytes);
  for (size_t p = 0; p < file.primitives.size(); ++p) {
    const uint32_t mesh = file.primitives[p].mesh;
    CachePart& part = parts[mesh];
    const size_t count = file.primitives[p].positions.size();
    Match match{p, mesh, counted(part.points, count)};
    if (mesh < source.meshes.size() && source.meshes[mesh].source_vertices.size() >= count) {
      const std::vector<int>& lines = source.meshes[mesh].source_vertices;
      const std::set<int> sorted(lines.begin(), lines.end());
      const std::vector<int> order(sorted.begin(), sorted.end());
      for (size_t v = 0; v < count; ++v)
        match.point[v] =
            static_cast<uint32_t>(std::lower_bound(order.begin(), order.end(), lines[v]) - order.begin());
      part.points = order.size();
    } else {
      part.points += count;
    }
    part.matches.push_back(std::move(match));
  }
  std::vector<CachePart> list;
  for (auto& [mesh, part] : parts)
    list.push_back(std::move(part));
  return list;
}

/// The rig's vertices among all `v` lines of its OBJ source, where there are `points` of them; else none.
std::vector<Match> obj_matches(size_t points, const fit::Subject& subject) {
  const rig::RigFile& file = subject.file();
  if (file.source.format != "obj") return {};
  const std::string text(file.source.bytes.begin(), file.source.bytes.end());
  if (formats::obj_vertices(text).size() != points) return {};
  const formats::Scene source = formats::read("source.obj", file.source.bytes);
  std::vector<Match> found;
  for (size_t p = 0; p < file.primitives.size(); ++p) {
    const size_t mesh = file.primitives[p].mesh, count = file.primitives[p].positions.size();
    if (mesh >= source.meshes.size() || source.meshes[mesh].source_vertices.size() < count) continue;
    const std::vector<int>& lines = source.meshes[mesh].source_vertices;
    found.push_back({p, mesh, {lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(count)}});
  }
  return found;
}

}  // namespace

std::vector<Match> cache_matches(const std::filesystem::path& path, size_t points,
                                 const fit::Subject& subject) {
  if (std::vector<Match> whole = obj_matches(points, subject); !whole.empty()) return whole;
  const std::vector<CachePart> parts = cache_parts(subject);
  std::vector<Match> all;
  size_t sum = 0;
  for (const CachePart& part : parts) {
    for (Match match : part.matches) {
      for (uint32_t& point : match.point)
        point += static_cast<uint32_t>(sum);
      all.push_back(std::move(match));
    }
    sum += part.points;
  }
  if (sum == points) return all;
  const CachePart* found = nullptr;
  for (const CachePart& part : parts) {
    if (part.points != points) continue;
    if (found != nullptr)
      throw Error("'" + path.string() + "': more than one of the rig's meshes has its " +
                  std::to_string(points) + " points: give a cache of all meshes");
    found = &part;
  }
  if (found == nullptr) fail_topology(path, subject, "has " + std::to_string(points) + " points a frame");
  return found->matches;
}

}  // namespace fascia::cli
