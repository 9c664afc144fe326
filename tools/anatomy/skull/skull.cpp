#include "tools/anatomy/skull/skull.h"

#include <cstdio>
#include <fstream>

#include "geometry/error.h"
#include "tools/anatomy/skull/half_mesh.h"
#include "tools/anatomy/skull/section_surface.h"
#include "tools/anatomy/skull/teeth.h"

namespace fascia::skull_maker {
namespace {

TriangleMesh bone(const std::vector<OrientedPoint>& points, const SymmetricMeshOptions& options) {
  std::vector<Vec3> positions;
  for (const OrientedPoint& point : points) positions.push_back(point.position);
  return symmetric_mesh(section_surface(points), positions, options);
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
  std::vector<Part> parts;
  parts.push_back({"cranium", bone(carry(figures.to_generic, figures.cranium), cranium)});
  parts.push_back({"mandible", bone(carry(figures.to_generic, figures.mandible), mandible)});
  parts.push_back({"teeth_upper", dental_row(figures.teeth_upper, figures.to_generic)});
  parts.push_back({"teeth_lower", dental_row(figures.teeth_lower, figures.to_generic)});
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
