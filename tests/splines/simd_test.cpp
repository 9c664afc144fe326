#include "builder/splines/simd.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

#include "builder/splines/spline.h"
#include "tests/splines/scatter.h"

namespace fascia::splines::simd {
namespace {

/// Every set of loops that this machine runs.
std::vector<const Functions*> all() {
  std::vector<const Functions*> out = {&baseline::table};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    out.push_back(&avx2::table);
    if (__builtin_cpu_supports("avx512f")) out.push_back(&avx512::table);
  }
#endif
  return out;
}

struct Coordinates {
  std::vector<double> x, y, z;
  explicit Coordinates(const std::vector<Vec3>& points) {
    for (const Vec3& p : points) {
      x.push_back(p.x());
      y.push_back(p.y());
      z.push_back(p.z());
    }
  }
};

TEST(Simd, SumsAreRightToTheLastDigitsOnEveryUnit) {
  constexpr int centres = 45, stride = 48;
  const std::vector<Vec3> sites = scattered(centres, 1);
  Coordinates c(sites);
  for (auto* array : {&c.x, &c.y, &c.z})
    array->resize(stride, 0);
  for (int outputs : {1, 2, 3, 4}) {
    std::vector<double> weights(static_cast<size_t>(stride * outputs), 0);
    for (int k = 0; k < outputs; ++k)
      for (int j = 0; j < centres; ++j)
        weights[static_cast<size_t>(k * stride + j)] = std::sin(1.0 + j + 7 * k);
    for (int count : {1, 3, 4, 15, 16, 17, 70}) {
      std::vector<Vec3> points = scattered(count, 2);
      points[0] = sites[7];  // at a centre the root's argument is 0
      const Coordinates p(points);
      for (int exponent : {1, 3, 5})
        for (const Functions* functions : all()) {
          std::vector<double> values(static_cast<size_t>(count * outputs), 0.5);
          functions->sum({c.x.data(), c.y.data(), c.z.data(), centres, weights.data(), stride, outputs,
                          exponent, -1, p.x.data(), p.y.data(), p.z.data(), static_cast<size_t>(count),
                          values.data(), static_cast<size_t>(count)});
          for (int i = 0; i < count; ++i)
            for (int k = 0; k < outputs; ++k) {
              long double exact = 0.5, size = 1;
              for (int j = 0; j < centres; ++j) {
                const long double dx = static_cast<long double>(p.x[i]) - c.x[j],
                                  dy = static_cast<long double>(p.y[i]) - c.y[j],
                                  dz = static_cast<long double>(p.z[i]) - c.z[j];
                const long double term = weights[static_cast<size_t>(k * stride + j)] *
                                         std::pow(std::sqrt(dx * dx + dy * dy + dz * dz), exponent);
                exact -= term;
                size += std::abs(term);
              }
              EXPECT_NEAR(values[static_cast<size_t>(i + k * count)], static_cast<double>(exact),
                          static_cast<double>(4e-16L * size))
                  << functions->name << ' ' << exponent << ' ' << count;
            }
        }
    }
  }
}

TEST(Simd, GradientSumsAreRightToTheLastDigitsOnEveryUnit) {
  constexpr int centres = 45, stride = 48;
  const std::vector<Vec3> sites = scattered(centres, 4);
  Coordinates c(sites);
  for (auto* array : {&c.x, &c.y, &c.z})
    array->resize(stride, 0);
  std::vector<double> weights(stride, 0), b[3];
  for (int j = 0; j < centres; ++j)
    weights[static_cast<size_t>(j)] = std::sin(1.0 + j);
  for (int k = 0; k < 3; ++k) {
    b[k].assign(stride, 0);
    for (int j = 0; j < centres; ++j)
      b[k][static_cast<size_t>(j)] = std::cos(2.0 + j + 5 * k);
  }
  for (const Vec3& p :
       {sites[7], Vec3(0.3, -0.2, 0.1), Vec3(4, 5, -6)})  // at a centre all that is radial is 0
    for (int exponent : {1, 3, 5})
      for (bool dipoles : {false, true}) {
        if (exponent == 1 && dipoles) continue;
        const Kernel kernel(exponent);
        double exact[4] = {}, size = 1;
        for (int j = 0; j < centres; ++j) {
          const size_t at = static_cast<size_t>(j);
          const Vec3 h = p - sites[at], dipole = dipoles ? Vec3(b[0][at], b[1][at], b[2][at]) : Vec3(0, 0, 0);
          const Radial radial = kernel.radial(h.squaredNorm());
          const Vec3 gradient = weights[at] * radial.g * h - radial.g * dipole - radial.s * dipole.dot(h) * h;
          exact[0] += weights[at] * radial.phi - radial.g * dipole.dot(h);
          for (int k = 0; k < 3; ++k)
            exact[k + 1] += gradient[k];
          size += std::abs(radial.phi) + 6 * std::abs(radial.g) * (1 + h.norm());
        }
        for (const Functions* functions : all()) {
          double out[4];
          functions->gradient_sum({c.x.data(), c.y.data(), c.z.data(), stride, weights.data(),
                                   dipoles ? b[0].data() : nullptr, b[1].data(), b[2].data(), exponent,
                                   kernel.sign(), p.x(), p.y(), p.z(), out});
          for (int k = 0; k < 4; ++k)
            EXPECT_NEAR(out[k], exact[k], 2e-15 * size) << functions->name << ' ' << exponent;
        }
      }
}

TEST(Simd, KernelMatricesOnEveryUnit) {
  for (int count : {1, 5, 8, 9, 40}) {
    const Coordinates p(scattered(count, 3));
    for (int exponent : {1, 3, 5})
      for (const Functions* functions : all()) {
        Eigen::MatrixXd K = Eigen::MatrixXd::Constant(count, count, 99);
        functions->kernel_matrix({p.x.data(), p.y.data(), p.z.data(), static_cast<size_t>(count), exponent, 1,
                                  K.data(), static_cast<size_t>(count)});
        for (int j = 0; j < count; ++j)
          for (int i = 0; i < count; ++i) {
            const double r = std::hypot(p.x[i] - p.x[j], p.y[i] - p.y[j], p.z[i] - p.z[j]);
            EXPECT_NEAR(K(i, j), i >= j ? std::pow(r, exponent) : 99, 1e-14 * (1 + std::pow(r, exponent)));
          }
      }
  }
}

TEST(Simd, RankUpdatesOnEveryUnit) {
  for (int n : {1, 6, 17, 50}) {
    const Eigen::MatrixXd left = Eigen::MatrixXd::Random(n, 8), right = Eigen::MatrixXd::Random(n, 8);
    const Eigen::MatrixXd before = Eigen::MatrixXd::Random(n, n);
    for (const Functions* functions : all()) {
      Eigen::MatrixXd after = before;
      const size_t count = static_cast<size_t>(n);
      functions->rank_update({after.data(), count, count, left.data(), right.data(), 8});
      const Eigen::MatrixXd exact = before - left * right.transpose();
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          EXPECT_NEAR(after(i, j), i >= j ? exact(i, j) : before(i, j), 1e-14);
    }
  }
}

TEST(Simd, CholeskyOfEverySizeOnEveryUnit) {
  for (int n : {1, 2, 3, 7, 24, 25, 63, 64, 65, 88, 127, 129, 200, 263}) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
    const Eigen::MatrixXd A = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
    for (const Functions* functions : all()) {
      // Within a larger matrix, whose other entries must stay.
      Eigen::MatrixXd held = Eigen::MatrixXd::Constant(n + 3, n + 3, 77);
      held.bottomRightCorner(n, n) = A;
      ASSERT_TRUE(functions->cholesky({&held(3, 3), static_cast<size_t>(n), static_cast<size_t>(n + 3)}))
          << n;
      const Eigen::MatrixXd L = held.bottomRightCorner(n, n).triangularView<Eigen::Lower>();
      EXPECT_LT((L * L.transpose() - A).norm(), 1e-14 * n * A.norm()) << functions->name << ' ' << n;
      EXPECT_EQ(held.topRows(3).minCoeff(), 77);
      EXPECT_EQ(held.leftCols(3).minCoeff(), 77);
    }
  }
}

TEST(Simd, CholeskyReportsIndefiniteMatrices) {
  for (int n : {1, 30, 150})
    for (const Functions* functions : all())
      for (double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
        Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
        A(n - 1, n - 1) = bad;
        EXPECT_FALSE(functions->cholesky({A.data(), static_cast<size_t>(n), static_cast<size_t>(n)}));
      }
}

TEST(Simd, TheChosenOneRunsHere) {
  bool found = false;
  for (const Functions* functions : all())
    found |= functions == &simd::functions();
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace fascia::splines::simd
