#pragma once

// What the loops of a sheet work on: plain numbers only, so that no inline function of a library is compiled
// for a machine that may not be there.

#include <cstdint>

namespace fascia::sim::sheet {

/// Places stand as [row][column within its strip][strip], sixteen strips of neighbouring columns, one a lane,
/// so that neighbours are in other registers and a register's particles touch no common spring.
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
