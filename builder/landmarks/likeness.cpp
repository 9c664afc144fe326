#include "builder/landmarks/likeness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia::landmarks {

namespace {

constexpr double fine_radius = 0.012, broad_radius = 0.024;  // metres of the generic head

double relief_at(const Neighbours& samples, const Vec3& point, const Vec3& normal, double radius) {
  static thread_local std::vector<size_t> near;
  samples.within(point, radius, near);
  Vec3 middle = Vec3::Zero();
  double count = 0.0;
  for (size_t i : near) {
    // The other lip, the far side of an ear: not the surroundings of this place.
    if (samples.samples().normals[i].dot(normal) < -0.2) continue;
    middle += samples.samples().points[i] - point;
    count += 1.0;
  }
  if (count < 4.0) return std::numeric_limits<double>::quiet_NaN();
  return -normal.dot(middle) / (count * radius);
}

/// Correlation of the pairs of which both are numbers; 0 for too few of them or no variation.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double count = 0.0, sum_a = 0.0, sum_b = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) {
      sum_a += a[i];
      sum_b += b[i];
      count += 1.0;
    }
  if (count < 30.0) return 0.0;
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) {
      const double da = a[i] - sum_a / count, db = b[i] - sum_b / count;
      ab += da * db;
      aa += da * da;
      bb += db * db;
    }
  // A smooth ball has no relief; what noise there is must not be blown up to some.
  const double least = count * 0.02 * 0.02;
  return ab / std::sqrt((aa + least) * (bb + least));
}

}  // namespace

Relief relief(const Neighbours& samples, const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
              double scale) {
  Relief all;
  for (size_t i = 0; i < points.size(); ++i) {
    all.fine.push_back(relief_at(samples, points[i], normals[i], fine_radius * scale));
    all.broad.push_back(relief_at(samples, points[i], normals[i], broad_radius * scale));
  }
  return all;
}

double Likeness::score() const {
  return on_mesh * std::min(1.0, coverage / 0.85) * std::max(0.0, relief) * symmetry;
}

Likeness likeness(const GenericFace& face, const Registration& fit, const Neighbours& samples) {
  double good = 0.0, good_here = 0.0, total = 0.0, here = 0.0, features = 0.0, features_here = 0.0;
  double uneven = 0.0, pairs = 0.0;
  std::vector<Vec3> places, normals;
  Relief generic;
  for (size_t i = 0; i < fit.used.size(); ++i) {
    const auto point = static_cast<size_t>(fit.used[i]);
    if (!face.is_face[point]) continue;
    const bool is_on_mesh = fit.overhangs[i] < beyond_edge;
    total += 1.0;
    here += is_on_mesh;
    features += face.is_feature[point];
    features_here += face.is_feature[point] && is_on_mesh;
    const double near = std::exp(-std::pow(fit.residuals[i] / 0.003, 2));
    const double fits = near * std::clamp((fit.agreements[i] - 0.5) / 0.4, 0.0, 1.0);
    good += fits;
    good_here += is_on_mesh ? fits : 0.0;
    const Vec3 there = fit.warp(face.points.points[point]),
               other = fit.warp(face.points.points[static_cast<size_t>(face.mirror[point])]);
    uneven += (there - Vec3(-other[0], other[1], other[2])).squaredNorm();
    pairs += 1.0;
    if (!is_on_mesh || fit.agreements[i] <= 0.0) continue;
    places.push_back(fit.placement(fit.feet[i]));
    normals.push_back(fit.placement.rotation * fit.normals[i]);
    generic.fine.push_back(face.relief.fine[point]);
    generic.broad.push_back(face.relief.broad[point]);
  }
  if (total == 0.0) return {};
  const Relief found = relief(samples, places, normals, fit.placement.scale);
  Likeness like;
  like.share = good / total;
  like.on_mesh = here > 0.0 ? good_here / here : 0.0;
  like.coverage = features > 0.0 ? features_here / features : 0.0;
  like.relief = 0.5 * (correlation(generic.fine, found.fine) + correlation(generic.broad, found.broad));
  like.symmetry = std::exp(-uneven / pairs / (0.020 * 0.020));
  return like;
}

}  // namespace fascia::landmarks
