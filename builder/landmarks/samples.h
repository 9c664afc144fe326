#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "builder/spatial/surface_query.h"
#include "geometry/mesh.h"

namespace fascia::landmarks {

/// Points of a surface with unit outward normals.
struct Samples {
  std::vector<Vec3> points, normals;
  size_t size() const { return points.size(); }
  void add(const Vec3& point, const Vec3& normal) {
    points.push_back(point);
    normals.push_back(normal);
  }
};

/// A ball; radius 0 stands for all of space.
struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;
};

/// About `count` points spread evenly by area over the triangles whose first corner is in `within`,
/// deterministic for a given mesh. Degenerate triangles and coordinates that are not finite are skipped.
Samples sample_evenly(const TriangleMesh& mesh, int count, const Ball& within = {});

/// Those of `samples` from which the ray along the normal leaves `surface`: the lining of mouth, nose and
/// sockets, and what lies inside the head, are excluded.
Samples open_samples(const Samples& samples, const spatial::SurfaceQuery& surface);

/// True when the normals of `surface` point inward by and large: from most of `samples` the ray against the
/// normal leaves the surface and the ray along it does not.
bool is_inside_out(const Samples& samples, const spatial::SurfaceQuery& surface);

/// Nearest samples by distance (kd-tree); `samples` are copied in.
class Neighbours {
 public:
  explicit Neighbours(Samples samples);
  const Samples& samples() const;

  /// Indices of the `count` nearest samples, nearest first; `squared_distances` alike.
  void nearest(const Vec3& point, int count, std::vector<size_t>& indices,
               std::vector<double>& squared_distances) const;

  /// Index of the nearest sample, with its squared distance, where it lies within `radius` of `point`.
  std::optional<std::pair<size_t, double>> nearest_within(const Vec3& point, double radius) const;

  /// Indices of the samples within `radius` of `point`, in no particular order.
  void within(const Vec3& point, double radius, std::vector<size_t>& indices) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace fascia::landmarks
