#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace fascia::cli {

/// The largest length of the 3-vectors in a column.
inline float largest_length(const Eigen::Ref<const Eigen::VectorXf>& column) {
  float most = 0.0F;
  for (Eigen::Index i = 0; i + 2 < column.size(); i += 3)
    most = std::max(most, column.segment<3>(i).squaredNorm());
  return std::sqrt(most);
}

}  // namespace fascia::cli
