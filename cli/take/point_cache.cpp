#include "cli/take/point_cache.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <map>
#include <set>

#include "builder/rigging/gltf_source.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/read/read.h"

namespace fascia::cli {

namespace {

uint32_t swapped(uint32_t word) {
  return word << 24 | (word & 0xFF00) << 8 | (word >> 8 & 0xFF00) | word >> 24;
}

std::span<const uint8_t> bytes_of(const void* data, size_t size) {
  return {static_cast<const uint8_t*>(data), size};
}

/// A mesh's name as part of a file's.
std::string file_word(const std::string& name, size_t index) {
  std::string word;
  for (const char c : name)
    word += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
  return word.empty() ? "mesh_" + std::to_string(index) : word;
}

/// Of an OBJ's object each vertex once, in the file's order; its corners may have split it.
void in_source_order(const formats::SceneMesh& mesh, CachedObject& object) {
  std::map<int, CachedObject::Point> by_source;
  for (const CachedObject::Point& point : object.points)
    if (point.vertex < mesh.source_vertices.size())
      by_source.emplace(mesh.source_vertices[point.vertex], point);
  object.points.clear();
  for (const auto& [source, point] : by_source)
    object.points.push_back(point);
}

}  // namespace

std::vector<std::filesystem::path> cache_paths(const std::filesystem::path& path,
                                               const std::vector<std::string>& names) {
  if (names.size() < 2) return {path};
  std::vector<std::filesystem::path> paths;
  std::set<std::string> words;
  for (size_t i = 0; i < names.size(); ++i) {
    std::string word = file_word(names[i], i);
    if (!words.insert(word).second) words.insert(word += "_" + std::to_string(i));
    paths.push_back(path);
    paths.back().replace_extension("." + word + path.extension().string());
  }
  return paths;
}

std::vector<CachedObject> cached_objects(const Common& common, const std::filesystem::path& rig,
                                         const Face& face) {
  std::map<uint32_t, CachedObject> by_mesh;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    CachedObject& object = by_mesh[face.meshes()[m].mesh];
    object.name = face.meshes()[m].name;
    for (uint32_t v = 0; v < face.meshes()[m].vertex_count; ++v)
      object.points.push_back({m, v});
  }
  const rig::RigFile file = rig::read(formats::read_bytes(rig), rig.string());
  if (const Vec3 offset = rigging::input_offset(file.source); !offset.isZero(0)) {
    char line[200];
    std::snprintf(line, sizeof line,
                  "the head lies far off: a cache, in single precision, is written at the origin; move it by "
                  "%.9g %.9g %.9g",
                  offset.x(), offset.y(), offset.z());
    common.warn(line);
  }
  if (file.source.format == "obj") {
    const formats::Scene scene = formats::read("source.obj", file.source.bytes);
    for (auto& [mesh, object] : by_mesh)
      if (mesh < scene.meshes.size()) in_source_order(scene.meshes[mesh], object);
  }
  std::vector<CachedObject> objects;
  for (auto& [mesh, object] : by_mesh)
    objects.push_back(std::move(object));
  return objects;
}

bool is_cache(const std::filesystem::path& path, CacheKind& kind) {
  const std::string extension = extension_of(path);
  if (extension == ".pc2")
    kind = CacheKind::pc2;
  else if (extension == ".mdd")
    kind = CacheKind::mdd;
  else
    return false;
  return true;
}

PointCaches::PointCaches(const std::filesystem::path& path, CacheKind kind, std::vector<CachedObject> objects,
                         const std::vector<float>& times)
    : kind_(kind), frames_(times.size()) {
  std::vector<std::string> names;
  for (const CachedObject& object : objects)
    names.push_back(object.name);
  const std::vector<std::filesystem::path> paths = cache_paths(path, names);
  for (size_t i = 0; i < objects.size(); ++i)
    files_.push_back({paths[i], std::move(objects[i]), formats::NewFile(paths[i])});
  for (File& file : files_) {
    const auto points = static_cast<uint32_t>(file.object.points.size());
    const auto frames = static_cast<uint32_t>(frames_);
    if (kind_ == CacheKind::pc2) {
      const uint32_t version = 1;
      const float start = 0.0F, step = 1.0F;
      file.stream.write(bytes_of("POINTCACHE2", 12));
      file.stream.write(bytes_of(&version, 4));
      file.stream.write(bytes_of(&points, 4));
      file.stream.write(bytes_of(&start, 4));
      file.stream.write(bytes_of(&step, 4));
      file.stream.write(bytes_of(&frames, 4));
    } else {
      std::vector<uint32_t> head = {swapped(frames), swapped(points)};
      for (const float time : times)
        head.push_back(swapped(std::bit_cast<uint32_t>(time)));
      file.stream.write(bytes_of(head.data(), 4 * head.size()));
    }
  }
}

void PointCaches::add(const Face& face) {
  for (File& file : files_) {
    points_.clear();
    size_t part = face.meshes().size();
    std::span<const float> now;
    for (const CachedObject::Point& point : file.object.points) {
      if (point.part != part) now = face.positions(part = point.part);
      for (size_t axis = 0; axis < 3; ++axis) {
        const float value = now[3 * point.vertex + axis];
        points_.push_back(
            kind_ == CacheKind::pc2 ? value : std::bit_cast<float>(swapped(std::bit_cast<uint32_t>(value))));
      }
    }
    file.stream.write(bytes_of(points_.data(), 4 * points_.size()));
  }
  ++written_;
}

std::vector<std::filesystem::path> PointCaches::finish() {
  if (written_ != frames_) throw Error("the cache lacks frames");
  std::vector<std::filesystem::path> paths;
  for (File& file : files_) {
    file.stream.put_in_place();
    paths.push_back(file.path);
  }
  return paths;
}

}  // namespace fascia::cli
