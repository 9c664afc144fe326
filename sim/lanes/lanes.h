// Sixteen floats that are worked on at once, whatever the width of the vector unit: one register of AVX-512, two of AVX2, four of
// SSE2. Since every unit does the same IEEE operations on the same sixteen, all give the same bits; nothing here may contract,
// estimate or reorder.
//
// Included once by each source that is compiled for one unit, which defines FASCIA_LANES_NAMESPACE before. Everything here is
// local to the including source, so that nothing compiled for a wider unit can be called by accident.

#include <cstddef>
#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

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

#define FASCIA_INLINE inline __attribute__((always_inline))

struct Lanes {
  Part part[part_count];
};

FASCIA_INLINE Lanes load(const float* from) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p) out.part[p] = *reinterpret_cast<const UnalignedPart*>(from + p * part_width);
  return out;
}
FASCIA_INLINE void store(float* to, const Lanes& value) {
  for (size_t p = 0; p < part_count; ++p) *reinterpret_cast<UnalignedPart*>(to + p * part_width) = value.part[p];
}
FASCIA_INLINE Lanes splat(float value) {
  Lanes out;
  // Subtracting zero changes nothing, and compilers know it: this is one broadcast.
  for (size_t p = 0; p < part_count; ++p) out.part[p] = value - Part{};
  return out;
}

#define FASCIA_LANES_OPERATOR(op)                                                   \
  FASCIA_INLINE Lanes operator op(const Lanes& a, const Lanes& b) {                 \
    Lanes out;                                                                      \
    for (size_t p = 0; p < part_count; ++p) out.part[p] = a.part[p] op b.part[p];   \
    return out;                                                                     \
  }                                                                                 \
  FASCIA_INLINE Lanes operator op(const Lanes& a, float b) { return a op splat(b); } \
  FASCIA_INLINE Lanes operator op(float a, const Lanes& b) { return splat(a) op b; }
FASCIA_LANES_OPERATOR(+)
FASCIA_LANES_OPERATOR(-)
FASCIA_LANES_OPERATOR(*)
FASCIA_LANES_OPERATOR(/)
#undef FASCIA_LANES_OPERATOR

FASCIA_INLINE Lanes& operator+=(Lanes& a, const Lanes& b) { return a = a + b; }
FASCIA_INLINE Lanes& operator-=(Lanes& a, const Lanes& b) { return a = a - b; }
FASCIA_INLINE Lanes operator-(const Lanes& a) { return splat(-0.0F) - a; }

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
    for (size_t l = 0; l < part_width; ++l) out.part[p][l] = __builtin_sqrtf(a.part[p][l]);
#endif
  }
  return out;
}
/// The greater of each; `b` where `a` is not a number.
FASCIA_INLINE Lanes greater(const Lanes& a, const Lanes& b) {
  Lanes out;
  for (size_t p = 0; p < part_count; ++p) out.part[p] = a.part[p] > b.part[p] ? a.part[p] : b.part[p];
  return out;
}
FASCIA_INLINE Lanes greater(const Lanes& a, float b) { return greater(a, splat(b)); }

/// Three coordinates of sixteen places.
struct Lanes3 {
  Lanes x, y, z;
};
FASCIA_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
FASCIA_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
FASCIA_INLINE Lanes3 operator*(const Lanes& a, const Lanes3& b) { return {a * b.x, a * b.y, a * b.z}; }
FASCIA_INLINE Lanes3& operator+=(Lanes3& a, const Lanes3& b) { return a = a + b; }
FASCIA_INLINE Lanes3& operator-=(Lanes3& a, const Lanes3& b) { return a = a - b; }
FASCIA_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
FASCIA_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace
}  // namespace fascia::sim::lanes::FASCIA_LANES_NAMESPACE
