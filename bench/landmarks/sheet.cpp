#include "bench/landmarks/sheet.h"

#include <Eigen/Geometry>

#include "view/renderer.h"

namespace fascia::bench {

namespace {

using Found = rigging::FoundLandmarks;

/// A small ball at each landmark: green where confidence is high, through yellow to red.
void add_landmark(view::DrawSurface& marks, const Vec3& centre, double confidence, double radius) {
  static const std::vector<Vec3> corners = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                                            -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  const int base = static_cast<int>(marks.positions.size());
  const Vec3 colour =
      confidence > 0.5 ? Vec3(2.0 * (1.0 - confidence), 0.85, 0.1) : Vec3(0.95, 1.6 * confidence, 0.1);
  for (const Vec3& c : corners) {
    marks.positions.push_back(centre + radius * c);
    marks.vertex_colours.push_back(colour);
  }
  for (const Triangle& t : std::vector<Triangle>{
           {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}})
    marks.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

}  // namespace

view::Tile landmark_tile(const Found& found, const std::string& caption, double yaw) {
  view::DrawList list;
  for (const prepare::PreparedMesh& mesh : found.head.meshes) {
    view::DrawSurface surface;
    surface.positions = mesh.positions;
    surface.colour = Vec3(0.80, 0.66, 0.57);
    surface.shine = 0.15;
    for (const Triangle& t : mesh.triangles) {
      const prepare::Part part = mesh.parts[static_cast<size_t>(t[0])];
      if (part == prepare::Part::skin || part == prepare::Part::eye_left || part == prepare::Part::eye_right)
        surface.triangles.push_back(t);
    }
    if (surface.triangles.empty()) continue;
    if (mesh.parts[static_cast<size_t>(surface.triangles[0][0])] != prepare::Part::skin)
      surface.colour = Vec3(0.9, 0.9, 0.88);
    list.surfaces.push_back(surface);
  }
  view::DrawSurface marks;
  marks.shine = 0.0;
  Bounds box;
  // The picture looks at the face as found: turned to the front by its own landmarks.
  const auto at = [&](const char* name) { return found.landmarks.at(name).position; };
  const double size = (at("glabella") - at("menton")).norm();
  for (const auto& [name, landmark] : found.landmarks) {
    add_landmark(marks, landmark.position, landmark.confidence, 0.018 * size);
    if ((landmark.position - at("pronasale")).norm() > 1.05 * size) continue;
    box.lower = box.lower.cwiseMin(landmark.position);
    box.upper = box.upper.cwiseMax(landmark.position);
  }
  list.surfaces.push_back(marks);
  const Vec3 across = at("exocanthion_left") - at("exocanthion_right"), up = at("glabella") - at("menton");
  const Vec3 forward = across.cross(up).normalized();
  view::Camera camera = view::named_camera("front", box, 0.78);
  camera.yaw = std::atan2(forward[0], forward[2]) * 180.0 / EIGEN_PI + yaw;
  camera.pitch = std::asin(std::clamp(forward[1], -1.0, 1.0)) * 180.0 / EIGEN_PI * 0.5;
  static const view::Renderer renderer(240, 280);
  return {renderer.draw(list, camera), caption};
}

}  // namespace fascia::bench
