#include "geometry/dense.h"

namespace fascia::dense {

Matrix product(const Operand& a, const Operand& b) {
  Matrix out = Matrix::Zero(a.rows(), b.cols());
  add_product(1.0, a, b, out);
  return out;
}

Matrix transposed_product(const Operand& a, const Operand& b) {
  Matrix out = Matrix::Zero(a.cols(), b.cols());
  add_transposed_product(1.0, a, b, out);
  return out;
}

void add_product(double scale, const Operand& a, const Operand& b, Eigen::Ref<Matrix> out) {
  out.noalias() += scale * a * b;
}

void add_transposed_product(double scale, const Operand& a, const Operand& b, Eigen::Ref<Matrix> out) {
  out.noalias() += scale * a.transpose() * b;
}

}  // namespace fascia::dense
