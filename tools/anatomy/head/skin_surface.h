#pragma once

#include <vector>

#include "tools/anatomy/head/figures.h"

namespace fascia::head_maker {

/// The smooth outer surface through measured section profiles: an implicit moving-least-squares surface of
/// points with normals. Each sample gives the distance along the mean of its own normal and the local one,
/// which is exact on spheres, so that the surface does not shrink where it is curved (after Kolluri 2008,
/// Provably good moving least squares, section 3, with Hermite samples).
class SkinSurface {
 public:
  /// `samples` of the left half; the mirror images of those near the midline are added.
  explicit SkinSurface(const std::vector<Sample>& samples);

  /// The point of the surface near `point` (mm) on a side that faces along `normal` (any length; zero for no
  /// preference).
  Vec3 project(const Vec3& point, const Vec3& normal) const;

 private:
  const Sample* nearest(const Vec3& point, const Vec3& normal) const;
  template <typename Visit>
  void visit_near(const Vec3& point, const Visit& visit) const;

  std::vector<Sample> samples_;
  Eigen::Vector3i cells_;
  Vec3 lower_;
  std::vector<std::vector<int>> bins_;
};

}  // namespace fascia::head_maker
