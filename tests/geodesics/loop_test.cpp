#include "builder/geodesics/loop.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/geodesics/surfaces.h"

namespace fascia::geodesics {
namespace {

TEST(TightenLoop, GirdsACylinder) {
  const int around = 36;
  const Surface surface = make_surface(cylinder(around, 21, 1.0, 2.0));
  const std::vector<SurfacePoint> corners = {at_vertex(surface.mesh, 5 * around),
                                             at_vertex(surface.mesh, 14 * around + 11),
                                             at_vertex(surface.mesh, 9 * around + 24)};
  const LoopResult loop = tighten_loop(surface, corners);
  EXPECT_FALSE(loop.contracted);
  EXPECT_NEAR(loop.path.length, around * 2 * std::sin(kPi / around), 1e-9);
  EXPECT_LT((loop.path.positions.front() - loop.path.positions.back()).norm(), 1e-12);
}

TEST(TightenLoop, FindsTheWaistOfAHyperboloid) {
  const int around = 40, along = 40;
  const Surface surface = make_surface(grid(
      around, along,
      [](double u, double v) {
        const double z = 2 * v - 1, radius = std::sqrt(1 + z * z);
        return Vec3(radius * std::cos(2 * kPi * u), radius * std::sin(2 * kPi * u), z);
      },
      true));
  const LoopResult loop =
      tighten_loop(surface, {at_vertex(surface.mesh, 30 * around), at_vertex(surface.mesh, 33 * around + 13),
                             at_vertex(surface.mesh, 28 * around + 27)});
  EXPECT_FALSE(loop.contracted);
  EXPECT_NEAR(loop.path.length, around * 2 * std::sin(kPi / around), 1e-6);
}

TEST(TightenLoop, CollapsesWithoutAnObstacle) {
  const Surface surface = make_surface(plane(12));
  const LoopResult loop = tighten_loop(
      surface, {below(surface.mesh, 0.2, 0.2), below(surface.mesh, 0.8, 0.3), below(surface.mesh, 0.5, 0.8)});
  EXPECT_TRUE(loop.contracted);
  EXPECT_THROW(tighten_loop(surface, {at(0, 1, 0, 0), at(3, 1, 0, 0)}), Error);
}

}  // namespace
}  // namespace fascia::geodesics
