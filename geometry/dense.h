#pragma once

#include <Eigen/Core>

/// Products of dynamically sized matrices, compiled once: Eigen's kernels take the compiler a second for
/// every pair of types they multiply. Operands may be parts of matrices (`leftCols`, `block`); they are read
/// in place.
namespace fascia::dense {

using Matrix = Eigen::MatrixXd;
using Operand = Eigen::Ref<const Matrix>;

/// a b.
Matrix product(const Operand& a, const Operand& b);
/// a^T b.
Matrix transposed_product(const Operand& a, const Operand& b);
/// out += scale a b. `out` shares no memory with `a` and `b`.
void add_product(double scale, const Operand& a, const Operand& b, Eigen::Ref<Matrix> out);
/// out += scale a^T b. `out` shares no memory with `a` and `b`.
void add_transposed_product(double scale, const Operand& a, const Operand& b, Eigen::Ref<Matrix> out);

}  // namespace fascia::dense
