#include "builder/skull/curve_points.h"

#include <algorithm>
#include <cmath>

#include "builder/skull/clearance.h"
#include "builder/skull/landmark_pairs.h"

namespace fascia::skull {
namespace {

constexpr double reach = 0.040;     // m; farther out there is other skin
constexpr double slide_sd = 0.004;  // m along the skin, between heads that landmarks have aligned

// Points at equal distances along a polyline, ends included.
std::vector<Vec3> resampled(std::vector<Vec3> line, bool closed, double spacing) {
  if (closed && !line.empty()) line.push_back(line.front());
  std::vector<double> along{0};
  for (size_t i = 1; i < line.size(); ++i)
    along.push_back(along.back() + (line[i] - line[i - 1]).norm());
  if (line.size() < 2 || !(along.back() > 0)) return {};
  const int pieces = std::max(1, static_cast<int>(std::round(along.back() / spacing)));
  std::vector<Vec3> out;
  for (int k = 0; k < pieces + (closed ? 0 : 1); ++k) {
    const double s = along.back() * k / pieces;
    const size_t next = std::clamp<size_t>(
        static_cast<size_t>(std::lower_bound(along.begin(), along.end(), s) - along.begin()), 1,
        line.size() - 1);
    const double t = (s - along[next - 1]) / std::max(1e-12, along[next] - along[next - 1]);
    out.push_back(line[next - 1] + t * (line[next] - line[next - 1]));
  }
  return out;
}

// Deviation at a point: of the landmarks around by inverse distance, and more the farther these are.
double deviation_at(const Generic& generic, const Vec3& point) {
  double sum = 0, total = 0, nearest = 1;
  for (const GenericLandmark& landmark : generic.landmarks) {
    if (!landmark.has_bone) continue;
    const double distance = (landmark.bone - point).norm();
    const double weight = 1 / (distance * distance + 1e-8);
    sum += weight * landmark.depth_sd;
    total += weight;
    nearest = std::min(nearest, distance);
  }
  return total > 0 ? sum / total + 0.05 * nearest : 0.01;
}

}  // namespace

std::vector<CurvePoint> curve_points(const Generic& generic, double spacing) {
  std::vector<CurvePoint> out;
  if (generic.skin.empty() || !(spacing > 0)) return out;
  std::vector<Vec3> bones;
  for (const BoneCurve& curve : generic.curves)
    for (const Vec3& p : resampled(curve.points, curve.closed, spacing))
      // Where curves meet one point is enough; the two sides of the midline stay apart.
      if (std::none_of(bones.begin(), bones.end(),
                       [&](const Vec3& other) { return (other - p).norm() < 0.0005; }))
        bones.push_back(p);
  const std::vector<SkinOver> over = skin_over(generic, bones);
  for (size_t i = 0; i < bones.size(); ++i) {
    CurvePoint point;
    point.bone = bones[i];
    point.outward = over[i].outward;
    // On the midplane the nearest skin is a tie between left and right.
    if (std::abs(point.bone.x()) < 1e-4)
      point.outward = Vec3(0, point.outward.y(), point.outward.z()).normalized();
    point.depth = over[i].depth;
    point.deviation = deviation_at(generic, bones[i]);
    const bool near_landmark =
        std::any_of(generic.landmarks.begin(), generic.landmarks.end(),
                    [&](const auto& l) { return l.has_bone && (l.bone - bones[i]).norm() < 0.003; });
    if (!near_landmark) out.push_back(point);
  }
  return out;
}

void aim(std::vector<CurvePoint>& points, std::span<const Vec3> positions, const std::vector<Mat3>& jacobians,
         const Exterior& skin, double tissue_scale, double skin_share) {
  for (size_t i = 0; i < points.size(); ++i) {
    CurvePoint& point = points[i];
    point.used = false;
    point.target = positions[i];
    Vec3 outward = jacobians[i] * point.outward;
    if (!(outward.norm() > 1e-9)) continue;
    outward.normalize();
    // From a little deeper: the point may have come out of the skin.
    const Vec3 start = positions[i] - 0.010 * outward;
    const auto hit = skin.surface.first_hit(start, outward, reach);
    if (!hit || hit->from_outside) continue;
    const Vec3 normal = mean_skin_normal(skin.surface, hit->position);
    if (normal.dot(outward) < 0.5) continue;
    point.direction = ((1 - skin_share) * outward + skin_share * normal).normalized();
    point.target = hit->position - tissue_scale * point.depth * point.direction;
    point.used = true;
  }
}

void append_observations(const std::vector<CurvePoint>& points, std::vector<Observation>& out) {
  for (const CurvePoint& point : points)
    out.push_back({point.bone, point.target, point.deviation, point.direction, slide_sd, point.used});
}

}  // namespace fascia::skull
