#include "tools/anatomy/skull/solids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fascia::skull_maker {
namespace {

constexpr double known_reach =
    3.0;  // mm from a solid's surface within which it speaks where the other one is silent

/// Polynomial smooth maximum; its gradient is the blend of the two.
double smooth_maximum(double a, const Vec3& a_gradient, double b, const Vec3& b_gradient, double rounding,
                      Vec3* gradient) {
  const double t = std::clamp(0.5 + 0.5 * (b - a) / rounding, 0.0, 1.0);
  if (gradient) *gradient = (1 - t) * a_gradient + t * b_gradient;
  return (1 - t) * a + t * b + rounding * t * (1 - t);
}

/// Signed distance in the plane x = 0 to a closed polygon, negative inside, and its gradient.
double outline_distance(const std::vector<Vec3>& outline, const Vec3& point, Vec3* gradient) {
  double nearest = std::numeric_limits<double>::max();
  Vec3 offset = Vec3::Zero();
  bool inside = false;
  const Vec3 flat(0, point.y(), point.z());
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec3& a = outline[i];
    const Vec3& b = outline[(i + 1) % outline.size()];
    const double t = std::clamp((flat - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    const Vec3 away = flat - (a + t * (b - a));
    if (away.squaredNorm() < nearest) {
      nearest = away.squaredNorm();
      offset = away;
    }
    if ((a.y() > flat.y()) != (b.y() > flat.y()) &&
        flat.z() < a.z() + (flat.y() - a.y()) / (b.y() - a.y()) * (b.z() - a.z())) {
      inside = !inside;
    }
  }
  const double sign = inside ? -1.0 : 1.0;
  *gradient = nearest > 0 ? Vec3(sign * offset.normalized()) : Vec3::Zero();
  return sign * std::sqrt(nearest);
}

}  // namespace

smas::ImplicitFunction intersection(smas::ImplicitFunction field, smas::ImplicitFunction other,
                                    double rounding) {
  return [=, field = std::move(field), other = std::move(other)](const Vec3& point, Vec3* gradient) {
    Vec3 a_gradient;
    Vec3 b_gradient;
    const double a = field(point, &a_gradient);
    const double b = other(point, &b_gradient);
    if (gradient) *gradient = a_gradient;
    if (!std::isfinite(a) || !std::isfinite(b) || b < a - rounding) return a;
    return smooth_maximum(a, a_gradient, b, b_gradient, rounding, gradient);
  };
}

smas::ImplicitFunction united(smas::ImplicitFunction field, smas::ImplicitFunction other, double rounding) {
  return [=, field = std::move(field), other = std::move(other)](const Vec3& point, Vec3* gradient) {
    Vec3 a_gradient;
    Vec3 b_gradient;
    const double a = field(point, &a_gradient);
    const double b = other(point, &b_gradient);
    if (!std::isfinite(a) && std::abs(b) < known_reach) {
      if (gradient) *gradient = b_gradient;
      return b;
    }
    if (gradient) *gradient = a_gradient;
    if (!std::isfinite(a) || !std::isfinite(b) || b > a + rounding) return a;
    const double value = smooth_maximum(-a, -a_gradient, -b, -b_gradient, rounding, gradient);
    if (gradient) *gradient = -*gradient;
    return -value;
  };
}

smas::ImplicitFunction carved(smas::ImplicitFunction field, smas::ImplicitFunction outside, double rounding) {
  const smas::ImplicitFunction known = [field = std::move(field)](const Vec3& point, Vec3* gradient) {
    const double value = field(point, gradient);
    if (std::isfinite(value)) return value;
    if (gradient) gradient->setZero();
    return -known_reach;
  };
  return [known, outside, cut = intersection(known, outside, rounding)](const Vec3& point, Vec3* gradient) {
    const double value = cut(point, gradient);
    return value <= -known_reach ? std::numeric_limits<double>::quiet_NaN() : value;
  };
}

smas::ImplicitFunction away_from(smas::ImplicitFunction field, double space) {
  return [=, field = std::move(field)](const Vec3& point, Vec3* gradient) {
    const double value = space - field(point, gradient);
    if (gradient) *gradient = -*gradient;
    return value;
  };
}

smas::ImplicitFunction outside_hollow(const std::vector<Vec3>& rim, double depth, std::vector<Vec3>* near) {
  const Vec3 centre = 0.5 * (rim.front() + rim.back());
  const Vec3 along = (rim.back() - rim.front()).normalized();
  const double half_length = 0.5 * (rim.back() - rim.front()).norm();
  double half_width = 0;
  for (const Vec3& point : rim)
    half_width = std::max(half_width, point.x());
  Eigen::Matrix3d shrink;  // to the unit ball
  shrink << Vec3::UnitX() / half_width, along / half_length, Vec3::UnitX().cross(along) / depth;
  for (const Vec3& point : rim) {
    for (const double turn : {0.3, 0.6, 0.9, 1.2, 1.5}) {
      const Vec3 inwards = depth * std::sin(turn) * along.cross(Vec3::UnitX());
      near->push_back(centre + std::cos(turn) * (point - centre) + inwards);
    }
  }
  const double size = std::min({half_width, half_length, depth});
  return [centre, size, axes = Mat3(shrink.transpose())](const Vec3& point, Vec3* gradient) {
    const Vec3 unit = axes * (point - centre);
    const double radius = std::max(unit.norm(), 1e-6);
    if (gradient) *gradient = -size * (axes.transpose() * unit) / radius;
    return -size * (radius - 1.0);
  };
}

smas::ImplicitFunction plate(const std::vector<Vec3>& outline, double half_thickness,
                             std::vector<Vec3>* near) {
  constexpr double spacing = 3.0;
  const Bounds box = bounds(outline);
  for (double y = box.lower.y(); y <= box.upper.y(); y += spacing) {
    for (double z = box.lower.z(); z <= box.upper.z(); z += spacing) {
      Vec3 ignored;
      if (outline_distance(outline, {0, y, z}, &ignored) < 0) near->push_back({0, y, z});
    }
  }
  return [outline, half_thickness](const Vec3& point, Vec3* gradient) {
    Vec3 outline_gradient;
    const double around = outline_distance(outline, point, &outline_gradient) + half_thickness;
    const double across = std::abs(point.x());
    const Vec3 sideways(point.x() < 0 ? -1 : 1, 0, 0);
    // A rounded edge: outside the shrunken outline the distance is to a capsule.
    if (around <= 0) {
      if (gradient) *gradient = sideways;
      return across - half_thickness;
    }
    const double distance = std::hypot(around, across);
    if (gradient) *gradient = (around * outline_gradient + across * sideways) / distance;
    return distance - half_thickness;
  };
}

}  // namespace fascia::skull_maker
