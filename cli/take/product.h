#pragma once

#include <Eigen/Core>
#include <span>

namespace fascia::cli {

/// out = A mix, where A's columns are `rows` floats each at `columns` (#depth), on the widest vector unit
/// there is. `mix` is #depth x #count and `out` becomes rows x #count. Every sum runs through the columns in
/// their order, so that the bits are the same on every unit.
void product(std::span<const float* const> columns, Eigen::Index rows, const Eigen::MatrixXf& mix,
             Eigen::MatrixXf& out);

/// The same for a matrix's first columns, as many as `mix` has rows.
Eigen::MatrixXf product(const Eigen::MatrixXf& matrix, const Eigen::MatrixXf& mix);

}  // namespace fascia::cli
