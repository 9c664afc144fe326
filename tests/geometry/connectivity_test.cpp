#include "geometry/connectivity.h"

#include <gtest/gtest.h>

namespace fascia {
namespace {

TriangleMesh tetrahedron() {
  return {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(Connectivity, ClosedSurfaceHasANeighbourAcrossEveryEdge) {
  const Connectivity links = connectivity(tetrahedron());
  for (const auto& row : links.neighbours)
    for (int neighbour : row)
      EXPECT_GE(neighbour, 0);
  EXPECT_EQ(links.irregular_edges, 0);
  EXPECT_TRUE(boundary_loops(tetrahedron(), links).empty());
}

TEST(Connectivity, OpenSurfaceHasItsBoundaryAsALoop) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  const auto loops = boundary_loops(mesh, connectivity(mesh));
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 3u);
}

TEST(Connectivity, ThreeTrianglesOnAnEdgeAreIrregular) {
  TriangleMesh mesh = tetrahedron();
  mesh.vertices.push_back(Vec3(1, 1, 1));
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_GE(connectivity(mesh).irregular_edges, 1);
}

TEST(Weld, MergesSeamVerticesAndDropsSlivers) {
  TriangleMesh seam{
      {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 1e-9), Vec3(1, 1, 0), Vec3(0, 1, 0)},
      {{0, 1, 2}, {3, 4, 5}, {1, 3, 4}}};
  std::vector<int> map;
  const TriangleMesh welded = weld(seam, 1e-6, &map);
  EXPECT_EQ(welded.vertex_count(), 4);
  EXPECT_EQ(welded.triangle_count(), 2);
  EXPECT_EQ(map[1], map[3]);
  EXPECT_EQ(map[2], map[5]);
}

TEST(Components, CountsSeparateShells) {
  TriangleMesh two = tetrahedron();
  for (const Vec3& v : tetrahedron().vertices)
    two.vertices.push_back(v + Vec3(5, 0, 0));
  for (Triangle t : tetrahedron().triangles)
    two.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  int count = 0;
  const auto component = components(two, &count);
  EXPECT_EQ(count, 2);
  EXPECT_EQ(component.front(), 0);
  EXPECT_EQ(component.back(), 1);
}

}  // namespace
}  // namespace fascia
