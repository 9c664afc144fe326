#include "geometry/dense.h"

#include <gtest/gtest.h>

#include <random>

namespace fascia {
namespace {

dense::Matrix some_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  return dense::Matrix::NullaryExpr(rows, columns, [&] { return number(engine); });
}

/// By the definition, entry by entry.
dense::Matrix sum_of_products(const dense::Matrix& a, const dense::Matrix& b) {
  dense::Matrix out = dense::Matrix::Zero(a.rows(), b.cols());
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < b.cols(); ++j)
      for (Eigen::Index k = 0; k < a.cols(); ++k)
        out(i, j) += a(i, k) * b(k, j);
  return out;
}

double largest_difference(const dense::Matrix& a, const dense::Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() ? (a - b).cwiseAbs().maxCoeff() : 1e300;
}

TEST(Dense, ProductsAreSumsOfProductsAtEverySize) {
  for (const Eigen::Index n : {1, 3, 7, 40}) {
    const dense::Matrix a = some_matrix(n + 2, n, 1), b = some_matrix(n, 5, 2), c = some_matrix(n + 2, 5, 3);
    EXPECT_LT(largest_difference(dense::product(a, b), sum_of_products(a, b)), 1e-13) << n;
    EXPECT_LT(largest_difference(dense::transposed_product(a, c), sum_of_products(a.transpose(), c)), 1e-13)
        << n;
  }
}

TEST(Dense, ProductsAreAddedToPartsOfMatrices) {
  const dense::Matrix a = some_matrix(6, 4, 4), b = some_matrix(4, 3, 5), before = some_matrix(9, 8, 6);
  dense::Matrix out = before;
  dense::add_product(-0.5, a.topRows(5), b.rightCols(2), out.block(1, 2, 5, 2));
  dense::Matrix expected = before;
  expected.block(1, 2, 5, 2) -= 0.5 * sum_of_products(a.topRows(5), b.rightCols(2));
  EXPECT_LT(largest_difference(out, expected), 1e-14);
  Eigen::VectorXd slope = before.col(0).head(4);
  dense::add_transposed_product(2.0, a, before.col(1).head(6), slope);
  EXPECT_LT(largest_difference(
                slope, before.col(0).head(4) + 2.0 * sum_of_products(a.transpose(), before.col(1).head(6))),
            1e-14);
}

TEST(Dense, ProductsOfNothingAreZero) {
  EXPECT_EQ(dense::product(dense::Matrix(3, 0), dense::Matrix(0, 2)),
            dense::Matrix(dense::Matrix::Zero(3, 2)));
  EXPECT_EQ(dense::transposed_product(dense::Matrix(4, 0), dense::Matrix(4, 2)).rows(), 0);
}

}  // namespace
}  // namespace fascia
