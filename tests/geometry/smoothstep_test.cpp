#include "geometry/smoothstep.h"

#include <gtest/gtest.h>

namespace fascia {
namespace {

TEST(Smoothstep, RisesFrom0To1WithZeroSlopeAtTheEnds) {
  EXPECT_EQ(smoothstep(-1.0), 0.0);
  EXPECT_EQ(smoothstep(0.0), 0.0);
  EXPECT_EQ(smoothstep(0.5), 0.5);
  EXPECT_EQ(smoothstep(1.0F), 1.0F);
  EXPECT_EQ(smoothstep(7.0F), 1.0F);
  EXPECT_NEAR(smoothstep(1e-4), 0.0, 1e-7);
  EXPECT_NEAR(1.0 - smoothstep(1.0 - 1e-4), 0.0, 1e-7);
}

TEST(Smoothstep, TakesAnInterval) {
  EXPECT_EQ(smoothstep(2.0, 6.0, 2.0), 0.0);
  EXPECT_EQ(smoothstep(2.0, 6.0, 4.0), 0.5);
  EXPECT_EQ(smoothstep(2.0, 6.0, 3.0), smoothstep(0.25));
  EXPECT_EQ(smoothstep(2.0, 6.0, 9.0), 1.0);
}

}  // namespace
}  // namespace fascia
