#pragma once

#include <string>

#include "anatomy/anatomy.h"
#include "builder/splines/polyharmonic.h"

namespace fascia::skull {

/// Thickness of the soft tissue at any point of the generic face: a polyharmonic spline (kernel -r, affine
/// part) in space through a table's depths at its landmarks on the skin, both sides. It passes through the
/// table, and between and beyond the landmarks stays within the table's least and greatest depth.
class TissueDepthField {
 public:
  /// @param anatomy     landmarks and tables
  /// @param depth_table name of the table; empty: the default one
  /// Throws Error when there is no such table or fewer than four of its depths have a landmark on the skin.
  explicit TissueDepthField(const anatomy::GenericAnatomy& anatomy, const std::string& depth_table = {});

  /// Mean depth under a point on or near the generic skin, metres.
  double mean(const Vec3& skin) const;
  /// Standard deviation between people there, metres; 0 everywhere when the table gives none.
  double deviation(const Vec3& skin) const;

 private:
  splines::Spline mean_;
  splines::Spline deviation_;
  double least_ = 0.0, greatest_ = 0.0;
  double least_deviation_ = 0.0, greatest_deviation_ = 0.0;
};

}  // namespace fascia::skull
