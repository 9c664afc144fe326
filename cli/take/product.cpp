#include "cli/take/product.h"

#include <vector>

#include "cli/take/product_loops.h"
#include "sim/lanes/instruction_set.h"

namespace fascia::cli {

namespace {

using Loop = void (*)(const ProductParts&);

Loop widest_loop() {
#if defined(__x86_64__)
  switch (sim::lanes::instruction_set()) {
    case sim::lanes::InstructionSet::avx512:
      return product_avx512;
    case sim::lanes::InstructionSet::avx2:
      return product_avx2;
    case sim::lanes::InstructionSet::baseline:
      break;
  }
#endif
  return product_baseline;
}

}  // namespace

void product(std::span<const float* const> columns, Eigen::Index rows, const Eigen::MatrixXf& mix,
             Eigen::MatrixXf& out) {
  static const Loop loop = widest_loop();
  out.resize(rows, mix.cols());
  std::vector<float> scratch(product_rows * columns.size());
  loop({columns.data(), static_cast<size_t>(rows), columns.size(), mix.data(),
        static_cast<size_t>(mix.cols()), out.data(), scratch.data()});
}

Eigen::MatrixXf product(const Eigen::MatrixXf& matrix, const Eigen::MatrixXf& mix) {
  std::vector<const float*> columns;
  for (Eigen::Index k = 0; k < mix.rows(); ++k)
    columns.push_back(matrix.col(k).data());
  Eigen::MatrixXf result;
  product(columns, matrix.rows(), mix, result);
  return result;
}

}  // namespace fascia::cli
