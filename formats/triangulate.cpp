#include <Eigen/Geometry>

#include "formats/detail.h"

namespace fascia::formats::detail {

namespace {

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The polygon in its plane, counter-clockwise: along its area vector (Newell; Sutherland, Sproull and
/// Schumacker 1974).
std::vector<Vec2> flattened(const std::vector<Vec3>& corners) {
  Vec3 area = Vec3::Zero();
  for (size_t i = 0; i < corners.size(); ++i)
    area += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  const Vec3 normal = area.squaredNorm() > 0 ? Vec3(area.normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 across = normal.unitOrthogonal(), up = normal.cross(across);
  std::vector<Vec2> flat;
  for (const Vec3& p : corners)
    flat.emplace_back(across.dot(p - corners[0]), up.dot(p - corners[0]));
  return flat;
}

/// True when the corner `i` of what is left can be cut off: it is convex and no other corner lies in it.
bool is_ear(const std::vector<Vec2>& flat, const std::vector<size_t>& left, size_t i) {
  const size_t n = left.size();
  const Vec2 &a = flat[left[(i + n - 1) % n]], &b = flat[left[i]], &c = flat[left[(i + 1) % n]];
  if (cross(a, b, c) <= 0) return false;
  for (size_t k = 2; k + 1 < n; ++k) {
    const Vec2& p = flat[left[(i + k) % n]];
    if (p == a || p == b || p == c) continue;
    if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
  }
  return true;
}

/// Ear clipping (Meisters 1975). Where the outline crosses itself and has no ear, any corner goes.
void clip_ears(const std::vector<Vec3>& corners, const std::vector<int>& polygon,
               std::vector<Triangle>& triangles) {
  const std::vector<Vec2> flat = flattened(corners);
  std::vector<size_t> left(polygon.size());
  for (size_t i = 0; i < left.size(); ++i)
    left[i] = i;
  for (size_t i = 1, missed = 0; left.size() > 2;) {
    const size_t n = left.size();
    i %= n;
    if (!is_ear(flat, left, i) && missed < n) {
      ++i;
      ++missed;
      continue;
    }
    triangles.push_back({polygon[left[(i + n - 1) % n]], polygon[left[i]], polygon[left[(i + 1) % n]]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    missed = 0;
  }
}

bool is_folded(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot((c - a).cross(d - a)) < 0;
}

}  // namespace

void triangulate(const std::vector<Vec3>& positions, const std::vector<int>& polygon,
                 std::vector<Triangle>& triangles) {
  std::vector<Vec3> corners;
  for (const int corner : polygon) {
    if (corner < 0 || corner >= static_cast<int>(positions.size())) {
      triangles.push_back({corner, corner, corner});  // the reader's own check names it
      return;
    }
    corners.push_back(positions[static_cast<size_t>(corner)]);
  }
  if (polygon.size() == 3) triangles.push_back({polygon[0], polygon[1], polygon[2]});
  if (polygon.size() == 4) {
    // Along the shorter diagonal, unless that folds a quad over which the other leaves flat.
    const bool second = (corners[1] - corners[3]).squaredNorm() < (corners[0] - corners[2]).squaredNorm();
    const bool first_folds = is_folded(corners[0], corners[1], corners[2], corners[3]);
    const bool second_folds = is_folded(corners[1], corners[2], corners[3], corners[0]);
    const bool along_second = first_folds != second_folds ? first_folds : second;
    if (along_second) {
      triangles.push_back({polygon[0], polygon[1], polygon[3]});
      triangles.push_back({polygon[1], polygon[2], polygon[3]});
    } else {
      triangles.push_back({polygon[0], polygon[1], polygon[2]});
      triangles.push_back({polygon[0], polygon[2], polygon[3]});
    }
  }
  if (polygon.size() > 4) clip_ears(corners, polygon, triangles);
}

}  // namespace fascia::formats::detail
