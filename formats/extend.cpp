#include "formats/extend.h"

#include "formats/extend_detail.h"

namespace fascia::formats {

MeshExtension unchanged(const SceneMesh& mesh) {
  MeshExtension extension;
  extension.vertices_before = static_cast<int>(mesh.positions.size());
  extension.triangles_before = mesh.triangles;
  extension.origin.resize(mesh.triangles.size());
  for (size_t t = 0; t < extension.origin.size(); ++t)
    extension.origin[t] = static_cast<int>(t);
  return extension;
}

void rewrite(Scene& scene, const std::vector<MeshExtension>& extensions) {
  scene.is_extended = true;
  switch (scene.kind) {
    case FileKind::glb:
    case FileKind::gltf:
      detail::rewrite_gltf(scene, extensions);
      break;
    case FileKind::obj:
      detail::rewrite_obj(scene, extensions);
      break;
    case FileKind::ply:
    case FileKind::stl:
      break;
  }
}

}  // namespace fascia::formats
