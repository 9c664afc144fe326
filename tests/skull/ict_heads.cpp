#include "tests/skull/ict_heads.h"

#include "builder/landmarks/complete.h"
#include "builder/spatial/surface_query.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::testing {

namespace {

std::filesystem::path file(const std::filesystem::path& measured, const std::string& name) {
  return measured / "data/ict" / (name + ".glb");
}

TriangleMesh head_mesh(const formats::Scene& scene) {
  for (const formats::SceneMesh& mesh : scene.meshes)
    if (mesh.name == "head") return {mesh.positions, mesh.triangles};
  throw Error("the scene has no mesh 'head'");
}

}  // namespace

bool has_ict_head(const std::filesystem::path& measured, const std::string& name) {
  return std::filesystem::exists(file(measured, name)) && std::filesystem::exists(file(measured, "neutral"));
}

IctHead read_ict_head(const std::filesystem::path& measured, const std::string& name,
                      const std::filesystem::path& landmark_file, const anatomy::GenericAnatomy& anatomy) {
  const formats::Scene scene = formats::read(file(measured, name));
  formats::LandmarkFile given = formats::read_landmarks(landmark_file);
  const spatial::SurfaceQuery mean(head_mesh(formats::read(file(measured, "neutral"))));
  const TriangleMesh mesh = head_mesh(scene);
  for (auto& [landmark, p] : given.points)
    p = position(mesh, mean.closest(p).surface);
  Landmarks reference;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin) reference[landmark.name] = *landmark.skin;
  IctHead out;
  out.head = prepare::prepare(scene, given, reference, {});
  for (const auto& [landmark, found] :
       landmarks::complete(out.head.landmarks, anatomy, spatial::SurfaceQuery(out.head.skin)))
    out.targets[landmark] = {found.position, found.confidence};
  return out;
}

}  // namespace fascia::testing
