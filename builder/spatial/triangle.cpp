#include "builder/spatial/triangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia::spatial {
namespace {

Vec3 on_longest_edge(const Vec3& point, const std::array<Vec3, 3>& corner) {
  Vec3 best = Vec3::UnitX();
  double least = (point - corner[0]).squaredNorm();
  for (int e = 0; e < 3; ++e) {
    const Vec3 &from = corner[e], &to = corner[(e + 1) % 3];
    const double length = (to - from).squaredNorm();
    const double s = length > 0 ? std::clamp((point - from).dot(to - from) / length, 0.0, 1.0) : 0.0;
    const double distance = (point - (from + s * (to - from))).squaredNorm();
    if (distance < least) {
      least = distance;
      best.setZero();
      best[e] = 1 - s;
      best[(e + 1) % 3] = s;
    }
  }
  return best;
}

}  // namespace

Vec3 closest_barycentric(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = point - a;
  // Without area the regions below lose their meaning.
  if (!(ab.cross(ac).squaredNorm() > 1e-28 * ab.squaredNorm() * ac.squaredNorm()))
    return on_longest_edge(point, {a, b, c});
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return Vec3(1, 0, 0);
  const Vec3 bp = point - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return Vec3(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return Vec3(1 - v, v, 0);
  }
  const Vec3 cp = point - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return Vec3(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return Vec3(1 - w, 0, w);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && (d4 - d3) >= 0 && (d5 - d6) >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return Vec3(0, 1 - w, w);
  }
  const double v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  return Vec3(std::max(0.0, 1 - v - w), v, w);  // rounding may take it below zero on the edge
}

double solid_angle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = a - point, v = b - point, w = c - point;
  const double lu = u.norm(), lv = v.norm(), lw = w.norm();
  const double numerator = u.dot(v.cross(w));
  const double denominator = lu * lv * lw + u.dot(v) * lw + v.dot(w) * lu + w.dot(u) * lv;
  return 2 * std::atan2(numerator, denominator);
}

bool intersect_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c,
                     double& t, Vec3& barycentric) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 normal = ab.cross(ac);
  const double slope = normal.dot(direction);
  if (slope == 0 || !std::isfinite(slope)) return false;
  t = normal.dot(a - origin) / slope;
  const Vec3 ap = origin + t * direction - a;
  const double area = normal.squaredNorm();
  double v = std::clamp(normal.dot(ap.cross(ac)) / area, 0.0, 1.0);
  double w = std::clamp(normal.dot(ab.cross(ap)) / area, 0.0, 1.0);
  if (v + w > 1) {
    const double sum = v + w;
    v /= sum;
    w /= sum;
  }
  barycentric = Vec3(1 - v - w, v, w);
  return true;
}

}  // namespace fascia::spatial
