#include <gtest/gtest.h>

#include <random>

#include "bench/geodesics/exact_paths.h"
#include "tests/geodesics/surfaces.h"

namespace fascia::geodesics {
namespace {

/// Our path against CGAL's shortest one: never shorter, and as long to 1e-6 unless it passes a bump or a hole
/// on the other side. Returns how many of `pairs` are the same.
int compare(const TriangleMesh& mesh, const std::vector<bench::PointPair>& pairs) {
  const Surface surface = make_surface(mesh);
  const auto exact = bench::exact_paths(mesh, pairs);
  int same = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double length = connect(surface, pairs[i].from, pairs[i].to).length;
    EXPECT_GE(length, exact[i].length * (1 - 1e-9));
    EXPECT_LE(length, exact[i].length * 1.1);
    if (length < exact[i].length * (1 + 1e-6)) ++same;
  }
  return same;
}

std::vector<bench::PointPair> random_pairs(const TriangleMesh& mesh, int count) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> any(0, mesh.triangle_count() - 1);
  std::vector<bench::PointPair> pairs;
  for (int i = 0; i < count; ++i)
    pairs.push_back({{any(random), Vec3(0.2, 0.3, 0.5)}, {any(random), Vec3(0.5, 0.1, 0.4)}});
  return pairs;
}

TEST(ExactPath, IsOursOnAGentleSurface) {
  const TriangleMesh mesh =
      grid(24, 24, [](double u, double v) { return Vec3(u, v, 0.06 * std::sin(5 * u) * std::cos(4 * v)); });
  EXPECT_GE(compare(mesh, random_pairs(mesh, 20)), 19);
}

TEST(ExactPath, MatchesCgalOrAnEquallyShortPath) {
  const TriangleMesh mesh =
      grid(24, 24, [](double u, double v) { return Vec3(u, v, 0.12 * std::sin(9 * u) * std::cos(7 * v)); });
  EXPECT_GE(compare(mesh, random_pairs(mesh, 20)), 12);
}

TEST(ExactPath, IsOursOnASphere) {
  const TriangleMesh mesh = sphere(3);
  EXPECT_GE(compare(mesh, random_pairs(mesh, 20)), 14);
}

}  // namespace
}  // namespace fascia::geodesics
