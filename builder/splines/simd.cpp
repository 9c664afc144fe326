#include "builder/splines/simd.h"

#include <cstdlib>
#include <string_view>

namespace fascia::splines::simd {
namespace {

const Functions& choose() {
#if defined(__x86_64__)
  const char* wanted = std::getenv("FASCIA_SIMD");
  const std::string_view limit = wanted ? wanted : "";
  const bool avx2_runs = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (limit == "baseline" || !avx2_runs) return baseline::table;
  if (limit == "avx2" || !__builtin_cpu_supports("avx512f")) return avx2::table;
  return avx512::table;
#else
  return baseline::table;
#endif
}

}  // namespace

const Functions& functions() {
  static const Functions& chosen = choose();
  return chosen;
}

}  // namespace fascia::splines::simd
