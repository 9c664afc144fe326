#pragma once

// A solve with the factor by fronts, and the product with a sparse matrix; see sim/realtime/loops.h.

#include "sim/lanes/lanes.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

void multiply(const SparseRows& m, const float* x, float* out) {
  for (size_t i = 0; i < m.size; ++i) {
    Lanes sums = splat(0.0F);  // of every fourth entry
    for (uint32_t e = m.begin[i]; e < m.begin[i + 1]; e += 4)
      sums += each_four_times(m.value + e) * four_places(x, m.column + e);
    store_quad(out + 4 * i, quarters(sums));
  }
}

/// Number of accumulators of three coordinates that fit in the registers.
constexpr size_t group_width = part_count == 1 ? 4 : part_count == 2 ? 2 : 1;

/// Adds what `count` blocks of a front, all with every column, say of its own places.
template <size_t count>
FASCIA_INLINE void spread_columns(const uint16_t* value, uint32_t columns, const float* own,
                                  const int32_t* row, float* values) {
  Lanes3 sums[count];
  for (size_t g = 0; g < count; ++g)
    sums[g] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
  for (uint32_t c = 0; c < columns; ++c) {
    const Lanes x = splat(own[4 * c]), y = splat(own[4 * c + 1]), z = splat(own[4 * c + 2]);
    for (size_t g = 0; g < count; ++g)
      sums[g] += load_upper_halves(value + batch_width * (g * columns + c)) * Lanes3{x, y, z};
  }
  for (size_t g = 0; g < count; ++g)
    scatter_add(values, row + batch_width * g, sums[g]);
}

void go_forward(const Panels& panels, const Panels::Front& front, float* values, float* own) {
  float* const from = values + 4 * static_cast<size_t>(front.first);
  for (uint32_t c = 0; c < front.width; ++c) {
    store_quad(own + 4 * c, load_quad(from + 4 * c));
    store_quad(from + 4 * c, Quad{});
  }
  const uint16_t* value = panels.value + front.values;
  const int32_t* row = panels.row + front.rows;
  for (uint32_t b = 0; b < front.blocks;) {
    const uint32_t columns = front.columns(b);
    if (columns == front.width && b + group_width <= front.blocks) {
      spread_columns<group_width>(value, columns, own, row, values);
      value += group_width * batch_width * columns;
      row += group_width * batch_width;
      b += group_width;
    } else {
      spread_columns<1>(value, columns, own, row, values);
      value += batch_width * columns;
      row += batch_width;
      ++b;
    }
  }
}

/// What `count` columns from `column` on say of the places of all rows, `places` as x, y, z of sixteen.
template <size_t count>
FASCIA_INLINE void collect_rows(const Panels::Front& front, const uint16_t* value, uint32_t block,
                                uint32_t column, const float* places, float* own) {
  Lanes3 sums[count];
  for (size_t g = 0; g < count; ++g)
    sums[g] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
  value += batch_width * column;
  for (uint32_t b = block; b < front.blocks; ++b) {
    const float* p = places + 3 * batch_width * b;
    const Lanes3 place{load(p), load(p + batch_width), load(p + 2 * batch_width)};
    for (size_t g = 0; g < count; ++g)
      sums[g] += load_upper_halves(value + batch_width * g) * place;
    value += batch_width * front.columns(b);
  }
  for (size_t g = 0; g < count; ++g)
    store_quad(own + 4 * (column + g), totals(sums[g]));
}

void go_back(const Panels& panels, const Panels::Front& front, float* values, float* places) {
  const int32_t* row = panels.row + front.rows;
  for (uint32_t b = 0; b < front.blocks; ++b) {
    const Lanes3 place = gather(values, row + batch_width * b);
    float* const to = places + 3 * batch_width * b;
    store(to, place.x);
    store(to + batch_width, place.y);
    store(to + 2 * batch_width, place.z);
  }
  float* const own = values + 4 * static_cast<size_t>(front.first);
  const uint16_t* value = panels.value + front.values;
  // Columns of one block of own rows at a time: blocks before it do not have them.
  for (uint32_t block = 0, first = 0; first < front.width; ++block, first += batch_width) {
    const uint32_t end = front.columns(block);
    uint32_t c = first;
    for (; c + group_width <= end; c += group_width)
      collect_rows<group_width>(front, value, block, c, places, own);
    for (; c < end; ++c)
      collect_rows<1>(front, value, block, c, places, own);
    value += batch_width * end;
  }
}

void solve(const Panels& panels, float* values, float* scratch) {
  for (size_t f = 0; f < panels.fronts; ++f)
    go_forward(panels, panels.front[f], values, scratch);
  for (size_t f = panels.fronts; f-- > 0;)
    go_back(panels, panels.front[f], values, scratch);
}

}  // namespace
}  // namespace fascia::sim::realtime
