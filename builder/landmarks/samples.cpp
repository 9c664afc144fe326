#include "builder/landmarks/samples.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

namespace fascia::landmarks {

namespace {

/// The i-th point of the additive recurrence with the plastic number: evenly spread in the unit square.
Vec2 spread(size_t i) {
  const double plastic = 1.32471795724474602596;
  const double x = 0.5 + static_cast<double>(i) / plastic,
               y = 0.5 + static_cast<double>(i) / (plastic * plastic);
  return {x - std::floor(x), y - std::floor(y)};
}

/// How far a sample is lifted off its triangle before a ray is cast: a share of the sampled extent.
double lift_of(const Samples& samples) {
  return 1e-4 * bounds(samples.points).size().norm();
}

}  // namespace

Samples sample_evenly(const TriangleMesh& mesh, int count, const Ball& within) {
  std::vector<double> area(mesh.triangles.size(), 0.0);
  double total = 0.0;
  for (size_t t = 0; t < area.size(); ++t) {
    const Vec3& corner = mesh.vertices[static_cast<size_t>(mesh.triangles[t][0])];
    if (within.radius > 0.0 && (corner - within.centre).squaredNorm() > within.radius * within.radius)
      continue;
    const double a = triangle_area(mesh, static_cast<int>(t));
    if (std::isfinite(a)) area[t] = a;
    total += area[t];
  }
  Samples samples;
  if (!(total > 0.0)) return samples;
  const double step = total / count;
  double until = -0.5 * step;
  for (size_t t = 0; t < area.size(); ++t) {
    for (until += area[t]; until > 0.0; until -= step) {
      Vec2 at = spread(samples.size());
      if (at[0] + at[1] > 1.0) at = Vec2::Ones() - at;
      const SurfacePoint place{static_cast<int>(t), Vec3(1.0 - at[0] - at[1], at[0], at[1])};
      samples.add(position(mesh, place), triangle_normal(mesh, place.triangle));
    }
  }
  return samples;
}

Samples open_samples(const Samples& samples, const spatial::SurfaceQuery& surface) {
  Samples open;
  const double lift = lift_of(samples);
  for (size_t i = 0; i < samples.size(); ++i)
    if (!surface.blocked(samples.points[i] + lift * samples.normals[i], samples.normals[i]))
      open.add(samples.points[i], samples.normals[i]);
  return open;
}

bool is_inside_out(const Samples& samples, const spatial::SurfaceQuery& surface) {
  const double lift = lift_of(samples);
  const size_t stride = std::max<size_t>(1, samples.size() / 400);
  int outward = 0, inward = 0;
  for (size_t i = 0; i < samples.size(); i += stride) {
    const Vec3& n = samples.normals[i];
    const bool is_free_along = !surface.blocked(samples.points[i] + lift * n, n);
    const bool is_free_against = !surface.blocked(samples.points[i] - lift * n, -n);
    outward += is_free_along && !is_free_against;
    inward += is_free_against && !is_free_along;
  }
  return inward > 2 * outward;
}

struct Neighbours::State {
  struct Cloud {
    const std::vector<Vec3>* points;
    size_t kdtree_get_point_count() const { return points->size(); }
    double kdtree_get_pt(size_t i, size_t axis) const {
      return (*points)[i][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;
  Samples samples;
  std::unique_ptr<Tree> tree;
  Cloud cloud{nullptr};
};

Neighbours::Neighbours(Samples samples) {
  auto state = std::make_shared<State>();
  state->samples = std::move(samples);
  state->cloud.points = &state->samples.points;
  state->tree = std::make_unique<State::Tree>(3, state->cloud, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  state_ = std::move(state);
}

const Samples& Neighbours::samples() const {
  return state_->samples;
}

void Neighbours::nearest(const Vec3& point, int count, std::vector<size_t>& indices,
                         std::vector<double>& squared_distances) const {
  indices.resize(static_cast<size_t>(count));
  squared_distances.resize(static_cast<size_t>(count));
  nanoflann::KNNResultSet<double> found(static_cast<size_t>(count));
  found.init(indices.data(), squared_distances.data());
  state_->tree->findNeighbors(found, point.data(), nanoflann::SearchParams());
  indices.resize(found.size());
  squared_distances.resize(found.size());
}

std::optional<std::pair<size_t, double>> Neighbours::nearest_within(const Vec3& point, double radius) const {
  size_t index = 0;
  double squared = 0.0;
  nanoflann::KNNResultSet<double> found(1);
  found.init(&index, &squared);
  squared = radius * radius;  // the result set takes what is nearer than its last place
  state_->tree->findNeighbors(found, point.data(), nanoflann::SearchParams());
  if (found.size() == 0) return std::nullopt;
  return std::pair(index, squared);
}

void Neighbours::within(const Vec3& point, double radius, std::vector<size_t>& indices) const {
  static thread_local std::vector<std::pair<uint32_t, double>> found;
  found.clear();
  const bool sorted = false;
  state_->tree->radiusSearch(point.data(), radius * radius, found, nanoflann::SearchParams(32, 0.0F, sorted));
  indices.clear();
  for (const auto& [index, squared] : found)
    indices.push_back(index);
}

}  // namespace fascia::landmarks
