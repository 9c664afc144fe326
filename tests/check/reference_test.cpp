// Shapes that were sculpted or measured, played as if a rig had made them, must pass the rows that judge
// rigs.
#include <gtest/gtest.h>

#include "anatomy/checks.h"
#include "check/check.h"
#include "tests/check/sculpted.h"
#include "tests/paths/paths.h"

namespace fascia::testing {
namespace {

TEST(Reference, ShapesOfTheMeasuredModelPassButForItsLids) {
  if (!std::filesystem::exists(test::measured_data() / "data/ict"))
    GTEST_SKIP() << "no measured data beside the project";
  const anatomy::Checks checks = anatomy::load_checks();
  const SculptedHead head = ict_person("neutral");
  int rows = 0;
  for (const check::Row& row : check::run(head.head, head.player, checks)) {
    ++rows;
    // Its blink leaves a millimetre; the bound is half of one (docs/check.md).
    if (row.name.find(".lid_gap") != std::string::npos)
      EXPECT_LT(row.value, 1.1) << row.name;
    else
      EXPECT_TRUE(row.ok) << row.name << " " << row.value << " in " << row.pose;
  }
  EXPECT_GT(rows, 30);
}

TEST(Reference, ShapesOfAnAvatarPass) {
  const std::filesystem::path file = test::measured_data() / "data/wild/rpm_avatar.glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured data beside the project";
  const SculptedHead head = sculpted_head(file, "Wolf3D_Head");
  int rows = 0;
  for (const check::Row& row : check::run(head.head, head.player, anatomy::load_checks())) {
    ++rows;
    EXPECT_TRUE(row.ok) << row.name << " " << row.value << " in " << row.pose;
  }
  EXPECT_GT(rows, 35);
}

}  // namespace
}  // namespace fascia::testing
