#include "sim/sheet/sheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/instruction_sets.h"

namespace fascia::sim {
namespace {

TEST(Sheet, EveryInstructionSetGivesTheSameBits) {
  SheetOptions options;
  options.rows = 23;
  options.columns = 37;
  const auto fallen = [&](lanes::InstructionSet set) {
    options.instructions = set;
    Sheet sheet(options);
    for (int frame = 0; frame < 40; ++frame)
      sheet.step(1.0F / 60.0F);
    return sheet;
  };
  const Sheet expected = fallen(lanes::InstructionSet::baseline);
  EXPECT_LT(expected.position(22, 18).y(), -0.1F);
  for (const lanes::InstructionSet set : testing::all_instruction_sets()) {
    const Sheet sheet = fallen(set);
    for (uint32_t row = 0; row < options.rows; ++row)
      for (uint32_t column = 0; column < options.columns; ++column)
        ASSERT_EQ(sheet.position(row, column), expected.position(row, column)) << row << " " << column;
  }
}

TEST(Sheet, TwoRowsSwingAsAPendulum) {
  SheetOptions options;
  options.rows = 2;
  options.columns = 4;
  options.spacing = 0.25F;
  const float angle = 0.1F;
  options.along_column = Vec3f(0.0F, -std::cos(angle), std::sin(angle));
  options.substeps = 10;
  Sheet sheet(options);
  std::vector<double> crossings;  // in both directions: half a period apart
  float last = sheet.position(1, 2).z();
  for (int frame = 1; frame <= 240; ++frame) {
    sheet.step(1.0F / 120.0F);
    const float now = sheet.position(1, 2).z();
    if ((last > 0.0F) != (now > 0.0F))
      crossings.push_back((frame - static_cast<double>(now / (now - last))) / 120.0);
    last = now;
  }
  ASSERT_GE(crossings.size(), 2U);
  // A point pendulum at its amplitude: 2 pi sqrt(l / g) (1 + angle^2 / 16).
  const double period = 2.0 * std::numbers::pi * std::sqrt(0.25 / 9.81) * (1.0 + angle * angle / 16.0);
  EXPECT_NEAR(2.0 * (crossings[1] - crossings[0]), period, 0.005 * period);
}

TEST(Sheet, HangsWithoutStretch) {
  SheetOptions options;
  options.along_column = -Vec3f::UnitY();
  Sheet sheet(options);
  for (int frame = 0; frame < 60; ++frame)
    sheet.step(1.0F / 60.0F);
  EXPECT_EQ(sheet.spring_count(), 59002U);
  EXPECT_LT(sheet.mean_stretch(), 1e-4);
  for (uint32_t column = 0; column < options.columns; ++column) {
    EXPECT_EQ(sheet.position(0, column).y(), 0.0F);
    EXPECT_NEAR(sheet.position(99, column).y(), -0.99F, 2e-4F);
  }
}

TEST(Sheet, SwingsThroughWithItsLengths) {
  Sheet sheet(SheetOptions{});
  double worst = 0.0;
  float lowest = 0.0F;
  for (int frame = 0; frame < 180; ++frame) {
    sheet.step(1.0F / 60.0F);
    worst = std::max(worst, sheet.mean_stretch());
    lowest = std::min(lowest, sheet.position(99, 50).y());
  }
  EXPECT_LT(worst, 0.015);
  EXPECT_LT(lowest, -0.95F);
  EXPECT_GT(lowest, -1.05F);
}

}  // namespace
}  // namespace fascia::sim
