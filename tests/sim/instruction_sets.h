#pragma once

#include <vector>

#include "sim/lanes/instruction_set.h"

namespace fascia::testing {

/// The instruction sets this machine runs.
inline std::vector<sim::lanes::InstructionSet> all_instruction_sets() {
  std::vector<sim::lanes::InstructionSet> sets = {sim::lanes::InstructionSet::baseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) sets.push_back(sim::lanes::InstructionSet::avx2);
  if (__builtin_cpu_supports("avx512f")) sets.push_back(sim::lanes::InstructionSet::avx512);
#endif
  return sets;
}

}  // namespace fascia::testing
