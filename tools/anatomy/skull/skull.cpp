#include "tools/anatomy/skull/skull.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <utility>

#include "geometry/error.h"
#include "tools/anatomy/skull/half_mesh.h"
#include "tools/anatomy/skull/section_surface.h"
#include "tools/anatomy/skull/solids.h"
#include "tools/anatomy/skull/teeth.h"

namespace fascia::skull_maker {
namespace {

constexpr const char* septum_edge = "nasal_septum_front";
constexpr const char* foramen_edge = "foramen_magnum";

std::vector<Vec3> positions(const std::vector<OrientedPoint>& points) {
  std::vector<Vec3> out;
  for (const OrientedPoint& point : points)
    out.push_back(point.position);
  return out;
}

/// Rims of one bone in the generic frame.
std::vector<Rim> rims_of(const Figures& figures, const std::string& bone) {
  std::vector<Rim> rims;
  for (const NamedCurve& named : figures.curves) {
    if (named.bone != bone || named.name == septum_edge) continue;
    rims.push_back(positions(carry(figures.to_generic, named.points)));
    // A closed rim ends where it begins.
    if (named.name == "orbital_rim") rims.back().push_back(rims.back().front());
  }
  return rims;
}

/// Outline of the nasal septum in the midplane: its measured front edge, behind it a rectangle that ends
/// within bone.
std::vector<Vec3> septum_outline(const Figures& figures) {
  constexpr double roof = 27.0;  // mm, in the frame of the figures
  constexpr double back = 129.5;
  const std::vector<OrientedPoint>& front = curve(figures.curves, septum_edge).points;
  std::vector<Vec3> outline = positions(front);
  outline.push_back({0, roof, outline.back().z()});
  outline.push_back({0, roof, back});
  outline.push_back({0, front.front().position.y(), back});
  for (Vec3& point : outline) {
    point = figures.to_generic(point);
    point.x() = 0;
  }
  return outline;
}

/// Sections and rims of one bone as one cloud, in the generic frame.
std::vector<OrientedPoint> cloud(const Figures& figures, const std::vector<OrientedPoint>& sections,
                                 const std::string& bone) {
  std::vector<OrientedPoint> points = sections;
  for (const NamedCurve& named : figures.curves) {
    const bool cut_later = named.name == septum_edge || named.name == foramen_edge;
    if (named.bone == bone && !cut_later)
      points.insert(points.end(), named.points.begin(), named.points.end());
  }
  return carry(figures.to_generic, points);
}

/// The vault, the base of the skull, the inside of the nose and the depth of the orbits need less than the
/// face.
double coarseness(const Vec3& point) {
  const bool base = point.y() < 14 && point.z() < 32;
  const bool vault = point.y() > 70 || (point.z() < 12 && point.y() >= 14);
  const bool nose = std::abs(point.x()) < 15 && point.z() < 84 && point.y() < 45;
  const bool orbit = std::abs(point.x()) < 48 && point.y() > 14 && point.y() < 58 && point.z() < 70;
  return vault || base || nose || orbit ? 2.2 : 1.0;
}

}  // namespace

std::vector<Part> make_skull(const Figures& figures) {
  SymmetricMeshOptions cranium;
  cranium.reach = 5.5;
  cranium.largest_edge = 18.0;
  cranium.smallest_edge = 2.1;
  cranium.triangles = 8600;
  cranium.rims = rims_of(figures, "cranium");
  cranium.coarseness = coarseness;
  SymmetricMeshOptions mandible;
  mandible.cell = 1.2;
  mandible.reach = 5.0;
  mandible.largest_edge = 6.0;
  mandible.smallest_edge = 2.0;
  mandible.triangles = 2900;
  mandible.creases.rim_angle = 20.0;
  mandible.rims = rims_of(figures, "mandible");
  const std::vector<OrientedPoint> cranium_points = cloud(figures, figures.cranium, "cranium");
  const std::vector<OrientedPoint> mandible_points = cloud(figures, figures.mandible, "mandible");
  const smas::ImplicitFunction jaw = section_surface(mandible_points);
  // The jaw joint's cartilage and disc lie between the bones.
  smas::ImplicitFunction skull_base = intersection(section_surface(cranium_points), away_from(jaw, 2.2), 0.8);
  const std::vector<Vec3> foramen =
      positions(carry(figures.to_generic, curve(figures.curves, foramen_edge).points));
  std::vector<Vec3> near_surface = positions(cranium_points);
  skull_base = carved(std::move(skull_base), outside_hollow(foramen, 15.0, &near_surface), 1.0);
  skull_base = united(std::move(skull_base), plate(septum_outline(figures), 1.2, &near_surface), 1.0);
  std::vector<Part> parts;
  parts.push_back({"cranium", symmetric_mesh(skull_base, near_surface, cranium)});
  parts.push_back({"mandible", symmetric_mesh(jaw, positions(mandible_points), mandible)});
  parts.push_back({"teeth_upper", dental_row(figures.teeth_upper, figures.to_generic, 15.0)});
  parts.push_back({"teeth_lower", dental_row(figures.teeth_lower, figures.to_generic, 11.5)});
  return parts;
}

void write_obj(const std::vector<Part>& parts, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file
      << "# The generic skull of Fascia, made by tools/anatomy/make_skull from anatomy/figures/skull_*.csv.\n"
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
