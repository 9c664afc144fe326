#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>

#include "formats/detail.h"
#include "formats/partial.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::formats {

namespace {

FileKind kind_of(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  const auto starts_with = [&](const char* text) {
    const size_t length = std::strlen(text);
    return bytes.size() >= length && std::memcmp(bytes.data(), text, length) == 0;
  };
  if (starts_with("glTF")) return FileKind::glb;
  if (starts_with("ply\n") || starts_with("ply\r") || starts_with("ply ")) return FileKind::ply;
  const std::string extension = extension_of(path);
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
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      if (!mesh.positions[v].allFinite())
        detail::fail(scene, "mesh '" + mesh.name + "' has a coordinate that is not a number, of vertex " +
                                std::to_string(v) + "; delete that vertex or give it a place");
    for (const Triangle& t : mesh.triangles)
      for (int corner : t)
        if (corner < 0 || corner >= static_cast<int>(mesh.positions.size()))
          detail::fail(scene, "mesh '" + mesh.name + "' has a face that names vertex " +
                                  std::to_string(corner) + " of " + std::to_string(mesh.positions.size()));
  }
  if (triangles == 0) detail::fail(scene, "it holds no triangles; a head must be a surface mesh");
}

/// Sizes beyond which single precision, or the square of a length in it, no longer holds.
void check_size(const Scene& scene, const Bounds& box) {
  const double size = box.size().maxCoeff(),
               far = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs()).maxCoeff();
  if (!(size > 1e-9) || !(far < 1e12)) {
    char text[96];
    std::snprintf(text, sizeof text, "it is %.3g units large, as far as %.3g from the origin", size, far);
    detail::fail(
        scene,
        std::string(text) +
            "; scale it so that a head is between a millionth and a million units large, near the origin");
  }
}

/// Brings what lies far from the origin there: single precision, which rigs have, would lose its shape.
void take_offset_out(Scene& scene) {
  Bounds box;
  for (const SceneMesh& mesh : scene.meshes)
    for (const Vec3& p : mesh.positions) {
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
  check_size(scene, box);
  const double size = box.size().norm();
  if (box.centre().norm() < 16.0 * size) return;
  // Whole powers of two are taken off: what is left keeps its digits.
  const double step = std::exp2(std::ceil(std::log2(size)));
  scene.offset = step * (box.centre() / step).array().round().matrix();
  for (SceneMesh& mesh : scene.meshes) {
    for (Vec3& p : mesh.positions)
      p -= scene.offset;
    // The coordinates of a glTF's primitives stay as they are; those of other formats are what `positions`
    // says.
    if (scene.bytes.empty()) mesh.to_file.topRightCorner<3, 1>() -= scene.offset;
  }
}

}  // namespace

Scene read(const std::filesystem::path& path, const ReadOptions& options) {
  return read(path, read_bytes(path), options);
}

Scene read(const std::filesystem::path& path, std::vector<uint8_t> bytes, const ReadOptions& options) {
  if (bytes.empty()) throw Error("'" + path.string() + "' is empty");
  Scene scene;
  scene.path = path;
  scene.options = options;
  scene.kind = kind_of(path, bytes);
  if (scene.kind == FileKind::glb || scene.kind == FileKind::gltf) {
    detail::read_gltf(scene, bytes, options);
  } else {
    scene.bytes = std::move(bytes);
    if (scene.kind == FileKind::obj) detail::read_obj(scene);
    if (scene.kind == FileKind::ply) detail::read_ply(scene);
    if (scene.kind == FileKind::stl) detail::read_stl(scene);
  }
  check(scene);
  // In formats without nodes nothing counts the meshes but their order here.
  if (!scene.bytes.empty())
    std::erase_if(scene.meshes, [](const SceneMesh& mesh) { return mesh.triangles.empty(); });
  take_offset_out(scene);
  return scene;
}

namespace detail {

void fail(const Scene& scene, const std::string& what) {
  throw Error("'" + scene.path.string() + "': " + what);
}

}  // namespace detail

}  // namespace fascia::formats
