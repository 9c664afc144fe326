#pragma once

namespace fascia::sim::lanes {

/// The vector units that loops are compiled for.
enum class InstructionSet { baseline, avx2, avx512 };

/// The widest this processor runs; the environment variable FASCIA_SIMD=baseline|avx2 takes a narrower one.
/// Loops on `Lanes` give the same bits on each.
InstructionSet instruction_set();

}  // namespace fascia::sim::lanes
