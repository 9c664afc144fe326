#include "builder/openings/eyeball.h"

#include <algorithm>
#include <cmath>

#include "builder/prepare/eyeballs.h"

namespace fascia::openings {

namespace {

// A globe of 24 mm across behind a fissure of 28 mm to 30 mm between the canthi (Gray's Anatomy; Farkas
// 1994).
constexpr double globe_radius = 0.012, fissure_width = 0.029;
constexpr double lid_thickness = 0.0015;  // metres of a grown person, between the globe and the skin

const Vec3 sclera(0.86, 0.84, 0.81), iris(0.30, 0.20, 0.12), pupil(0.02, 0.02, 0.02);

}  // namespace

prepare::Eyeball fit_globe(const spatial::SurfaceQuery& skin, const MeetingLine& line, const FaceAxes& face) {
  prepare::Eyeball ball;
  const double size = 2.0 * line.half_width / fissure_width;
  // Large painted eyes of a stylised face are no larger globes than their face can hold.
  ball.radius = globe_radius * std::clamp(size, 0.6 * face.scale, 2.2 * face.scale);
  const double room = ball.radius + lid_thickness * ball.radius / globe_radius;
  // How far forward the centre may stand before each place of the lids.
  std::vector<double> limits;
  constexpr int steps = 12;
  for (int column = -steps; column <= steps; ++column)
    for (int row = -steps; row <= steps; ++row) {
      const double x = 0.75 * ball.radius * column / steps, y = 0.75 * ball.radius * row / steps;
      if (x * x + y * y > 0.5625 * ball.radius * ball.radius) continue;
      const Vec3 from = line.origin + line.axes * Vec3(x, line.height(0.0) + y, 2.0 * line.half_width);
      const auto hit = skin.first_hit(from, -line.axes.col(2), 6.0 * line.half_width);
      if (!hit) continue;
      limits.push_back(2.0 * line.half_width - hit->distance - std::sqrt(room * room - x * x - y * y));
    }
  double depth = -0.8 * ball.radius;
  if (!limits.empty()) {
    const auto low = limits.begin() + static_cast<std::ptrdiff_t>(limits.size() / 50);
    std::nth_element(limits.begin(), low, limits.end());
    depth = *low;
  }
  ball.centre = line.origin + line.axes * Vec3(0.0, line.height(0.0), depth);
  ball.gaze = face.rotation.col(2);
  return ball;
}

formats::SceneMesh eyeball_mesh(const anatomy::GenericAnatomy& anatomy, const prepare::Eyeball& ball,
                                const FaceAxes& face, bool left) {
  formats::SceneMesh mesh;
  mesh.name = left ? "eye_left" : "eye_right";
  mesh.material = mesh.name;
  const anatomy::MeshObject* generic = anatomy.head_object(mesh.name);
  if (!generic || generic->mesh.empty()) return mesh;
  double rms = 0.0;
  const prepare::Eyeball own = prepare::fit_sphere(generic->mesh.vertices, &rms);
  // Corners are not shared, so that iris and sclera keep their edge.
  for (const Triangle& t : generic->mesh.triangles) {
    Vec3 middle = Vec3::Zero();
    for (const int v : t)
      middle += (generic->mesh.vertices[static_cast<size_t>(v)] - own.centre) / 3.0 / own.radius;
    const double off_axis = middle.head<2>().norm();
    const Vec3 colour = middle.z() < 0.0 || off_axis > 0.39 ? sclera : off_axis > 0.135 ? iris : pupil;
    Triangle corners;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 arm = generic->mesh.vertices[static_cast<size_t>(t[k])] - own.centre;
      corners[k] = static_cast<int>(mesh.positions.size());
      mesh.positions.push_back(ball.centre + ball.radius / own.radius * (face.rotation * arm));
      mesh.colours.push_back(colour);
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

}  // namespace fascia::openings
