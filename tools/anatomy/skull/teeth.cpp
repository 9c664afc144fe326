#include "tools/anatomy/skull/teeth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/anatomy/skull/half_mesh.h"

namespace fascia::skull_maker {
namespace {

constexpr int around = 10;        // vertices of a ring
constexpr double contact = 0.06;  // mm left free towards each neighbour

/// How a tooth ends: height of the rim above and of the middle below the first section's level.
struct Crown {
  double roundness = 2.4;  ///< exponent of the superellipse of its sections
  double cusp = 0.0;       ///< mm, height of the cusps over the rim
  int cusps = 0;           ///< 0: edge, 1: point, 2: premolar, 4: molar
  double fossa = 0.0;      ///< mm, depth of the middle below the rim
};

Crown crown_of(const std::string& name) {
  if (name.find("molar") != std::string::npos && name.find("premolar") == std::string::npos)
    return {3.0, 0.9, 4, 1.0};
  if (name.find("premolar") != std::string::npos) return {2.6, 1.0, 2, 0.9};
  if (name == "canine") return {2.3, 0.8, 1, 0.0};
  return {2.6, 0.0, 0, 0.0};
}

/// Section at `level`, interpolated; beyond the last one it keeps that one's widths and follows the axis.
ToothSection section_at(const Tooth& tooth, double level) {
  const auto& all = tooth.sections;
  const auto above =
      std::find_if(all.begin(), all.end(), [&](const ToothSection& s) { return s.level >= level; });
  ToothSection out = above == all.end() ? all.back() : *above;
  if (above != all.end() && above != all.begin()) {
    const ToothSection& low = *(above - 1);
    const double t = (level - low.level) / (above->level - low.level);
    out.centre = (1 - t) * low.centre + t * above->centre;
    out.half_mesiodistal = (1 - t) * low.half_mesiodistal + t * above->half_mesiodistal;
    out.half_buccolingual = (1 - t) * low.half_buccolingual + t * above->half_buccolingual;
  } else {
    out.centre += (out.level - level) * tooth.axis;
  }
  out.level = level;
  return out;
}

double signed_power(double base, double exponent) {
  return std::copysign(std::pow(std::abs(base), exponent), base);
}

/// Height of the rim's cusps at `angle` (0 mesial, quarter turn buccal), 0 to 1.
double cusp_at(const Crown& crown, double angle) {
  switch (crown.cusps) {
    case 1:
      return 0.0;
    case 2:
      return std::pow(std::abs(std::sin(angle)), 1.5);
    case 4:
      return std::pow(std::abs(std::sin(2 * angle)), 1.0);
    default:
      return 0.0;
  }
}

struct Loft {
  const Tooth& tooth;
  const splines::Warp& to_generic;
  Crown crown;
  Vec3 buccal;
  TriangleMesh mesh;

  Vec3 ring_point(const ToothSection& section, double angle, double share) const {
    const double power = 2.0 / crown.roundness;
    const double m =
        std::max(0.2, section.half_mesiodistal - contact) * share * signed_power(std::cos(angle), power);
    const double b = std::max(0.2, section.half_buccolingual) * share * signed_power(std::sin(angle), power);
    return section.centre + m * tooth.mesial + b * buccal;
  }

  int add_ring(double level, double share, double cusp, double sink) {
    const ToothSection section = section_at(tooth, level);
    const int first = mesh.vertex_count();
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.5) / around;
      const double rise = cusp * cusp_at(crown, angle) - sink;
      mesh.vertices.push_back(to_generic(ring_point(section, angle, share) + rise * tooth.axis));
    }
    return first;
  }

  void join(int upper, int lower) {
    for (int i = 0; i < around; ++i) {
      const int j = (i + 1) % around;
      mesh.triangles.push_back({upper + i, lower + i, lower + j});
      mesh.triangles.push_back({upper + i, lower + j, upper + j});
    }
  }

  void cap(int ring, const Vec3& middle, bool tip) {
    const int centre = mesh.vertex_count();
    mesh.vertices.push_back(to_generic(middle));
    for (int i = 0; i < around; ++i) {
      const int j = (i + 1) % around;
      if (tip) {
        mesh.triangles.push_back({centre, ring + i, ring + j});
      } else {
        mesh.triangles.push_back({centre, ring + j, ring + i});
      }
    }
  }
};

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](int k) {
      return mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    sum += at(0).dot(at(1).cross(at(2))) / 6;
  }
  return sum;
}

TriangleMesh tooth_mesh(const Tooth& tooth, const splines::Warp& to_generic, double depth) {
  Loft loft{tooth, to_generic, crown_of(tooth.name), tooth.axis.cross(tooth.mesial).normalized(), {}};
  const bool chewing = loft.crown.cusps >= 2;
  int previous = -1;
  const auto ring = [&](double level, double share, double cusp, double sink) {
    const int next = loft.add_ring(level, share, cusp, sink);
    if (previous >= 0) loft.join(previous, next);
    previous = next;
  };
  if (chewing) {
    const double rim = 1.3;
    ring(rim, 0.45, 0.25 * loft.crown.cusp, 0.45 * loft.crown.fossa);
    loft.cap(previous, section_at(tooth, rim).centre - loft.crown.fossa * tooth.axis, true);
    ring(rim, 0.80, loft.crown.cusp, 0.0);
    ring(2.0, 1.0, 0.5 * loft.crown.cusp, 0.0);
    for (const double level : {3.2, 5.2, 8.5, depth})
      ring(level, 1.0, 0, 0);
  } else {
    ring(0.35, 0.72, 0, 0.0);
    loft.cap(previous, section_at(tooth, 0.4).centre + 0.35 * tooth.axis, true);
    for (const double level : {0.8, 2.0, 4.2, 8.5, depth})
      ring(level, 1.0, 0, 0);
  }
  loft.cap(previous, section_at(tooth, depth).centre - 0.8 * tooth.axis, false);
  if (volume(loft.mesh) < 0) {
    for (Triangle& t : loft.mesh.triangles)
      std::swap(t[1], t[2]);
  }
  return loft.mesh;
}

}  // namespace

TriangleMesh dental_row(const std::vector<Tooth>& left, const splines::Warp& to_generic, double depth) {
  TriangleMesh half;
  for (const Tooth& tooth : left) {
    const TriangleMesh one = tooth_mesh(tooth, to_generic, depth);
    const int first = half.vertex_count();
    half.vertices.insert(half.vertices.end(), one.vertices.begin(), one.vertices.end());
    for (const Triangle& t : one.triangles)
      half.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return mirrored(half);
}

}  // namespace fascia::skull_maker
