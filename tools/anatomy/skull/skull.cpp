#include "tools/anatomy/skull/skull.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <utility>

#include "geometry/error.h"
#include "tools/anatomy/skull/half_mesh.h"
#include "tools/anatomy/skull/section_surface.h"
#include "tools/anatomy/skull/teeth.h"

namespace fascia::skull_maker {
namespace {

std::vector<Vec3> positions(const std::vector<OrientedPoint>& points) {
  std::vector<Vec3> out;
  for (const OrientedPoint& point : points) out.push_back(point.position);
  return out;
}

/// The cranium less what lies within `space` of the mandible: the cartilage and disc of the jaw joint.
/// The larger of the two fields, rounded over `rounding` mm.
smas::ImplicitFunction with_joint_space(smas::ImplicitFunction cranium, smas::ImplicitFunction mandible, double space,
                                        double rounding) {
  return [=, cranium = std::move(cranium), mandible = std::move(mandible)](const Vec3& point, Vec3* gradient) {
    Vec3 bone_gradient;
    Vec3 jaw_gradient;
    const double bone = cranium(point, &bone_gradient);
    const double hollow = space - mandible(point, &jaw_gradient);
    if (gradient) *gradient = bone_gradient;
    if (!std::isfinite(hollow) || hollow < bone - rounding) return bone;
    const double t = std::min(1.0, 0.5 + 0.5 * (hollow - bone) / rounding);
    // Polynomial smooth maximum: its gradient is the blend of the two.
    if (gradient) *gradient = (1 - t) * bone_gradient - t * jaw_gradient;
    return (1 - t) * bone + t * hollow + rounding * t * (1 - t);
  };
}

}  // namespace

std::vector<Part> make_skull(const Figures& figures) {
  SymmetricMeshOptions cranium;
  SymmetricMeshOptions mandible;
  mandible.cell = 1.2;
  mandible.reach = 5.0;
  mandible.largest_edge = 6.0;
  mandible.smallest_edge = 2.3;
  mandible.triangles = 2000;
  const std::vector<OrientedPoint> cranium_points = carry(figures.to_generic, figures.cranium);
  const std::vector<OrientedPoint> mandible_points = carry(figures.to_generic, figures.mandible);
  const smas::ImplicitFunction jaw = section_surface(mandible_points);
  const smas::ImplicitFunction skull_base = with_joint_space(section_surface(cranium_points), jaw, 2.2, 0.8);
  std::vector<Part> parts;
  parts.push_back({"cranium", symmetric_mesh(skull_base, positions(cranium_points), cranium)});
  parts.push_back({"mandible", symmetric_mesh(jaw, positions(mandible_points), mandible)});
  parts.push_back({"teeth_upper", dental_row(figures.teeth_upper, figures.to_generic, 15.0)});
  parts.push_back({"teeth_lower", dental_row(figures.teeth_lower, figures.to_generic, 11.5)});
  return parts;
}

void write_obj(const std::vector<Part>& parts, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << "# The generic skull of Fascia, made by tools/anatomy/make_skull from anatomy/figures/skull_*.csv.\n"
          "# Millimetres; +X subject's left, +Y up, +Z front. Sources: anatomy/SOURCES.md.\n";
  int first = 1;
  char line[96];
  for (const Part& part : parts) {
    file << "o " << part.name << '\n';
    for (const Vec3& v : part.mesh.vertices) {
      // Adding 0 turns a negative zero into a zero.
      std::snprintf(line, sizeof line, "v %.4f %.4f %.4f\n", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
      file << line;
    }
    for (const Triangle& t : part.mesh.triangles) {
      file << "f " << t[0] + first << ' ' << t[1] + first << ' ' << t[2] + first << '\n';
    }
    first += part.mesh.vertex_count();
  }
  if (!file.flush()) throw Error("cannot write " + path);
}

}  // namespace fascia::skull_maker
