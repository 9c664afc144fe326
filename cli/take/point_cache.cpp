#include "cli/take/point_cache.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <map>
#include <set>

#include "formats/partial.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/read/read.h"

namespace fascia::cli {

namespace {

uint32_t swapped(uint32_t word) {
  return word << 24 | (word & 0xFF00) << 8 | (word >> 8 & 0xFF00) | word >> 24;
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

std::vector<CachedObject> cached_objects(const std::filesystem::path& rig, const Face& face) {
  std::map<uint32_t, CachedObject> by_mesh;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    CachedObject& object = by_mesh[face.meshes()[m].mesh];
    object.name = face.meshes()[m].name;
    for (uint32_t v = 0; v < face.meshes()[m].vertex_count; ++v)
      object.points.push_back({m, v});
  }
  const rig::RigFile file = rig::read(formats::read_bytes(rig), rig.string());
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
  std::set<std::string> words;
  for (size_t i = 0; i < objects.size(); ++i) {
    File file;
    file.path = path;
    if (objects.size() > 1) {
      std::string word = file_word(objects[i].name, i);
      if (!words.insert(word).second) words.insert(word += "_" + std::to_string(i));
      file.path.replace_extension("." + word + path.extension().string());
    }
    file.part = file.path;
    file.part += ".part";
    file.object = std::move(objects[i]);
    files_.push_back(std::move(file));
  }
  for (File& file : files_) {
    formats::remember_partial(file.part);
    file.stream = std::fopen(file.part.c_str(), "wb");
    const auto points = static_cast<uint32_t>(file.object.points.size());
    const auto frames = static_cast<uint32_t>(frames_);
    if (kind_ == CacheKind::pc2) {
      const uint32_t version = 1;
      const float start = 0.0F, step = 1.0F;
      write(file, "POINTCACHE2", 12);
      write(file, &version, 4);
      write(file, &points, 4);
      write(file, &start, 4);
      write(file, &step, 4);
      write(file, &frames, 4);
    } else {
      std::vector<uint32_t> head = {swapped(frames), swapped(points)};
      for (const float time : times)
        head.push_back(swapped(std::bit_cast<uint32_t>(time)));
      write(file, head.data(), 4 * head.size());
    }
  }
}

PointCaches::~PointCaches() {
  for (File& file : files_) {
    if (file.stream == nullptr) continue;
    std::fclose(file.stream);
    std::error_code ignored;
    std::filesystem::remove(file.part, ignored);
    formats::forget_partial(file.part);
  }
}

void PointCaches::write(File& file, const void* data, size_t size) {
  if (file.stream == nullptr || std::fwrite(data, 1, size, file.stream) != size)
    throw Error("'" + file.path.string() +
                "' cannot be written: check the folder, its permissions and free space");
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
    write(file, points_.data(), 4 * points_.size());
  }
  ++written_;
}

std::vector<std::filesystem::path> PointCaches::finish() {
  if (written_ != frames_) throw Error("the cache lacks frames");
  std::vector<std::filesystem::path> paths;
  for (File& file : files_) {
    const bool is_whole = std::fclose(file.stream) == 0;
    file.stream = nullptr;
    std::error_code status;
    if (is_whole) std::filesystem::rename(file.part, file.path, status);
    formats::forget_partial(file.part);
    if (!is_whole || status) {
      std::error_code ignored;
      std::filesystem::remove(file.part, ignored);
      throw Error("'" + file.path.string() + "' cannot be written: check the folder and free space");
    }
    paths.push_back(file.path);
  }
  return paths;
}

}  // namespace fascia::cli
