#include "cli/fit_cache.h"

#include <algorithm>
#include <map>
#include <set>

#include "cli/take/point_cache.h"
#include "formats/obj_lines.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

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

/// An object of the rig's source whose vertices a cache may hold: OBJ files count each `v` once.
struct CachePart {
  std::string name;
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
    part.name = file.primitives[p].name;
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

/// What a cache of `points` points holds: the whole OBJ, one object, or all of them one after the other.
std::vector<Match> cache_matches(const std::filesystem::path& path, size_t points,
                                 const std::vector<CachePart>& parts, const fit::Subject& subject) {
  const CachePart* found = nullptr;
  for (const CachePart& part : parts) {
    if (part.points != points) continue;
    if (found != nullptr)
      throw Error("'" + path.string() + "': more than one of the rig's meshes has its " +
                  std::to_string(points) +
                  " points: give a cache of all meshes, or name it after its mesh, " +
                  cache_paths(path, {part.name, found->name}).front().filename().string());
    found = &part;
  }
  if (found == nullptr) fail_topology(path, subject, "has " + std::to_string(points) + " points a frame");
  return found->matches;
}

/// The rig's vertices in a cache of all objects, or of the whole OBJ; none where it is of another size.
std::vector<Match> whole_matches(size_t points, const std::vector<CachePart>& parts,
                                 const fit::Subject& subject) {
  if (std::vector<Match> whole = obj_matches(points, subject); !whole.empty()) return whole;
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
  return sum == points ? all : std::vector<Match>();
}

/// The files of the set that `path` is one of, or the common name of; none where it is neither.
std::vector<std::filesystem::path> cache_set(const std::filesystem::path& path,
                                             const std::vector<CachePart>& parts) {
  if (parts.size() < 2) return {};
  std::vector<std::string> names;
  for (const CachePart& part : parts)
    names.push_back(part.name);
  std::error_code status;
  const auto is_there = [&](const std::filesystem::path& file) {
    return std::filesystem::exists(file, status);
  };
  std::vector<std::filesystem::path> set = cache_paths(path, names);
  if (!is_there(path)) return std::any_of(set.begin(), set.end(), is_there) ? set : decltype(set)();
  set = cache_paths(path.parent_path() / (path.stem().stem().string() + path.extension().string()), names);
  return std::find(set.begin(), set.end(), path) != set.end() ? set : decltype(set)();
}

std::vector<FitCache> read_set(const Common& common, const std::vector<std::filesystem::path>& set,
                               double fps, const std::vector<CachePart>& parts, const fit::Subject& subject) {
  std::vector<FitCache> caches;
  const std::filesystem::path* first = nullptr;
  std::string missing;
  std::error_code status;
  for (size_t i = 0; i < set.size(); ++i) {
    if (!std::filesystem::exists(set[i], status)) {
      missing += (missing.empty() ? "'" : ", '") + set[i].filename().string() + "'";
      continue;
    }
    PointCache cache = read_cache(set[i], fps);
    if (cache.points != parts[i].points)
      fail_topology(set[i], subject,
                    "has " + std::to_string(cache.points) + " points a frame, the rig's mesh '" +
                        parts[i].name + "' " + std::to_string(parts[i].points));
    if (first == nullptr) {
      first = &set[i];
    } else if (cache.times != caches.front().cache.times) {
      throw Error("'" + set[i].string() + "' has " + std::to_string(cache.frames) + " frames, '" +
                  first->string() + "' " + std::to_string(caches.front().cache.frames) +
                  ", or other times: give the caches of one take");
    }
    caches.push_back({std::move(cache), parts[i].matches});
  }
  if (!missing.empty())
    common.warn("not there: " + missing + "; what moves those meshes is judged by the others");
  return caches;
}

}  // namespace

std::vector<FitCache> open_caches(const Common& common, const std::filesystem::path& path, double fps,
                                  const fit::Subject& subject) {
  const std::vector<CachePart> parts = cache_parts(subject);
  const std::vector<std::filesystem::path> set = cache_set(path, parts);
  std::error_code status;
  if (set.empty() || std::filesystem::exists(path, status)) {
    FitCache one{read_cache(path, fps), {}};
    one.matches = whole_matches(one.cache.points, parts, subject);
    if (one.matches.empty() && set.empty())
      one.matches = cache_matches(path, one.cache.points, parts, subject);
    std::vector<FitCache> caches;
    if (!one.matches.empty()) {
      caches.push_back(std::move(one));
      return caches;
    }
  }
  return read_set(common, set, fps, parts, subject);
}

}  // namespace fascia::cli
