#include "cli/fit_scan.h"

#include <Eigen/Geometry>
#include <cmath>

#include "builder/prepare/prepare.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/spatial/surface_query.h"
#include "cli/fit_match.h"
#include "cli/still_landmarks.h"
#include "geometry/alignment.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

constexpr double near = 0.025;      // metres: a scan this near the head is on it
constexpr double same_size = 0.08;  // a scale nearer to 1 is the same person's, measured by moving landmarks

/// Share of the rig's landmarks that lie near the mesh.
double share_near(const fit::Subject& subject, const spatial::SurfaceQuery& surface) {
  int count = 0, close = 0;
  for (const std::string_view name : still_landmarks)
    for (const rig::Landmark& landmark : subject.file().rig.skull.landmarks) {
      if (landmark.name != name) continue;
      ++count;
      close += surface.closest(landmark.skin.cast<double>(), near).found();
    }
  return count > 0 ? static_cast<double>(close) / count : 0.0;
}

rigging::FoundLandmarks face_of(const formats::Scene& scene) {
  try {
    return rigging::find_landmarks(scene, {}, anatomy::load_generic(), prepare::PrepareOptions{});
  } catch (const Error& error) {
    throw Error("'" + scene.path.string() +
                "' has neither the rig's topology nor a face that lies on the rig's head or is found in it; "
                "give it in "
                "the head's axes and units (" +
                error.what() + ")");
  }
}

}  // namespace

PlacedScan place_scan(const fit::Subject& subject, const formats::Scene& scene, bool may_search) {
  PlacedScan out;
  out.mesh = prepare::joined_meshes(scene);
  const bool is_unwelded = out.mesh.vertex_count() == 3 * out.mesh.triangle_count();
  const Mat4 map = scene_to_metres(subject, scene);
  for (Vec3& p : out.mesh.vertices)
    p = transform_point(map, p);
  if (is_unwelded) {  // STL: without it every edge would be one of the scan's border
    std::vector<int> ignored;
    out.mesh = weld(out.mesh, 1e-6, &ignored);
  }
  if (!may_search || share_near(subject, spatial::SurfaceQuery(out.mesh)) > 0.7) return out;
  const rigging::FoundLandmarks found = face_of(scene);
  std::vector<Vec3> from, to;
  for (const std::string_view name : still_landmarks)
    for (const rig::Landmark& landmark : subject.file().rig.skull.landmarks) {
      const auto at = found.landmarks.find(std::string(name));
      if (landmark.name != name || at == found.landmarks.end()) continue;
      from.push_back(at->second.position);
      to.push_back(landmark.skin.cast<double>());
    }
  if (from.size() < 4)
    throw Error("'" + scene.path.string() + "': too few landmarks were found to bring it onto the head");
  Mat4 onto = similarity(from, to);
  const double scale = onto.topLeftCorner<3, 1>().norm();
  if (std::abs(scale - 1.0) < same_size) onto = rigid_motion(from, to);
  out.mesh = found.head.skin;
  for (Vec3& p : out.mesh.vertices)
    p = transform_point(onto, p);
  out.warnings.emplace_back("the scan does not lie on the rig's head: it was brought there by its face");
  if (std::abs(scale - 1.0) >= same_size)
    out.warnings.push_back("the scan's face is " + std::to_string(1.0 / scale) +
                           " times the rig's size: it was scaled");
  return out;
}

}  // namespace fascia::cli
