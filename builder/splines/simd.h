#pragma once

// The inner loops of splines, once per instruction set; plain numbers only, so that no inline library
// function is compiled for an unavailable instruction set.

#include <cstddef>

namespace fascia::splines::simd {

/// Kernel sums of power kernels sign r^exponent, exponent 1 or 3 or 5, at many points:
/// values[i + k * value_stride] += sum_j weights[k * stride + j] phi(|p_i - centre_j|) for `outputs` <= 4.
struct Sum {
  const double *x, *y, *z;  ///< centres
  size_t centres;
  const double* weights;  ///< outputs * stride
  size_t stride;
  int outputs;
  int exponent;
  double sign;
  const double *px, *py, *pz;  ///< points
  size_t points;
  double* values;
  size_t value_stride;
};

/// Value and gradient of such a sum at one point, with dipoles too when `bx` is not null (exponent 3 or 5):
/// sum_j weights[j] phi(|h_j|) - b_j . grad phi(h_j), h_j = p - centre_j, and its three derivatives.
struct GradientSum {
  const double *x, *y, *z;  ///< centres
  size_t centres;           ///< a multiple of 8; padding has weight 0
  const double* weights;
  const double *bx, *by, *bz;
  int exponent;
  double sign;
  double px, py, pz;
  double* out;  ///< value, then gradient: 4
};

/// Lower triangle, column by column, of the matrix of phi(|p_i - p_j|) for the same kernels.
struct KernelMatrix {
  const double *x, *y, *z;
  size_t count;
  int exponent;
  double sign;
  double* entries;  ///< column-major
  size_t stride;
};

/// Lower triangle of a column-major matrix minus left right^T, both `count` by `rank`, column-major and
/// without gaps.
struct RankUpdate {
  double* entries;
  size_t count;
  size_t stride;
  const double* left;
  const double* right;
  size_t rank;
};

/// Cholesky factor in place of the lower triangle of an n by n column-major matrix; false when it is not
/// positive definite.
struct Cholesky {
  double* entries;
  size_t count;
  size_t stride;
};

/// The widest of avx512, avx2 and the baseline that this processor runs; the environment variable
/// FASCIA_SIMD=baseline|avx2 selects a narrower one.
struct Functions {
  const char* name;
  void (*sum)(const Sum&);
  void (*gradient_sum)(const GradientSum&);
  void (*kernel_matrix)(const KernelMatrix&);
  void (*rank_update)(const RankUpdate&);
  bool (*cholesky)(const Cholesky&);
};
const Functions& functions();

namespace baseline {
extern const Functions table;
}
namespace avx2 {
extern const Functions table;
}
namespace avx512 {
extern const Functions table;
}

}  // namespace fascia::splines::simd
