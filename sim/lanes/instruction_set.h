#pragma once

namespace fascia::sim::lanes {

/// The instruction sets that loops are compiled for.
enum class InstructionSet { baseline, avx2, avx512 };

/// The widest that this processor supports; the environment variable FASCIA_SIMD=baseline|avx2 selects a
/// narrower one. Loops on `Lanes` are bit-identical on each.
InstructionSet instruction_set();

}  // namespace fascia::sim::lanes
