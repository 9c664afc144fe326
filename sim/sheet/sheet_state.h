#pragma once

// Data of a sheet's loops: plain numbers only, so that no inline library function is compiled for an
// unavailable instruction set.

#include <cstdint>

namespace fascia::sim::sheet {

/// Positions are indexed [row][column within its strip][strip], with sixteen strips of neighbouring columns,
/// one per lane, so that neighbours are in different registers and the particles of a register share no
/// spring.
struct State {
  uint32_t rows = 0, width = 0;  ///< width: columns of a strip
  float spacing = 0.0F;
  float *x = nullptr, *y = nullptr, *z = nullptr;
  float *before_x = nullptr, *before_y = nullptr, *before_z = nullptr;
  float *velocity_x = nullptr, *velocity_y = nullptr, *velocity_z = nullptr;
  const float* inverse_mass = nullptr;  ///< 0 where a particle is pinned or beyond the sheet's edge
  const float *exists_1 = nullptr,
              *exists_2 =
                  nullptr;  ///< [column within its strip][strip]: 1 where one, two columns on there is one
  float* chain = nullptr;   ///< 5 x rows x 16, for the chain solve
};

struct Step {
  int substeps;
  float length;  ///< seconds
  float gravity[3];
};

using StepFunction = void (*)(const State& state, const Step& step);
void step_baseline(const State& state, const Step& step);
void step_avx2(const State& state, const Step& step);
void step_avx512(const State& state, const Step& step);

}  // namespace fascia::sim::sheet
