// A vector of sixteen floats, whatever the register width: one register of AVX-512, two of AVX2, four of
// SSE2. Every instruction set performs the same IEEE operations, so results are bit-identical; nothing here
// may contract, approximate or reorder.
//
// Included once by each source that is compiled for one instruction set, which defines FASCIA_LANES_NAMESPACE
// before. Everything here is local to the including source, so that code compiled for a wider instruction set
// cannot be called by accident.

#pragma once

#include <cstddef>
#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "sim/formulas/numbers.h"

namespace fascia::sim::lanes::FASCIA_LANES_NAMESPACE {
namespace {

#if defined(__AVX512F__)
constexpr size_t part_width = 16;
#elif defined(__AVX2__)
constexpr size_t part_width = 8;
#else
constexpr size_t part_width = 4;
#endif
constexpr size_t lane_count = 16;
constexpr size_t part_count = lane_count / part_width;

typedef float Part __attribute__((vector_size(part_width * sizeof(float))));
typedef float UnalignedPart __attribute__((vector_size(part_width * sizeof(float)), aligned(4), may_alias));

struct Lanes {
  Part part[part_count];
};

FASCIA_INLINE Lanes load(const float* from) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p)
    out.part[p] = *reinterpret_cast<const UnalignedPart*>(from + p * part_width);
  return out;
}
/// Sixteen floats stored as their upper 16 bits; the lower ones are zero.
FASCIA_INLINE Lanes load_upper_halves(const uint16_t* from) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p) {
    const uint16_t* const first = from + p * part_width;
#if defined(__AVX512F__)
    const __m256i halves = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(first));
    out.part[p] =
        _mm512_castsi512_ps(_mm512_maskz_slli_epi32(0xffff, _mm512_maskz_cvtepu16_epi32(0xffff, halves), 16));
#elif defined(__AVX2__)
    const __m128i halves = _mm_loadu_si128(reinterpret_cast<const __m128i*>(first));
    out.part[p] = _mm256_castsi256_ps(_mm256_slli_epi32(_mm256_cvtepu16_epi32(halves), 16));
#elif defined(__SSE2__)
    const __m128i halves = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(first));
    out.part[p] = _mm_castsi128_ps(_mm_unpacklo_epi16(_mm_setzero_si128(), halves));
#else
    for (size_t l = 0; l < part_width; ++l)
      out.part[p][l] = __builtin_bit_cast(float, static_cast<uint32_t>(first[l]) << 16);
#endif
  }
  return out;
}
FASCIA_INLINE void store(float* to, const Lanes& value) {
  for (size_t p = 0; p < part_count; ++p)
    *reinterpret_cast<UnalignedPart*>(to + p * part_width) = value.part[p];
}
FASCIA_INLINE Lanes splat(float value) {
  Lanes out;
  // Subtracting zero changes nothing, and compilers know it: this is one broadcast.
  for (size_t p = 0; p < part_count; ++p)
    out.part[p] = value - Part{};
  return out;
}

#define FASCIA_LANES_OPERATOR(op)                                   \
  FASCIA_INLINE Lanes operator op(const Lanes& a, const Lanes& b) { \
    Lanes out;                                                      \
    for (size_t p = 0; p < part_count; ++p)                         \
      out.part[p] = a.part[p] op b.part[p];                         \
    return out;                                                     \
  }                                                                 \
  FASCIA_INLINE Lanes operator op(const Lanes& a, float b) {        \
    return a op splat(b);                                           \
  }                                                                 \
  FASCIA_INLINE Lanes operator op(float a, const Lanes& b) {        \
    return splat(a) op b;                                           \
  }                                                                 \
  FASCIA_INLINE Lanes operator op(const Lanes& a, double b) {       \
    return a op splat(static_cast<float>(b));                       \
  }                                                                 \
  FASCIA_INLINE Lanes operator op(double a, const Lanes& b) {       \
    return splat(static_cast<float>(a)) op b;                       \
  }
FASCIA_LANES_OPERATOR(+)
FASCIA_LANES_OPERATOR(-)
FASCIA_LANES_OPERATOR(*)
FASCIA_LANES_OPERATOR(/)
#undef FASCIA_LANES_OPERATOR

FASCIA_INLINE Lanes& operator+=(Lanes& a, const Lanes& b) {
  return a = a + b;
}
FASCIA_INLINE Lanes& operator-=(Lanes& a, const Lanes& b) {
  return a = a - b;
}
FASCIA_INLINE Lanes operator-(const Lanes& a) {
  return splat(-0.0F) - a;
}

FASCIA_INLINE Lanes square_root(const Lanes& a) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p) {
#if defined(__AVX512F__)
    out.part[p] = _mm512_maskz_sqrt_ps(0xffff, a.part[p]);
#elif defined(__AVX2__)
    out.part[p] = _mm256_sqrt_ps(a.part[p]);
#elif defined(__SSE2__)
    out.part[p] = _mm_sqrt_ps(a.part[p]);
#else
    for (size_t l = 0; l < part_width; ++l)
      out.part[p][l] = __builtin_sqrtf(a.part[p][l]);
#endif
  }
  return out;
}
/// The maximum of each; `b` if `a` is NaN.
FASCIA_INLINE Lanes greater(const Lanes& a, const Lanes& b) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p) {
#if defined(__AVX512F__)
    out.part[p] = _mm512_maskz_max_ps(0xffff, a.part[p], b.part[p]);
#elif defined(__AVX2__)
    out.part[p] = _mm256_max_ps(a.part[p], b.part[p]);
#elif defined(__SSE2__)
    out.part[p] = _mm_max_ps(a.part[p], b.part[p]);
#else
    out.part[p] = a.part[p] > b.part[p] ? a.part[p] : b.part[p];
#endif
  }
  return out;
}
FASCIA_INLINE Lanes greater(const Lanes& a, double b) {
  return greater(a, splat(static_cast<float>(b)));
}
/// `value` sixteen times; for formulas that know no lanes.
FASCIA_INLINE Lanes like(const Lanes& /*like*/, double value) {
  return splat(static_cast<float>(value));
}
/// Sine and 1 - cosine up to an angle of 3.2: of the half, by their series, then doubled.
FASCIA_INLINE void sine_and_versine(const Lanes& angle, Lanes& sine, Lanes& versine) {
  const Lanes h = 0.5F * angle, s = h * h;
  const Lanes half_sine =
      h *
      (1.0F - s * ((1.0F / 6) -
                   s * ((1.0F / 120) - s * ((1.0F / 5040) - s * ((1.0F / 362880) - s * (1.0F / 39916800))))));
  const Lanes half_cosine =
      1.0F - s * (0.5F - s * ((1.0F / 24) -
                              s * ((1.0F / 720) -
                                   s * ((1.0F / 40320) - s * ((1.0F / 3628800) - s * (1.0F / 479001600))))));
  sine = 2.0F * half_sine * half_cosine;
  versine = 2.0F * half_sine * half_sine;
}

FASCIA_INLINE Lanes lesser(const Lanes& a, const Lanes& b) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p)
    out.part[p] = b.part[p] > a.part[p] ? a.part[p] : b.part[p];
  return out;
}

/// Three coordinates of sixteen positions.
using Lanes3 = formulas::Three<Lanes>;

/// `yes` where a < b, else `no`.
FASCIA_INLINE Lanes where_below(const Lanes& a, const Lanes& b, const Lanes& yes, const Lanes& no) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p)
    out.part[p] = a.part[p] < b.part[p] ? yes.part[p] : no.part[p];
  return out;
}
FASCIA_INLINE bool any_below(const Lanes& a, const Lanes& b) {
  bool any = false;
  for (size_t p = 0; p < part_count; ++p) {
#if defined(__AVX512F__)
    any |= _mm512_cmp_ps_mask(a.part[p], b.part[p], _CMP_LT_OQ) != 0;
#elif defined(__AVX2__)
    any |= _mm256_movemask_ps(_mm256_cmp_ps(a.part[p], b.part[p], _CMP_LT_OQ)) != 0;
#elif defined(__SSE2__)
    any |= _mm_movemask_ps(_mm_cmplt_ps(a.part[p], b.part[p])) != 0;
#else
    for (size_t l = 0; l < part_width; ++l)
      any |= a.part[p][l] < b.part[p][l];
#endif
  }
  return any;
}

// Places in memory: four floats each, x y z and one of no meaning. Sixteen of them are fetched and turned
// into coordinates, or turned back and added, in fours: lane 4j + k is the j-th quarter of a register's k-th
// fetch.

typedef float Quad __attribute__((vector_size(16)));
typedef float UnalignedQuad __attribute__((vector_size(16), aligned(4), may_alias));

FASCIA_INLINE Quad load_quad(const float* from) {
  return *reinterpret_cast<const UnalignedQuad*>(from);
}
FASCIA_INLINE void store_quad(float* to, Quad value) {
  *reinterpret_cast<UnalignedQuad*>(to) = value;
}

/// Sums of lanes l, l + 4, l + 8 and l + 12, halves to halves.
FASCIA_INLINE Quad quarters(const Lanes& a) {
#if defined(__AVX512F__)
  typedef float Eight __attribute__((vector_size(32)));
  const Eight eight = __builtin_shufflevector(a.part[0], a.part[0], 0, 1, 2, 3, 4, 5, 6, 7) +
                      __builtin_shufflevector(a.part[0], a.part[0], 8, 9, 10, 11, 12, 13, 14, 15);
  return __builtin_shufflevector(eight, eight, 0, 1, 2, 3) +
         __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
#elif defined(__AVX2__)
  const Part eight = a.part[0] + a.part[1];
  return __builtin_shufflevector(eight, eight, 0, 1, 2, 3) +
         __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
#else
  return (a.part[0] + a.part[2]) + (a.part[1] + a.part[3]);
#endif
}
/// Sum of the sixteen.
FASCIA_INLINE float total(const Lanes& a) {
  const Quad q = quarters(a), pairs = q + __builtin_shufflevector(q, q, 2, 3, 0, 1);
  return pairs[0] + pairs[1];
}
/// Sums of the sixteen, coordinate by coordinate, as a place.
FASCIA_INLINE Quad totals(const Lanes3& a) {
  const Quad x = quarters(a.x), y = quarters(a.y), z = quarters(a.z), zero{};
  const Quad xy = __builtin_shufflevector(x, y, 0, 4, 1, 5) + __builtin_shufflevector(x, y, 2, 6, 3, 7);
  const Quad z0 = __builtin_shufflevector(z, zero, 0, 4, 1, 5) + __builtin_shufflevector(z, zero, 2, 6, 3, 7);
  return __builtin_shufflevector(xy, z0, 0, 1, 4, 5) + __builtin_shufflevector(xy, z0, 2, 3, 6, 7);
}

#if defined(__AVX512F__)
FASCIA_INLINE Part fetch(const float* base, const int32_t* at) {
  typedef float Eight __attribute__((vector_size(32)));
  const Eight low =
      __builtin_shufflevector(load_quad(base + at[0]), load_quad(base + at[4]), 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight high =
      __builtin_shufflevector(load_quad(base + at[8]), load_quad(base + at[12]), 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
#define FASCIA_SHUFFLE(a, b, i, j, k, l)                                                                  \
  __builtin_shufflevector(a, b, i, j, k + 12, l + 12, i + 4, j + 4, k + 16, l + 16, i + 8, j + 8, k + 20, \
                          l + 20, i + 12, j + 12, k + 24, l + 24)
#elif defined(__AVX2__)
FASCIA_INLINE Part fetch(const float* base, const int32_t* at) {
  return __builtin_shufflevector(load_quad(base + at[0]), load_quad(base + at[4]), 0, 1, 2, 3, 4, 5, 6, 7);
}
#define FASCIA_SHUFFLE(a, b, i, j, k, l) \
  __builtin_shufflevector(a, b, i, j, k + 4, l + 4, i + 4, j + 4, k + 8, l + 8)
#else
FASCIA_INLINE Part fetch(const float* base, const int32_t* at) {
  return load_quad(base + at[0]);
}
#define FASCIA_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#endif

/// The places that begin at base + at[lane].
FASCIA_INLINE Lanes3 gather(const float* base, const int32_t* at) {
  Lanes3 out;
  for (size_t p = 0; p < part_count; ++p) {
    const int32_t* first = at + p * part_width;
    const Part a = fetch(base, first), b = fetch(base, first + 1), c = fetch(base, first + 2),
               d = fetch(base, first + 3);
    const Part ab = FASCIA_SHUFFLE(a, b, 0, 1, 4, 5), cd = FASCIA_SHUFFLE(c, d, 0, 1, 4, 5);
    const Part ab_z = FASCIA_SHUFFLE(a, b, 2, 3, 6, 7), cd_z = FASCIA_SHUFFLE(c, d, 2, 3, 6, 7);
    out.x.part[p] = FASCIA_SHUFFLE(ab, cd, 0, 2, 4, 6);
    out.y.part[p] = FASCIA_SHUFFLE(ab, cd, 1, 3, 5, 7);
    out.z.part[p] = FASCIA_SHUFFLE(ab_z, cd_z, 0, 2, 4, 6);
  }
  return out;
}

/// A part's coordinates as places: the j-th quarter of out[k] is lane 4j + k.
struct PartPlaces {
  Part quad[4];
};
FASCIA_INLINE PartPlaces places_of(const Part& x, const Part& y, const Part& z, const Part& w) {
  const Part low = FASCIA_SHUFFLE(x, y, 0, 1, 4, 5), high = FASCIA_SHUFFLE(x, y, 2, 3, 6, 7);
  const Part low_z = FASCIA_SHUFFLE(z, w, 0, 1, 4, 5), high_z = FASCIA_SHUFFLE(z, w, 2, 3, 6, 7);
  return {{FASCIA_SHUFFLE(low, low_z, 0, 2, 4, 6), FASCIA_SHUFFLE(low, low_z, 1, 3, 5, 7),
           FASCIA_SHUFFLE(high, high_z, 0, 2, 4, 6), FASCIA_SHUFFLE(high, high_z, 1, 3, 5, 7)}};
}
// Quarters are named by constants: taken in a loop, compilers go through memory float by float.
#if defined(__AVX512F__)
#define FASCIA_QUARTER(part, j) \
  __builtin_shufflevector(part, part, 4 * (j), 4 * (j) + 1, 4 * (j) + 2, 4 * (j) + 3)
#define FASCIA_EACH_QUARTER(what) what(0) what(1) what(2) what(3)
#elif defined(__AVX2__)
#define FASCIA_QUARTER(part, j) \
  __builtin_shufflevector(part, part, 4 * (j), 4 * (j) + 1, 4 * (j) + 2, 4 * (j) + 3)
#define FASCIA_EACH_QUARTER(what) what(0) what(1)
#else
#define FASCIA_QUARTER(part, j) (part)
#define FASCIA_EACH_QUARTER(what) what(0)
#endif

/// Writes the sixteen as places, one after the other, `fourth` behind the coordinates.
FASCIA_INLINE void interleave(const Lanes3& value, const Lanes& fourth, float* to) {
  for (size_t p = 0; p < part_count; ++p, to += 4 * part_width) {
    const PartPlaces places = places_of(value.x.part[p], value.y.part[p], value.z.part[p], fourth.part[p]);
#define FASCIA_WRITE(j)                                             \
  store_quad(to + 16 * (j), FASCIA_QUARTER(places.quad[0], j));     \
  store_quad(to + 16 * (j) + 4, FASCIA_QUARTER(places.quad[1], j)); \
  store_quad(to + 16 * (j) + 8, FASCIA_QUARTER(places.quad[2], j)); \
  store_quad(to + 16 * (j) + 12, FASCIA_QUARTER(places.quad[3], j));
    FASCIA_EACH_QUARTER(FASCIA_WRITE)
#undef FASCIA_WRITE
  }
}

FASCIA_INLINE void interleave(const Lanes3& value, float* to) {
  interleave(value, splat(0.0F), to);
}

/// Adds each lane's value to the place at base + at[lane], lane after lane: places may be named twice.
FASCIA_INLINE void scatter_add(float* base, const int32_t* at, const Lanes3& value, const Lanes& fourth) {
  for (size_t p = 0; p < part_count; ++p, at += part_width) {
    const PartPlaces places = places_of(value.x.part[p], value.y.part[p], value.z.part[p], fourth.part[p]);
    const auto add = [base](int32_t to, Quad quad) { store_quad(base + to, load_quad(base + to) + quad); };
#define FASCIA_ADD(j)                                      \
  add(at[4 * (j)], FASCIA_QUARTER(places.quad[0], j));     \
  add(at[4 * (j) + 1], FASCIA_QUARTER(places.quad[1], j)); \
  add(at[4 * (j) + 2], FASCIA_QUARTER(places.quad[2], j)); \
  add(at[4 * (j) + 3], FASCIA_QUARTER(places.quad[3], j));
    FASCIA_EACH_QUARTER(FASCIA_ADD)
#undef FASCIA_ADD
  }
}
FASCIA_INLINE void scatter_add(float* base, const int32_t* at, const Lanes3& value) {
  scatter_add(base, at, value, splat(0.0F));
}
/// Four places one behind the other, and four floats, each four times.
FASCIA_INLINE Lanes four_places(const float* base, const int32_t* at) {
  Lanes out;
#if defined(__AVX512F__)
  typedef float Eight __attribute__((vector_size(32)));
  const Eight low =
      __builtin_shufflevector(load_quad(base + at[0]), load_quad(base + at[1]), 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight high =
      __builtin_shufflevector(load_quad(base + at[2]), load_quad(base + at[3]), 0, 1, 2, 3, 4, 5, 6, 7);
  out.part[0] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif defined(__AVX2__)
  for (size_t p = 0; p < 2; ++p)
    out.part[p] = __builtin_shufflevector(load_quad(base + at[2 * p]), load_quad(base + at[2 * p + 1]), 0, 1,
                                          2, 3, 4, 5, 6, 7);
#else
  for (size_t p = 0; p < 4; ++p)
    out.part[p] = load_quad(base + at[p]);
#endif
  return out;
}
FASCIA_INLINE Lanes each_four_times(const float* from) {
  const Quad four = load_quad(from);
  Lanes out;
#if defined(__AVX512F__)
  const __m512i order = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
  out.part[0] = _mm512_maskz_permutexvar_ps(0xffff, order, _mm512_castps128_ps512(four));
#elif defined(__AVX2__)
  out.part[0] = __builtin_shufflevector(four, four, 0, 0, 0, 0, 1, 1, 1, 1);
  out.part[1] = __builtin_shufflevector(four, four, 2, 2, 2, 2, 3, 3, 3, 3);
#else
  out.part[0] = __builtin_shufflevector(four, four, 0, 0, 0, 0);
  out.part[1] = __builtin_shufflevector(four, four, 1, 1, 1, 1);
  out.part[2] = __builtin_shufflevector(four, four, 2, 2, 2, 2);
  out.part[3] = __builtin_shufflevector(four, four, 3, 3, 3, 3);
#endif
  return out;
}

}  // namespace
}  // namespace fascia::sim::lanes::FASCIA_LANES_NAMESPACE
