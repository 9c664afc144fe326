#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "builder/muscles/order.h"
#include "tests/geodesics/surfaces.h"

/// A head of concentric spheres, with a few muscles to lay on it.
namespace fascia::muscles {

inline constexpr double kSkin = 0.1, kSmas = 0.095, kBone = 0.088;

inline TriangleMesh shell(double radius) {
  TriangleMesh mesh = geodesics::sphere(5);
  for (Vec3& p : mesh.vertices)
    p *= radius;
  return mesh;
}

/// The point of the front of a sphere seen at (x, y).
inline Vec3 front(double radius, double x, double y) {
  return Vec3(x, y, std::sqrt(radius * radius - x * x - y * y));
}

inline std::vector<Vec3> patch(double radius, double x, double y, double half_width, double half_height) {
  return {front(radius, x - half_width, y - half_height), front(radius, x + half_width, y - half_height),
          front(radius, x + half_width, y + half_height), front(radius, x - half_width, y + half_height)};
}

inline anatomy::Muscle strap(const std::string& name, double side) {
  anatomy::Muscle muscle;
  muscle.name = muscle.whole = name;
  muscle.group = "mimic";
  muscle.origin = {anatomy::Attachment::cranium, patch(kBone, side * 0.045, 0.03, 0.006, 0.004)};
  muscle.insertion = {anatomy::Attachment::modiolus, patch(kSmas, side * 0.022, -0.02, 0.004, 0.004)};
  muscle.depth_fraction = {1.0, 0.6, 0.4};
  muscle.peak_shortening = 0.2;
  muscle.cross_section = 2e-5;
  muscle.bundles = 2;
  return muscle;
}

inline anatomy::Muscle ring(const std::string& name, anatomy::MuscleKind kind, double inner, double outer,
                            double begin, double end) {
  anatomy::Muscle muscle;
  muscle.name = muscle.whole = name;
  muscle.group = "mimic";
  muscle.kind = kind;
  muscle.band = anatomy::OrificeBand{"mouth", inner, outer, begin, end};
  muscle.depth_fraction =
      kind == anatomy::MuscleKind::compressor ? std::vector<double>{0.1, 0.9} : std::vector<double>{0.4, 0.4};
  muscle.cross_section = 1e-5;
  return muscle;
}

/// Concentric spheres for skin, SMAS and skull.
struct BallHead {
  TriangleMesh smas = shell(kSmas);
  spatial::SurfaceQuery skin{shell(kSkin)}, cranium{shell(kBone)};
  std::vector<anatomy::Muscle> muscles;
  anatomy::mechanics::Muscles constants{3e5, 0.005, 0.014};

  Inputs inputs() const {
    Inputs in;
    in.constants = constants;
    in.smas = &smas;
    in.skin = &skin;
    in.cranium = &cranium;
    in.muscles = muscles;
    in.landmarks = {{"cheilion_left", front(kSkin, 0.025, -0.03)},
                    {"cheilion_right", front(kSkin, -0.025, -0.03)},
                    {"stomion", front(kSkin, 0.0, -0.03)}};
    return in;
  }
};

}  // namespace fascia::muscles
