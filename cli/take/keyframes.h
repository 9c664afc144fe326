#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace fascia::cli {

/// Frames to keep of curves that are linear between keys: the first, the last, and as few others as leave
/// every row of `values` (#curves x #frames) within `tolerances` (#curves) of what it was.
std::vector<size_t> keys_of(const Eigen::MatrixXf& values, std::span<const float> tolerances);

/// The same for weights (#components x #frames) of shapes: no vertex of `shapes` (3 #vertices x #components)
/// may be off by more than `tolerance`.
std::vector<size_t> keys_of_shapes(const Eigen::MatrixXf& weights, const Eigen::MatrixXf& shapes,
                                   double tolerance);

/// How far frames `first` + 1 .. `last` - 1 of `values` are off the straight line between the two:
/// #curves x #frames between.
Eigen::MatrixXf off_line(const Eigen::MatrixXf& values, size_t first, size_t last);

}  // namespace fascia::cli
