#include "builder/muscles/depth.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fascia::muscles {

Depths::Depths(const Carrier& smas, const spatial::SurfaceQuery& skin,
               std::vector<const spatial::SurfaceQuery*> floors, double deepest)
    : smas_(smas),
      skin_(skin),
      floors_(std::move(floors)),
      deepest_(deepest),
      measured_(smas.surface.mesh.vertices.size()) {}

Depths::Layers Depths::layers(const SurfacePoint& place) const {
  Layers mixed{0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const int corner = smas_.surface.mesh.triangles[place.triangle][i];
    Layers& layer = measured_[corner];
    if (layer.over < 0.0) {
      const Vec3& vertex = smas_.surface.mesh.vertices[corner];
      layer.over = skin_.closest(vertex).distance;
      layer.under = deepest_;
      for (const spatial::SurfaceQuery* floor : floors_) {
        const spatial::ClosestPoint closest = floor->closest(vertex, deepest_);
        // Signed: where the SMAS runs inside a bone, the bone's surface is above it.
        if (closest.found()) layer.under = std::min(layer.under, closest.signed_distance);
      }
      layer.under = std::max(layer.under, -layer.over);
    }
    mixed.over += place.barycentric[i] * layer.over;
    mixed.under += place.barycentric[i] * layer.under;
  }
  return mixed;
}

FibrePoint Depths::at(const SurfacePoint& place, double fraction) const {
  const Layers here = layers(place);
  FibrePoint point;
  point.smas = place;
  point.offset = here.over - fraction * (here.over + here.under);
  point.position = smas_.at(place) + point.offset * smas_.normal(place);
  return point;
}

FibrePoint Depths::near(const Vec3& position, double fraction) const {
  const spatial::ClosestPoint closest = smas_.query.closest(position);
  const Vec3 normal = smas_.query.smooth_normal(closest.surface), gap = position - closest.position;
  return (gap - normal * normal.dot(gap)).norm() < 5e-4 ? at(closest.surface, fraction)
                                                        : unbound(smas_, position);
}

double Depths::thickness(const SurfacePoint& place) const {
  const Layers here = layers(place);
  return here.over + here.under;
}

double sampled(const std::vector<double>& samples, double share) {
  if (samples.empty()) return 0.5;
  const double at = std::clamp(share, 0.0, 1.0) * double(samples.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), samples.size() - 1);
  const size_t j = std::min(i + 1, samples.size() - 1);
  return samples[i] + (at - double(i)) * (samples[j] - samples[i]);
}

double polyline_length(const std::vector<Vec3>& points) {
  double sum = 0.0;
  for (size_t i = 0; i + 1 < points.size(); ++i)
    sum += (points[i + 1] - points[i]).norm();
  return sum;
}

std::vector<Vec3> resampled(const std::vector<Vec3>& points, int count) {
  const double step = polyline_length(points) / (count - 1);
  std::vector<Vec3> even;
  size_t segment = 0;
  double passed = 0.0;  // length before the segment
  for (int i = 0; i < count; ++i) {
    const double wanted = i * step;
    double length = 0.0;
    while (segment + 1 < points.size()) {
      length = (points[segment + 1] - points[segment]).norm();
      if (passed + length >= wanted || segment + 2 == points.size()) break;
      passed += length;
      ++segment;
    }
    const double share = length > 0.0 ? std::clamp((wanted - passed) / length, 0.0, 1.0) : 0.0;
    even.push_back(segment + 1 < points.size()
                       ? Vec3(points[segment] + share * (points[segment + 1] - points[segment]))
                       : points.back());
  }
  return even;
}

int point_count(double length, const Options& options) {
  return std::clamp(static_cast<int>(std::lround(length / options.point_spacing)) + 1, options.fewest_points,
                    options.most_points);
}

int fibre_count(double width, const anatomy::Muscle& muscle, const Options& options) {
  const auto edit = options.edits.find(muscle.name);
  const double spacing =
      edit == options.edits.end() ? options.spacing : edit->second.spacing.value_or(options.spacing);
  const double denser = std::max(1.0, Options().spacing / spacing);
  const int most = static_cast<int>(std::lround(options.most_fibres * denser));
  const int count = static_cast<int>(std::lround(width / spacing)) + 1;
  return std::max(std::clamp(count, options.fewest_fibres, most), muscle.bundles);
}

FibrePoint unbound(const Carrier& smas, const Vec3& position) {
  const spatial::ClosestPoint closest = smas.query.closest(position);
  FibrePoint point;
  point.position = position;
  point.smas = closest.surface;
  point.offset = closest.signed_distance;
  point.bound = false;
  return point;
}

}  // namespace fascia::muscles
