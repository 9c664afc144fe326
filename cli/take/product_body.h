// The loop of cli/take/product.h, included once by each source that is compiled for one vector unit (see
// sim/lanes/lanes.h), which defines FASCIA_PRODUCT. Everything else here is local to the including source.

#include "cli/take/product_loops.h"
#include "sim/lanes/lanes.h"

namespace fascia::cli {
namespace {

using namespace sim::lanes::FASCIA_LANES_NAMESPACE;

/// So many accumulators fit a unit's registers.
constexpr size_t group_width = part_count == 1 ? 8 : part_count == 2 ? 4 : 2;

/// Sixteen rows of `count` columns of the result; `panel` holds these rows of all columns one after the
/// other.
template <size_t count>
FASCIA_INLINE void strip(const ProductParts& p, const float* panel, size_t row, size_t column) {
  Lanes sums[count];
  for (size_t c = 0; c < count; ++c)
    sums[c] = splat(0.0F);
  const float* mix = p.mix + column * p.depth;
  for (size_t d = 0; d < p.depth; ++d) {
    const Lanes value = load(panel + lane_count * d);
    for (size_t c = 0; c < count; ++c)
      sums[c] = sums[c] + value * mix[c * p.depth + d];
  }
  for (size_t c = 0; c < count; ++c)
    store(p.out + (column + c) * p.rows + row, sums[c]);
}

}  // namespace

void FASCIA_PRODUCT(const ProductParts& p) {
  const size_t whole = p.rows / lane_count * lane_count;
  for (size_t first = 0; first < whole; first += product_rows) {
    const size_t end = first + product_rows < whole ? first + product_rows : whole;
    // Columns lie far apart: four strips of each are taken at once, and read in order afterwards.
    for (size_t d = 0; d < p.depth; ++d)
      for (size_t row = first; row < end; row += lane_count)
        store(p.scratch + (row - first) * p.depth + lane_count * d, load(p.columns[d] + row));
    for (size_t row = first; row < end; row += lane_count) {
      const float* panel = p.scratch + (row - first) * p.depth;
      size_t column = 0;
      for (; column + group_width <= p.count; column += group_width)
        strip<group_width>(p, panel, row, column);
      for (; column < p.count; ++column)
        strip<1>(p, panel, row, column);
    }
  }
  for (size_t column = 0; column < p.count; ++column)
    for (size_t row = whole; row < p.rows; ++row) {
      float sum = 0.0F;
      for (size_t d = 0; d < p.depth; ++d)
        sum += p.columns[d][row] * p.mix[column * p.depth + d];
      p.out[column * p.rows + row] = sum;
    }
}

}  // namespace fascia::cli
