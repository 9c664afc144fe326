// The loops of a sheet, included once by each source that is compiled for one instruction set (see lanes.h),
// which define FASCIA_SHEET_STEP. Everything else here is local to the including source.

#include "sim/lanes/lanes.h"
#include "sim/sheet/sheet_state.h"

namespace fascia::sim::sheet {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

FASCIA_INLINE Lanes3 load3(const State& s, ptrdiff_t at) {
  return {load(s.x + at), load(s.y + at), load(s.z + at)};
}
FASCIA_INLINE void store3(const State& s, ptrdiff_t at, const Lanes3& value) {
  store(s.x + at, value.x);
  store(s.y + at, value.y);
  store(s.z + at, value.z);
}

/// Velocity from the substep before, and where it carries each particle.
void move(const State& s, const Step& step, bool first) {
  const auto places = static_cast<ptrdiff_t>(s.rows * s.width * lane_count);
  const float rate = 1.0F / step.length;
  float* const list[3] = {s.x, s.y, s.z};
  float* const before[3] = {s.before_x, s.before_y, s.before_z};
  const float* const velocity[3] = {s.velocity_x, s.velocity_y, s.velocity_z};
  for (int axis = 0; axis < 3; ++axis) {
    const float fall = step.gravity[axis] * step.length;
    for (ptrdiff_t i = 0; i < places; i += lane_count) {
      const Lanes x = load(list[axis] + i), free = load(s.inverse_mass + i);
      const Lanes speed = first ? load(velocity[axis] + i) : (x - load(before[axis] + i)) * rate;
      store(before[axis] + i, x);
      store(list[axis] + i, x + free * ((speed + fall) * step.length));
    }
  }
}

void keep_velocity(const State& s, float length) {
  const auto places = static_cast<ptrdiff_t>(s.rows * s.width * lane_count);
  const float rate = 1.0F / length;
  const float* const list[3] = {s.x, s.y, s.z};
  const float* const before[3] = {s.before_x, s.before_y, s.before_z};
  float* const velocity[3] = {s.velocity_x, s.velocity_y, s.velocity_z};
  for (int axis = 0; axis < 3; ++axis)
    for (ptrdiff_t i = 0; i < places; i += lane_count)
      store(velocity[axis] + i, (load(list[axis] + i) - load(before[axis] + i)) * rate);
}

/// One Newton step that brings all lengths of sixteen columns to rest at once. With C = (d.d - rest^2) / 2 of
/// each segment d, J M^-1 J^T lambda = -C is tridiagonal and needs no root.
void solve_chains(const State& s, ptrdiff_t column) {
  const auto row = static_cast<ptrdiff_t>(s.width * lane_count);
  const auto segments = static_cast<ptrdiff_t>(s.rows) - 1;
  const float square = s.spacing * s.spacing;
  float* const dx = s.chain;
  float* const dy = dx + segments * static_cast<ptrdiff_t>(lane_count);
  float* const dz = dy + segments * static_cast<ptrdiff_t>(lane_count);
  float* const upper = dz + segments * static_cast<ptrdiff_t>(lane_count);
  float* const right = upper + segments * static_cast<ptrdiff_t>(lane_count);
  Lanes3 place = load3(s, column), last{splat(0), splat(0), splat(0)};
  Lanes weight = load(s.inverse_mass + column), last_upper = splat(0), last_right = splat(0);
  for (ptrdiff_t i = 0; i < segments; ++i) {
    const ptrdiff_t at = i * static_cast<ptrdiff_t>(lane_count);
    const Lanes3 next = load3(s, column + (i + 1) * row), d = next - place;
    const Lanes next_weight = load(s.inverse_mass + column + (i + 1) * row);
    const Lanes squared = dot(d, d), lower = -(weight * dot(last, d));
    // A column without mass (beyond the sheet's edge) has nothing to solve: one in its place keeps it finite.
    const Lanes pivot = greater((weight + next_weight) * squared - lower * last_upper, 1e-12F);
    const Lanes inverse = 1.0F / pivot;
    last_right = (0.5F * (square - squared) - lower * last_right) * inverse;
    // The entry above the diagonal needs the segment that comes next.
    if (i + 1 < segments)
      last_upper = -(next_weight * dot(d, load3(s, column + (i + 2) * row) - next)) * inverse;
    store(dx + at, d.x);
    store(dy + at, d.y);
    store(dz + at, d.z);
    store(upper + at, last_upper);
    store(right + at, last_right);
    place = next;
    weight = next_weight;
    last = d;
  }
  Lanes lambda = splat(0);
  Lanes3 pull{splat(0), splat(0), splat(0)};
  for (ptrdiff_t i = segments; i-- > 0;) {
    const ptrdiff_t at = i * static_cast<ptrdiff_t>(lane_count);
    lambda = i + 1 < segments ? load(right + at) - load(upper + at) * lambda : load(right + at);
    const Lanes3 push = lambda * Lanes3{load(dx + at), load(dy + at), load(dz + at)};
    const ptrdiff_t node = column + (i + 1) * row;
    store3(s, node, load3(s, node) + load(s.inverse_mass + node) * (push - pull));
    pull = push;
  }
  store3(s, column, load3(s, column) - load(s.inverse_mass + column) * pull);
}

/// Brings sixteen springs to their length: the positions' own form of it, without a root.
FASCIA_INLINE void relax(const State& s, ptrdiff_t a, ptrdiff_t b, float squared_rest, const Lanes& exists) {
  const Lanes3 place_a = load3(s, a), place_b = load3(s, b), d = place_b - place_a;
  const Lanes weight_a = load(s.inverse_mass + a), weight_b = load(s.inverse_mass + b), squared = dot(d, d);
  const Lanes share =
      exists * (squared - squared_rest) / ((squared + squared_rest) * greater(weight_a + weight_b, 1e-6F));
  store3(s, a, place_a + (share * weight_a) * d);
  store3(s, b, place_b - (share * weight_b) * d);
}

/// Where the particle `step` columns on from place `within` of its strip stands: past the strip's end, at the
/// next one's beginning one lane on.
FASCIA_INLINE ptrdiff_t beside(ptrdiff_t width, ptrdiff_t within, ptrdiff_t step) {
  const ptrdiff_t to = within + step;
  return to % width * static_cast<ptrdiff_t>(lane_count) + to / width;
}

/// Springs along rows, some rows together, so that one does not wait for the one before.
void relax_rows(const State& s, ptrdiff_t step, float squared_rest, const float* exists) {
  constexpr ptrdiff_t together = 8;
  const auto width = static_cast<ptrdiff_t>(s.width), rows = static_cast<ptrdiff_t>(s.rows);
  const auto wide = static_cast<ptrdiff_t>(lane_count), row = width * wide;
  for (ptrdiff_t begin = 0; begin < rows; begin += together) {
    const ptrdiff_t end = begin + together < rows ? begin + together : rows;
    for (ptrdiff_t k = 0; k < width; ++k) {
      const ptrdiff_t there = beside(width, k, step);
      for (ptrdiff_t r = begin; r < end; ++r)
        relax(s, r * row + k * wide, r * row + there, squared_rest, load(exists + k * wide));
    }
  }
}

void relax_all(const State& s) {
  const auto width = static_cast<ptrdiff_t>(s.width), rows = static_cast<ptrdiff_t>(s.rows);
  const auto wide = static_cast<ptrdiff_t>(lane_count), row = width * wide;
  const float near = s.spacing * s.spacing, shear = 2.0F * near, skip = 4.0F * near;
  const Lanes always = splat(1.0F);
  relax_rows(s, 1, near, s.exists_1);
  for (ptrdiff_t r = 0; r + 1 < rows; ++r)
    for (ptrdiff_t k = 0; k < width; ++k)
      relax(s, r * row + k * wide, (r + 1) * row + beside(width, k, 1), shear, load(s.exists_1 + k * wide));
  for (ptrdiff_t r = 0; r + 1 < rows; ++r)
    for (ptrdiff_t k = 0; k < width; ++k)
      relax(s, (r + 1) * row + k * wide, r * row + beside(width, k, 1), shear, load(s.exists_1 + k * wide));
  relax_rows(s, 2, skip, s.exists_2);
  for (ptrdiff_t r = 0; r + 2 < rows; ++r)
    for (ptrdiff_t k = 0; k < width; ++k)
      relax(s, r * row + k * wide, (r + 2) * row + k * wide, skip, always);
}

}  // namespace

void FASCIA_SHEET_STEP(const State& s, const Step& step) {
  for (int substep = 0; substep < step.substeps; ++substep) {
    move(s, step, substep == 0);
    for (ptrdiff_t k = 0; k < static_cast<ptrdiff_t>(s.width); ++k)
      solve_chains(s, k * static_cast<ptrdiff_t>(lane_count));
    relax_all(s);
  }
  keep_velocity(s, step.length);
}

}  // namespace fascia::sim::sheet
