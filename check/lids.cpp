#include "check/lids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::check {
namespace {

// Of the globe's radius: lids lie between these, and beyond the last what else is before the eye, brow and
// fold of the upper lid, as far from small eyes set deep.
constexpr double nearest = 0.75, farthest = 1.55, outside = 2.6;
constexpr double least_before =
    0.01;  // of the globe's radius: a tenth of a millimetre before an eye that stays

}  // namespace

LidFrame::LidFrame(const Vec3& exocanthion, const Vec3& endocanthion, const Eye& eye, bool left)
    : at_right(left ? endocanthion : exocanthion),
      at_left(left ? exocanthion : endocanthion),
      centre_(eye.centre),
      right_((at_right - eye.centre).normalized()),
      left_((at_left - eye.centre).normalized()) {
  up_ = Vec3::UnitZ().cross(at_left - at_right).normalized();
}

Vec3 LidFrame::base(double t) const {
  // Great circle from canthus to canthus over the front of the globe.
  Vec3 axis = right_.cross(left_);
  if (axis.norm() < 1e-9) axis = Vec3::UnitY();
  axis.normalize();
  double angle = std::atan2(right_.cross(left_).dot(axis), right_.dot(left_));
  if (axis.dot(up_) < 0.0) {  // the canthi lie behind the centre: the way round the front
    axis = -axis;
    angle = 2.0 * EIGEN_PI - angle;
  }
  return Eigen::AngleAxisd(t * angle, axis) * right_;
}

Vec3 LidFrame::direction(double t, double angle) const {
  const Vec3 out = base(t), up = (up_ - up_.dot(out) * out).normalized();
  return std::cos(angle) * out + std::sin(angle) * up;
}

double LidFrame::elevation(const Vec3& p, double t) const {
  const Vec3 out = base(t), up = (up_ - up_.dot(out) * out).normalized();
  // Of a place in the middle seen from another station: by its height over the canthi's plane alone.
  const Vec3 d = p - centre_;
  const double height = d.dot(up), forward = std::sqrt(std::max(0.0, d.squaredNorm() - height * height));
  return std::atan2(height, forward);
}

LidLook::LidLook(const Head& head, const Skin& skin, const Eye& eye, const Seam& seam, bool left)
    : head_(head),
      eye_(eye),
      frame_(head.landmarks.at(left ? "exocanthion_left" : "exocanthion_right"),
             head.landmarks.at(left ? "endocanthion_left" : "endocanthion_right"), eye, left),
      lids_(seam.are_shut ? patch_about(skin.rest(), eye.centre, (outside + 0.1) * eye.radius)
                          : moving_patch_about(skin, eye.centre, (outside + 0.1) * eye.radius)),
      face_(skin.rest()) {
  for (size_t p = 0; p < head.parts.size(); ++p)
    if (head.parts[p].name == (left ? "eye_left" : "eye_right")) eyeball_.push_back(p);
  for (size_t s = 0; s < seam.stations.size(); ++s) {
    const double t = seam.stations[s];
    ranges_.push_back({t, frame_.elevation(position(skin.rest(), seam.lower_edge[s]), t),
                       frame_.elevation(position(skin.rest(), seam.upper_edge[s]), t)});
  }
}

bool LidLook::is_sight(const Vec3& ray) const {
  constexpr double far = 12.0;  // of the globe's radius
  const auto hit = face_.first_hit(eye_.centre + outside * eye_.radius * ray, ray, far * eye_.radius);
  return !hit || hit->from_outside;
}

LidState LidLook::look(const std::vector<Vec3>& skin, const Shape& shape) const {
  LidState out;
  if (lids_.triangles.empty()) return out;
  const spatial::SurfaceQuery lids(lids_.mesh(skin));
  const double start = outside * eye_.radius, reach = (outside - nearest) * eye_.radius;
  constexpr double step = 0.004;  // radians: .05 mm on an adult's globe
  constexpr double more = 0.1;    // radians looked at beyond the edges at rest
  const auto is_covered = [&](const Vec3& ray) {
    const Vec3 origin = eye_.centre + outside * eye_.radius * ray;
    if (lids.blocked(origin, -ray, (outside - nearest) * eye_.radius)) return true;
    if (!eyeball_.empty()) return false;
    // A flat eye in one with its lids lies deeper: what has come before what one saw at rest is a lid.
    const auto eye = face_.first_hit(origin, -ray, outside * eye_.radius);
    return eye && lids.blocked(origin, -ray, eye->distance - least_before * eye_.radius);
  };
  for (const auto& [t, low, high] : ranges_) {
    double open = 0.0, sum = 0.0;
    for (double angle = low - more; angle < high + more; angle += step) {
      const Vec3 ray = frame_.direction(t, angle);
      if (is_covered(ray) || !is_sight(ray)) continue;
      open += step * eye_.radius;
      sum += angle * step * eye_.radius;
    }
    out.gaps.push_back(open);
    if (open <= out.widest) continue;
    out.widest = open;
    out.place = eye_.centre + eye_.radius * frame_.direction(t, sum / open);
  }
  TriangleMesh ball_mesh;
  for (const size_t part : eyeball_) {
    const int first = ball_mesh.vertex_count();
    ball_mesh.vertices.insert(ball_mesh.vertices.end(), shape[part].begin(), shape[part].end());
    for (const Triangle& t : head_.parts[part].mesh.triangles)
      ball_mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  if (ball_mesh.triangles.empty()) return out;
  const spatial::SurfaceQuery ball(std::move(ball_mesh));
  for (const auto& [t, low, high] : ranges_)
    for (double angle = low - more; angle < high + more; angle += 0.02) {
      const Vec3 ray = frame_.direction(t, angle), origin = eye_.centre + start * ray;
      const auto lid = lids.first_hit(origin, -ray, reach);
      if (!lid) continue;  // a gap, counted above
      const auto eye = ball.first_hit(origin, -ray, reach);
      if (!eye || lid->distance - eye->distance <= out.cornea_out) continue;
      out.cornea_out = lid->distance - eye->distance;
      out.cornea_place = eye->position;
    }
  return out;
}

}  // namespace fascia::check
