#include "sim/lanes/instruction_set.h"

#include <cstdlib>
#include <string_view>

namespace fascia::sim::lanes {

InstructionSet instruction_set() {
#if defined(__x86_64__)
  static const InstructionSet chosen = [] {
    const char* wanted = std::getenv("FASCIA_SIMD");
    const std::string_view limit = wanted != nullptr ? wanted : "";
    if (limit == "baseline" || !__builtin_cpu_supports("avx2")) return InstructionSet::baseline;
    if (limit == "avx2" || !__builtin_cpu_supports("avx512f")) return InstructionSet::avx2;
    return InstructionSet::avx512;
  }();
  return chosen;
#else
  return InstructionSet::baseline;
#endif
}

}  // namespace fascia::sim::lanes
