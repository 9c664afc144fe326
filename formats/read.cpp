#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>

#include "formats/detail.h"
#include "formats/partial.h"
#include "geometry/error.h"

namespace fascia::formats {

namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

FileKind kind_of(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  const auto starts_with = [&](const char* text) {
    const size_t length = std::strlen(text);
    return bytes.size() >= length && std::memcmp(bytes.data(), text, length) == 0;
  };
  if (starts_with("glTF")) return FileKind::glb;
  if (starts_with("ply\n") || starts_with("ply\r")) return FileKind::ply;
  const std::string extension = lower_extension(path);
  if (extension == ".glb") return FileKind::glb;
  if (extension == ".gltf" || extension == ".vrm") return FileKind::gltf;
  if (extension == ".obj") return FileKind::obj;
  if (extension == ".ply") return FileKind::ply;
  if (extension == ".stl") return FileKind::stl;
  const auto first = std::find_if_not(bytes.begin(), bytes.end(), [](uint8_t c) { return std::isspace(c); });
  if (first != bytes.end() && *first == '{') return FileKind::gltf;
  throw Error("'" + path.string() + "' is not a mesh file that is read here: use GLB, glTF, OBJ, PLY or STL");
}

void check(const Scene& scene) {
  size_t triangles = 0;
  for (const SceneMesh& mesh : scene.meshes) {
    triangles += mesh.triangles.size();
    for (const Vec3& p : mesh.positions)
      if (!p.allFinite())
        detail::fail(scene, "mesh '" + mesh.name + "' has a coordinate that is not a number");
    for (const Triangle& t : mesh.triangles)
      for (int corner : t)
        if (corner < 0 || corner >= static_cast<int>(mesh.positions.size()))
          detail::fail(scene, "mesh '" + mesh.name + "' has a face that names vertex " +
                                  std::to_string(corner) + " of " + std::to_string(mesh.positions.size()));
  }
  if (triangles == 0) detail::fail(scene, "it holds no triangles; a head must be a surface mesh");
}

}  // namespace

std::vector<uint8_t> read_bytes(const std::filesystem::path& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) throw Error("'" + path.string() + "' does not exist");
  if (std::filesystem::is_directory(path, status))
    throw Error("'" + path.string() + "' is a folder, not a file");
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw Error("'" + path.string() + "' cannot be opened: check its permissions");
  std::vector<uint8_t> bytes(static_cast<size_t>(std::max<std::streamoff>(0, file.tellg())));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file && !bytes.empty()) throw Error("'" + path.string() + "' cannot be read to its end");
  return bytes;
}

Scene read(const std::filesystem::path& path) {
  return read(path, read_bytes(path));
}

Scene read(const std::filesystem::path& path, std::vector<uint8_t> bytes) {
  if (bytes.empty()) throw Error("'" + path.string() + "' is empty");
  Scene scene;
  scene.path = path;
  scene.kind = kind_of(path, bytes);
  if (scene.kind == FileKind::glb || scene.kind == FileKind::gltf) {
    detail::read_gltf(scene, bytes);
  } else {
    scene.bytes = std::move(bytes);
    if (scene.kind == FileKind::obj) detail::read_obj(scene);
    if (scene.kind == FileKind::ply) detail::read_ply(scene);
    if (scene.kind == FileKind::stl) detail::read_stl(scene);
  }
  check(scene);
  return scene;
}

namespace {

/// A file known as partial while this lives.
class Partial {
 public:
  explicit Partial(std::filesystem::path path) : path_(std::move(path)) { remember_partial(path_); }
  ~Partial() { forget_partial(path_); }
  Partial(const Partial&) = delete;
  Partial& operator=(const Partial&) = delete;

 private:
  std::filesystem::path path_;
};

}  // namespace

void write_bytes(const std::filesystem::path& path, const void* bytes, size_t size) {
  const std::filesystem::path folder = path.parent_path();
  std::error_code status;
  if (!folder.empty()) std::filesystem::create_directories(folder, status);
  std::filesystem::path beside = path;
  beside += ".part";
  const Partial partial(beside);
  {
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
    file.flush();
    if (!file) {
      file.close();
      std::filesystem::remove(beside, status);
      throw Error("'" + path.string() +
                  "' cannot be written: check the folder, its permissions and free space");
    }
  }
  std::filesystem::rename(beside, path, status);
  if (status) {
    const std::string why = status.message();
    std::filesystem::remove(beside, status);
    throw Error("'" + path.string() + "' cannot be written: " + why);
  }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_bytes(path, text.data(), text.size());
}

namespace detail {

void fail(const Scene& scene, const std::string& what) {
  throw Error("'" + scene.path.string() + "': " + what);
}

void triangulate(const std::vector<Vec3>& positions, const std::vector<int>& polygon,
                 std::vector<Triangle>& triangles) {
  if (polygon.size() == 4) {
    const auto gap = [&](int a, int b) {
      const auto inside = [&](int i) { return i >= 0 && i < static_cast<int>(positions.size()); };
      return inside(a) && inside(b) ? (positions[a] - positions[b]).squaredNorm() : 0.0;
    };
    if (gap(polygon[1], polygon[3]) < gap(polygon[0], polygon[2])) {
      triangles.push_back({polygon[0], polygon[1], polygon[3]});
      triangles.push_back({polygon[1], polygon[2], polygon[3]});
      return;
    }
  }
  for (size_t i = 2; i < polygon.size(); ++i)
    triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
}

}  // namespace detail

}  // namespace fascia::formats
