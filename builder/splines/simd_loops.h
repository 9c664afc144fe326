// The loops behind simd.h, included once by each of the sources that are compiled for one vector unit, which
// define FASCIA_SIMD_NAMESPACE and FASCIA_SIMD_LANES. Everything here is local to the including source.
//
// This work is based on:
// K. Goto, R. van de Geijn. Anatomy of high-performance matrix multiplication. 2008

#include <cstddef>
#include <cstdlib>
#if FASCIA_SIMD_LANES > 2
#include <immintrin.h>
#endif

#include "builder/splines/simd.h"

namespace fascia::splines::simd::FASCIA_SIMD_NAMESPACE {
namespace {

constexpr size_t lanes = FASCIA_SIMD_LANES;
typedef double Vector __attribute__((vector_size(FASCIA_SIMD_LANES * sizeof(double))));
typedef double Unaligned
    __attribute__((vector_size(FASCIA_SIMD_LANES * sizeof(double)), aligned(8), may_alias));

inline Vector load(const double* from) {
  return *reinterpret_cast<const Unaligned*>(from);
}

inline void store(double* to, Vector value) {
  *reinterpret_cast<Unaligned*>(to) = value;
}

// Subtracting zero changes nothing, and compilers know it: this is one broadcast.
inline Vector splat(double value) {
  return value - Vector{};
}

// Within one unit in the last place.
inline Vector square_root(Vector d) {
#if FASCIA_SIMD_LANES == 8
  // The hardware's root takes twice as long as its reciprocal estimate x of 14 bits and, with t = d x and
  // e = 1 - t x, the series t (1 - e)^(-1/2) up to e^4.
  const Vector positive = d + 1e-300;
  const Vector x = _mm512_maskz_rsqrt14_pd(0xff, positive), t = d * x, e = 1.0 - t * x;
  return t + t * e * (0.5 + e * (0.375 + e * (0.3125 + e * 0.2734375)));
#elif FASCIA_SIMD_LANES == 4
  return _mm256_sqrt_pd(d);
#else
  Vector out;
  for (size_t l = 0; l < lanes; ++l)
    out[l] = __builtin_sqrt(d[l]);
  return out;
#endif
}

template <int exponent>
inline Vector power(Vector squared) {
  const Vector r = square_root(squared);
  if constexpr (exponent == 1) return r;
  if constexpr (exponent == 3) return r * squared;
  return r * squared * squared;
}

// Sums at `vectors` vectors of points, which stay in registers while the centres pass by.
template <int exponent, int outputs, int vectors>
inline void sum_block(const Sum& s, const double* px, const double* py, const double* pz, double* out) {
  Vector x[vectors], y[vectors], z[vectors], total[vectors][outputs];
  for (int v = 0; v < vectors; ++v) {
    x[v] = load(px + v * lanes);
    y[v] = load(py + v * lanes);
    z[v] = load(pz + v * lanes);
    for (int k = 0; k < outputs; ++k)
      total[v][k] = splat(0);
  }
  for (size_t j = 0; j < s.centres; ++j) {
    const Vector cx = splat(s.x[j]), cy = splat(s.y[j]), cz = splat(s.z[j]);
    for (int v = 0; v < vectors; ++v) {
      const Vector dx = x[v] - cx, dy = y[v] - cy, dz = z[v] - cz;
      const Vector phi = power<exponent>(dx * dx + dy * dy + dz * dz);
      for (int k = 0; k < outputs; ++k)
        total[v][k] += splat(s.weights[static_cast<size_t>(k) * s.stride + j]) * phi;
    }
  }
  for (int v = 0; v < vectors; ++v)
    for (int k = 0; k < outputs; ++k)
      store(out + (static_cast<size_t>(k) * vectors + static_cast<size_t>(v)) * lanes, total[v][k] * s.sign);
}

template <int exponent, int outputs>
void sum_many(const Sum& s) {
  constexpr int vectors = 2;
  constexpr size_t block = vectors * lanes;
  double out[block * outputs], px[block], py[block], pz[block];
  for (size_t i = 0; i < s.points; i += block) {
    const size_t count = s.points - i < block ? s.points - i : block;
    for (size_t l = 0; l < block; ++l) {
      const size_t at = i + (l < count ? l : 0);
      px[l] = s.px[at];
      py[l] = s.py[at];
      pz[l] = s.pz[at];
    }
    sum_block<exponent, outputs, vectors>(s, px, py, pz, out);
    for (size_t k = 0; k < outputs; ++k)
      for (size_t l = 0; l < count; ++l)
        s.values[i + l + k * s.value_stride] += out[k * block + l];
  }
}

// A few points: a vector of centres at a time; the padding's weights are zero.
template <int exponent, int outputs>
void sum_few(const Sum& s) {
  for (size_t i = 0; i < s.points; ++i) {
    Vector total[outputs];
    for (int k = 0; k < outputs; ++k)
      total[k] = splat(0);
    const Vector x = splat(s.px[i]), y = splat(s.py[i]), z = splat(s.pz[i]);
    for (size_t j = 0; j < s.stride; j += lanes) {
      const Vector dx = x - load(s.x + j), dy = y - load(s.y + j), dz = z - load(s.z + j);
      const Vector phi = power<exponent>(dx * dx + dy * dy + dz * dz);
      for (size_t k = 0; k < outputs; ++k)
        total[k] += load(s.weights + k * s.stride + j) * phi;
    }
    for (size_t k = 0; k < outputs; ++k) {
      double value = 0;
      for (size_t l = 0; l < lanes; ++l)
        value += total[k][l];
      s.values[i + k * s.value_stride] += s.sign * value;
    }
  }
}

template <int exponent, int outputs>
void sum_outputs(const Sum& s) {
  if (s.points < 4)
    sum_few<exponent, outputs>(s);
  else
    sum_many<exponent, outputs>(s);
}

template <int exponent>
void sum_exponent(const Sum& s) {
  if (s.outputs == 1)
    sum_outputs<exponent, 1>(s);
  else if (s.outputs == 2)
    sum_outputs<exponent, 2>(s);
  else if (s.outputs == 3)
    sum_outputs<exponent, 3>(s);
  else
    sum_outputs<exponent, 4>(s);
}

void sum(const Sum& s) {
  if (s.exponent == 1)
    sum_exponent<1>(s);
  else if (s.exponent == 3)
    sum_exponent<3>(s);
  else
    sum_exponent<5>(s);
}

inline double across(Vector v) {
  double total = 0;
  for (size_t l = 0; l < lanes; ++l)
    total += v[l];
  return total;
}

template <int exponent, bool dipoles>
void gradient_sum_of(const GradientSum& s) {
  const Vector x = splat(s.px), y = splat(s.py), z = splat(s.pz);
  Vector value = splat(0), along_x = splat(0), along_y = splat(0), along_z = splat(0);
  for (size_t j = 0; j < s.centres; j += lanes) {
    const Vector dx = x - load(s.x + j), dy = y - load(s.y + j), dz = z - load(s.z + j);
    const Vector squared = dx * dx + dy * dy + dz * dz, r = square_root(squared), w = load(s.weights + j);
    // phi, phi'/r and the factor of h h^T in the Hessian; at a centre h is 0, and so is all that they
    // multiply.
    Vector phi, g, second = splat(0);
    if constexpr (exponent == 1) {
      phi = r;
      g = r / (squared + 1e-300);
    } else if constexpr (exponent == 3) {
      phi = r * squared;
      g = 3.0 * r;
      if constexpr (dipoles) second = 3.0 * r / (squared + 1e-300);
    } else {
      phi = r * squared * squared;
      g = 5.0 * r * squared;
      second = 15.0 * r;
    }
    Vector slope = w * g;
    value += w * phi;
    if constexpr (dipoles) {
      const Vector bx = load(s.bx + j), by = load(s.by + j), bz = load(s.bz + j);
      const Vector along = bx * dx + by * dy + bz * dz;
      value -= g * along;
      slope -= second * along;
      along_x -= g * bx;
      along_y -= g * by;
      along_z -= g * bz;
    }
    along_x += slope * dx;
    along_y += slope * dy;
    along_z += slope * dz;
  }
  s.out[0] = s.sign * across(value);
  s.out[1] = s.sign * across(along_x);
  s.out[2] = s.sign * across(along_y);
  s.out[3] = s.sign * across(along_z);
}

void gradient_sum(const GradientSum& s) {
  if (s.exponent == 1)
    gradient_sum_of<1, false>(s);
  else if (s.exponent == 3)
    s.bx ? gradient_sum_of<3, true>(s) : gradient_sum_of<3, false>(s);
  else
    s.bx ? gradient_sum_of<5, true>(s) : gradient_sum_of<5, false>(s);
}

template <int exponent>
void matrix_exponent(const KernelMatrix& m) {
  for (size_t j = 0; j < m.count; ++j) {
    const Vector x = splat(m.x[j]), y = splat(m.y[j]), z = splat(m.z[j]);
    double* column = m.entries + j * m.stride;
    size_t i = j;
    for (; i + lanes <= m.count; i += lanes) {
      const Vector dx = x - load(m.x + i), dy = y - load(m.y + i), dz = z - load(m.z + i);
      store(column + i, m.sign * power<exponent>(dx * dx + dy * dy + dz * dz));
    }
    for (; i < m.count; ++i) {
      const double dx = m.x[j] - m.x[i], dy = m.y[j] - m.y[i], dz = m.z[j] - m.z[i];
      column[i] = m.sign * power<exponent>(splat(dx * dx + dy * dy + dz * dz))[0];
    }
  }
}

void kernel_matrix(const KernelMatrix& m) {
  if (m.exponent == 1)
    matrix_exponent<1>(m);
  else if (m.exponent == 3)
    matrix_exponent<3>(m);
  else
    matrix_exponent<5>(m);
}

void rank_update(const RankUpdate& m) {
  for (size_t j = 0; j < m.count; ++j) {
    double* column = m.entries + j * m.stride;
    size_t i = j;
    for (; i + lanes <= m.count; i += lanes) {
      Vector total = load(column + i);
      for (size_t r = 0; r < m.rank; ++r)
        total -= splat(m.right[j + r * m.count]) * load(m.left + i + r * m.count);
      store(column + i, total);
    }
    for (; i < m.count; ++i)
      for (size_t r = 0; r < m.rank; ++r)
        column[i] -= m.right[j + r * m.count] * m.left[i + r * m.count];
  }
}

// Cholesky by blocks of columns: factor the block on the diagonal, solve the panel below it, and take the
// panel's square from what is right of it; nearly all the work is the last, in tiles held in registers.
constexpr size_t block_columns = 64;
constexpr size_t tile_rows = 3 * lanes;
constexpr size_t tile_columns = lanes == 8 ? 8 : 4;

bool factor_diagonal(double* a, size_t n, size_t stride) {
  for (size_t j = 0; j < n; ++j) {
    double* column = a + j * stride;
    if (!(column[j] > 0)) return false;
    const double root = __builtin_sqrt(column[j]);
    column[j] = root;
    const double inverse = 1 / root;
    for (size_t i = j + 1; i < n; ++i)
      column[i] *= inverse;
    for (size_t k = j + 1; k < n; ++k) {
      double* other = a + k * stride;
      const double factor = column[k];
      for (size_t i = k; i < n; ++i)
        other[i] -= factor * column[i];
    }
  }
  return true;
}

// X L^T = A for one tile of rows, packed column after column.
void solve_tile(double* tile, const double* lower, size_t columns, size_t stride) {
  for (size_t j = 0; j < columns; ++j) {
    Vector total[3];
    for (size_t v = 0; v < 3; ++v)
      total[v] = load(tile + j * tile_rows + v * lanes);
    for (size_t p = 0; p < j; ++p) {
      const Vector factor = splat(lower[j + p * stride]);
      for (size_t v = 0; v < 3; ++v)
        total[v] -= factor * load(tile + p * tile_rows + v * lanes);
    }
    const Vector inverse = splat(1 / lower[j + j * stride]);
    for (size_t v = 0; v < 3; ++v)
      store(tile + j * tile_rows + v * lanes, total[v] * inverse);
  }
}

// One tile of the panel's square, tile_rows by tile_columns.
inline void square_tile(const double* left, const double* right, size_t depth, Vector out[tile_columns][3]) {
  for (size_t c = 0; c < tile_columns; ++c)
    for (size_t v = 0; v < 3; ++v)
      out[c][v] = splat(0);
  for (size_t p = 0; p < depth; ++p) {
    const Vector a0 = load(left + p * tile_rows), a1 = load(left + p * tile_rows + lanes),
                 a2 = load(left + p * tile_rows + 2 * lanes);
#pragma GCC unroll 8
    for (size_t c = 0; c < tile_columns; ++c) {
      const Vector b = splat(right[p * tile_columns + c]);
      out[c][0] += a0 * b;
      out[c][1] += a1 * b;
      out[c][2] += a2 * b;
    }
  }
}

void subtract_tile(double* entries, size_t stride, size_t rows, size_t columns,
                   const Vector tile[tile_columns][3]) {
  for (size_t c = 0; c < columns; ++c) {
    double* column = entries + c * stride;
    if (rows == tile_rows) {
      for (size_t v = 0; v < 3; ++v)
        store(column + v * lanes, load(column + v * lanes) - tile[c][v]);
      continue;
    }
    double spilled[tile_rows];
    for (size_t v = 0; v < 3; ++v)
      store(spilled + v * lanes, tile[c][v]);
    for (size_t r = 0; r < rows; ++r)
      column[r] -= spilled[r];
  }
}

// entries -= panel panel^T on and below the diagonal; `packed` holds the panel tile after tile.
void subtract_square(double* entries, size_t rows, size_t stride, const double* packed, size_t depth) {
  double right[block_columns * tile_columns];
  for (size_t j = 0; j < rows; j += tile_columns) {
    const size_t columns = rows - j < tile_columns ? rows - j : tile_columns;
    for (size_t p = 0; p < depth; ++p)
      for (size_t c = 0; c < tile_columns; ++c) {
        const size_t row = j + (c < columns ? c : 0);
        right[p * tile_columns + c] = packed[(row / tile_rows * depth + p) * tile_rows + row % tile_rows];
      }
    for (size_t i = j / tile_rows * tile_rows; i < rows; i += tile_rows) {
      Vector tile[tile_columns][3];
      square_tile(packed + i * depth, right, depth, tile);
      subtract_tile(entries + i + j * stride, stride, rows - i < tile_rows ? rows - i : tile_rows, columns,
                    tile);
    }
  }
}

bool cholesky(const Cholesky& m) {
  double* packed = static_cast<double*>(std::malloc((m.count + tile_rows) * block_columns * sizeof(double)));
  if (!packed) return false;
  bool positive = true;
  for (size_t k = 0; k < m.count && positive; k += block_columns) {
    const size_t depth = m.count - k < block_columns ? m.count - k : block_columns;
    double* diagonal = m.entries + k + k * m.stride;
    positive = factor_diagonal(diagonal, depth, m.stride);
    const size_t rows = m.count - k - depth;
    for (size_t i = 0; i < rows && positive; i += tile_rows) {
      const size_t height = rows - i < tile_rows ? rows - i : tile_rows;
      double* tile = packed + i * depth;
      for (size_t p = 0; p < depth; ++p)
        for (size_t r = 0; r < tile_rows; ++r)
          tile[p * tile_rows + r] = r < height ? diagonal[depth + i + r + p * m.stride] : 0;
      solve_tile(tile, diagonal, depth, m.stride);
      for (size_t p = 0; p < depth; ++p)
        for (size_t r = 0; r < height; ++r)
          diagonal[depth + i + r + p * m.stride] = tile[p * tile_rows + r];
    }
    if (positive) subtract_square(diagonal + depth + depth * m.stride, rows, m.stride, packed, depth);
  }
  std::free(packed);
  return positive;
}

}  // namespace

extern const Functions table;
const Functions table = {FASCIA_SIMD_NAME, sum, gradient_sum, kernel_matrix, rank_update, cholesky};

}  // namespace fascia::splines::simd::FASCIA_SIMD_NAMESPACE
