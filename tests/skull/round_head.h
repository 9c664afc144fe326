#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "builder/skull/skull.h"

/// A head in closed form: an ellipsoid of skin over an ellipsoid of bone, landmarks where rays from the
/// centre pass both.
namespace fascia::testing {

inline const Vec3 skin_radii(0.075, 0.115, 0.095);
inline constexpr double bone_share = 0.92;

using Map = std::function<Vec3(const Vec3&)>;

inline TriangleMesh globe(const Vec3& radii, int rows = 24, int columns = 48) {
  TriangleMesh mesh;
  mesh.vertices.push_back(Vec3(0, radii.y(), 0));
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double polar = std::numbers::pi * i / rows, around = 2 * std::numbers::pi * j / columns;
      mesh.vertices.push_back(radii.cwiseProduct(
          Vec3(std::sin(polar) * std::sin(around), std::cos(polar), std::sin(polar) * std::cos(around))));
    }
  mesh.vertices.push_back(Vec3(0, -radii.y(), 0));
  const auto at = [&](int i, int j) { return 1 + (i - 1) * columns + j % columns; };
  const int last = mesh.vertex_count() - 1;
  for (int j = 0; j < columns; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({last, at(rows - 1, j + 1), at(rows - 1, j)});
    for (int i = 1; i + 1 < rows; ++i) {
      const bool turned = j >= columns / 2;  // diagonals mirror each other
      const int p = at(i, j), q = at(i + 1, j), r = at(i + 1, j + 1), s = at(i, j + 1);
      mesh.triangles.push_back(turned ? Triangle{p, q, s} : Triangle{p, q, r});
      mesh.triangles.push_back(turned ? Triangle{q, r, s} : Triangle{p, r, s});
    }
  }
  return mesh;
}

inline skull::Generic round_head() {
  skull::Generic generic;
  generic.cranium = globe(bone_share * skin_radii);
  int number = 0;
  for (const Vec3& d : {Vec3(0, 0, 1), Vec3(0, 0.4, 1), Vec3(0, -0.4, 1), Vec3(0, 1, 0.1), Vec3(0, 0.2, -1),
                        Vec3(0, -1, 0.4), Vec3(1, 0, 0.1), Vec3(1, 0.4, 0.8), Vec3(1, -0.5, 0.7),
                        Vec3(0.5, -0.1, 1), Vec3(1, 0.6, -0.6), Vec3(0.8, -0.8, -0.2)}) {
    const bool paired = d.x() != 0;
    for (int side = 0; side < (paired ? 2 : 1); ++side) {
      const Vec3 direction = Vec3(side == 0 ? d.x() : -d.x(), d.y(), d.z()).normalized();
      skull::GenericLandmark landmark;
      landmark.name = "point" + std::to_string(number) + (paired ? (side == 0 ? "_left" : "_right") : "");
      landmark.skin = skin_radii.cwiseProduct(direction);
      landmark.bone = bone_share * landmark.skin;
      landmark.depth = (landmark.skin - landmark.bone).norm();
      landmark.depth_sd = 0.002;
      generic.landmarks.push_back(landmark);
    }
    ++number;
  }
  return generic;
}

/// As round_head, with its skin and two curves: a hoop about the face and the midline of the back.
inline skull::Generic round_head_with_curves() {
  skull::Generic generic = round_head();
  generic.skin = globe(skin_radii);
  skull::BoneCurve hoop{"hoop", true, {}}, back{"back", false, {}};
  for (int k = 0; k < 48; ++k) {
    const double angle =
        2 * std::numbers::pi * k / 48;  // begins on the midplane: mirror images of each other
    hoop.points.push_back(
        bone_share *
        skin_radii.cwiseProduct(Vec3(0.6 * std::sin(angle), 0.6 * std::cos(angle) - 0.1, 0.8).normalized()));
  }
  for (int k = 0; k <= 12; ++k) {
    const double angle = 0.9 * (k / 6.0 - 1);
    back.points.push_back(bone_share * skin_radii.cwiseProduct(Vec3(0, std::sin(angle), -std::cos(angle))));
  }
  generic.curves = {hoop, back};
  return generic;
}

inline std::map<std::string, skull::TargetLandmark> carried(const skull::Generic& generic, const Map& map) {
  std::map<std::string, skull::TargetLandmark> out;
  for (const skull::GenericLandmark& landmark : generic.landmarks)
    out[landmark.name] = {map(landmark.skin), 1};
  return out;
}

inline TriangleMesh mapped(TriangleMesh mesh, const Map& map) {
  for (Vec3& v : mesh.vertices)
    v = map(v);
  return mesh;
}

inline Vec3 same(const Vec3& p) {
  return p;
}

/// Symmetric in x, not affine.
inline Vec3 lean(const Vec3& p) {
  return Vec3(p.x() * (1 - 2 * p.y()), p.y() + 0.4 * p.z() * p.z(), 1.1 * p.z() - 3 * p.x() * p.x());
}

/// Mean distance between two lists of points of the same length.
inline double mean_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += (a[i] - b[i]).norm();
  return sum / static_cast<double>(a.size());
}

}  // namespace fascia::testing
