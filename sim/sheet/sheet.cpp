#include "sim/sheet/sheet.h"

#include <cmath>

namespace fascia::sim {
namespace {

constexpr uint32_t strips = 16;  // one a lane

sheet::StepFunction step_for([[maybe_unused]] lanes::InstructionSet instructions) {
#if defined(__x86_64__)
  switch (instructions) {
    case lanes::InstructionSet::avx512:
      return sheet::step_avx512;
    case lanes::InstructionSet::avx2:
      return sheet::step_avx2;
    case lanes::InstructionSet::baseline:
      break;
  }
#endif
  return sheet::step_baseline;
}

}  // namespace

Sheet::Sheet(const SheetOptions& options) : options_(options), step_(step_for(options.instructions)) {
  sheet::State& s = state_;
  s.rows = options.rows;
  s.width = (options.columns + strips - 1) / strips;
  s.spacing = options.spacing;
  // Room before and after: a spring that leaves a strip reads its neighbour one lane on. All lists begin at a
  // cache line.
  const size_t margin = 2 * strips, places = static_cast<size_t>(s.rows) * s.width * strips,
               block = places + 2 * margin;
  const size_t masks = static_cast<size_t>(s.width) * strips;
  memory_.assign(10 * block + 2 * masks + 5 * static_cast<size_t>(s.rows) * strips + strips, 0.0F);
  const size_t past_line = reinterpret_cast<uintptr_t>(memory_.data()) / sizeof(float) % strips;
  float* const first = memory_.data() + (strips - past_line) % strips;
  float* next = first + margin;
  const auto take = [&] {
    float* const taken = next;
    next += block;
    return taken;
  };
  for (float** list :
       {&s.x, &s.y, &s.z, &s.before_x, &s.before_y, &s.before_z, &s.velocity_x, &s.velocity_y, &s.velocity_z})
    *list = take();
  float* const inverse_mass = take();
  s.inverse_mass = inverse_mass;
  float* const exists = first + 10 * block;
  s.exists_1 = exists;
  s.exists_2 = exists + masks;
  s.chain = exists + 2 * masks;
  for (uint32_t row = 0; row < s.rows; ++row)
    for (uint32_t column = 0; column < s.width * strips; ++column) {
      const size_t i = index(row, column);
      const Vec3f place = options.corner + options.spacing * (static_cast<float>(column) * options.along_row +
                                                              static_cast<float>(row) * options.along_column);
      s.x[i] = place.x();
      s.y[i] = place.y();
      s.z[i] = place.z();
      if (row > 0 && column < options.columns) inverse_mass[i] = 1.0F;
    }
  for (uint32_t column = 0; column < options.columns; ++column)
    for (uint32_t step = 1; step <= 2; ++step)
      if (column + step < options.columns) exists[(step - 1) * masks + index(0, column)] = 1.0F;
}

size_t Sheet::index(uint32_t row, uint32_t column) const {
  const size_t strip = column / state_.width, within = column % state_.width;
  return (static_cast<size_t>(row) * state_.width + within) * strips + strip;
}

void Sheet::step(float seconds) {
  const Vec3f& g = options_.gravity;
  step_(state_, {options_.substeps, seconds / static_cast<float>(options_.substeps), {g.x(), g.y(), g.z()}});
}

Vec3f Sheet::position(uint32_t row, uint32_t column) const {
  const size_t i = index(row, column);
  return {state_.x[i], state_.y[i], state_.z[i]};
}

uint32_t Sheet::spring_count() const {
  const uint32_t r = options_.rows, c = options_.columns;
  return r * (c - 1) + (r - 1) * c + 2 * (r - 1) * (c - 1) + r * (c - 2) + (r - 2) * c;
}

double Sheet::mean_stretch() const {
  constexpr int ways[6][2] = {{0, 1}, {1, 0}, {1, 1}, {1, -1}, {0, 2}, {2, 0}};
  double sum = 0.0;
  for (uint32_t row = 0; row < options_.rows; ++row)
    for (uint32_t column = 0; column < options_.columns; ++column)
      for (const auto& way : ways) {
        const int64_t r = static_cast<int64_t>(row) + way[0], c = static_cast<int64_t>(column) + way[1];
        if (r >= options_.rows || c < 0 || c >= options_.columns) continue;
        const double rest = static_cast<double>(options_.spacing) * std::hypot(way[0], way[1]);
        const Vec3f along =
            position(static_cast<uint32_t>(r), static_cast<uint32_t>(c)) - position(row, column);
        sum += std::abs(along.cast<double>().norm() / rest - 1.0);
      }
  return sum / spring_count();
}

}  // namespace fascia::sim
