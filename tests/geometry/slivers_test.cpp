#include "geometry/slivers.h"

#include <gtest/gtest.h>

#include "geometry/connectivity.h"

namespace fascia {
namespace {

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    sum += triangle_area(mesh, t);
  return sum;
}

/// A unit square of two triangles in the plane z = 0, corners 0 .. 3 counter-clockwise.
TriangleMesh square() {
  return {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, {{0, 1, 2}, {0, 2, 3}}};
}

TEST(Slivers, ASoundMeshComesBackAsItIs) {
  std::vector<int> map;
  const TriangleMesh mesh = square(), out = without_slivers(mesh, 1e-6, &map);
  EXPECT_EQ(out.triangles, mesh.triangles);
  EXPECT_EQ(map, (std::vector<int>{0, 1, 2, 3}));
}

TEST(Slivers, ACapOnTheDiagonalIsFlippedAndLosesNoVertex) {
  TriangleMesh mesh = square();
  mesh.vertices.push_back(Vec3(0.5, 0.5, 0));  // on the diagonal of the upper triangle's neighbour
  mesh.triangles = {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}};
  std::vector<int> map;
  const TriangleMesh out = without_slivers(mesh, 1e-6, &map);
  EXPECT_EQ(out.vertex_count(), 5);
  EXPECT_NEAR(area(out), 1.0, 1e-12);
  for (int t = 0; t < out.triangle_count(); ++t)
    EXPECT_NEAR(triangle_normal(out, t).z(), 1.0, 1e-12) << t;
  const Connectivity links = connectivity(out);
  EXPECT_EQ(links.irregular_edges, 0);
  ASSERT_EQ(boundary_loops(out, links).size(), 1U);  // no crack is left
  EXPECT_EQ(boundary_loops(out, links)[0].size(), 4U);
}

TEST(Slivers, TheEndsOfANeedleBecomeOneAndNoCrackIsLeft) {
  TriangleMesh mesh = square();
  mesh.vertices.push_back(Vec3(1, 1, 1e-9));  // beside corner 2
  mesh.triangles = {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}};
  std::vector<int> map;
  const TriangleMesh out = without_slivers(mesh, 1e-6, &map);
  EXPECT_EQ(out.triangle_count(), 2);
  EXPECT_EQ(map[2], map[4]);
  EXPECT_EQ(boundary_loops(out, connectivity(out)).size(), 1U);
}

TEST(Slivers, ThreePointsInOneAndSliversAtTheRimAreLeftOut) {
  TriangleMesh mesh = square();
  mesh.vertices.insert(mesh.vertices.end(), {Vec3(2, 0, 0), Vec3(5, 5, 5), Vec3(5, 5, 5), Vec3(5, 5, 5)});
  mesh.triangles.push_back({0, 1, 4});  // flat along the lower side's line
  mesh.triangles.push_back({5, 6, 7});
  std::vector<int> map;
  const TriangleMesh out = without_slivers(mesh, 1e-6, &map);
  EXPECT_EQ(out.triangle_count(), 2);
  EXPECT_NEAR(area(out), 1.0, 1e-12);
  EXPECT_EQ(map[5], -1);
}

}  // namespace
}  // namespace fascia
