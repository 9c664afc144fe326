#include "geometry/half_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "tests/shapes/grid.h"

namespace fascia {
namespace {

/// A sheet of n x n squares, each two triangles.
TriangleMesh sheet(int n) {
  return testing::grid(n, n,
                       [n](double u, double v) { return Vec3(std::round(u * n), std::round(v * n), 0); });
}

/// Vertices - edges + triangles of what is left.
int euler_characteristic(const HalfEdges& mesh) {
  std::set<int> vertices;
  int triangles = 0, edges = 0;
  for (int h = 0; h < static_cast<int>(mesh.twin.size()); ++h) {
    if (mesh.gone(h)) continue;
    vertices.insert(mesh.from(h));
    triangles += h % 3 == 0;
    edges += mesh.across(h) < 0 || mesh.across(h) < h;
  }
  return static_cast<int>(vertices.size()) - edges + triangles;
}

/// All links agree with the triangles, from nothing but the triangles.
void expect_sound(const HalfEdges& mesh) {
  std::map<std::pair<int, int>, int> sides;
  std::map<int, int> corners;
  for (int h = 0; h < static_cast<int>(mesh.twin.size()); ++h) {
    if (mesh.gone(h)) continue;
    EXPECT_TRUE(sides.emplace(std::pair(mesh.from(h), mesh.to(h)), h).second) << "an edge twice";
    ++corners[mesh.from(h)];
  }
  for (const auto& [ends, h] : sides) {
    const auto other = sides.find({ends.second, ends.first});
    EXPECT_EQ(mesh.across(h), other == sides.end() ? -1 : other->second);
    EXPECT_EQ(mesh.find(ends.first, ends.second), h);
  }
  for (const auto& [v, count] : corners) {
    EXPECT_EQ(mesh.valence(v), count) << "around " << v;
    const int first = mesh.leaving[static_cast<size_t>(v)];
    ASSERT_GE(first, 0);
    EXPECT_EQ(mesh.from(first), v);
  }
}

/// The link condition, and no border pinched.
bool may_collapse(const HalfEdges& mesh, int h) {
  const int a = mesh.from(h), b = mesh.to(h);
  if (mesh.on_boundary(a) && mesh.on_boundary(b) && mesh.across(h) >= 0) return false;
  std::vector<int> ring_a, ring_b, common;
  mesh.ring(a, ring_a);
  mesh.ring(b, ring_b);
  std::set_intersection(ring_a.begin(), ring_a.end(), ring_b.begin(), ring_b.end(),
                        std::back_inserter(common));
  return common.size() == (mesh.across(h) < 0 ? 1U : 2U) && ring_a.size() > 3 && ring_b.size() > 3;
}

TEST(HalfEdges, LinkASheetAndItsBorder) {
  const HalfEdges mesh(sheet(3));
  expect_sound(mesh);
  EXPECT_EQ(mesh.valence(5), 6);
  EXPECT_FALSE(mesh.on_boundary(5));
  EXPECT_TRUE(mesh.on_boundary(1));
  EXPECT_EQ(mesh.after_on_boundary(1), 2);
  EXPECT_EQ(mesh.before_on_boundary(1), 0);
  std::vector<int> ring;
  mesh.ring(5, ring);
  EXPECT_EQ(ring, (std::vector<int>{0, 1, 4, 6, 9, 10}));
  EXPECT_EQ(mesh.find(5, 2), -1);
}

TEST(HalfEdges, FlipJoinsTheCornersAcross) {
  HalfEdges mesh(sheet(1));
  const int h = mesh.find_either(0, 3);
  mesh.flip(h);
  EXPECT_EQ(mesh.find_either(0, 3), -1);
  EXPECT_GE(mesh.find_either(1, 2), 0);
  expect_sound(mesh);
}

TEST(HalfEdges, StaySoundUnderAnyEdits) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937 random(seed);
    HalfEdges mesh(sheet(6));
    int edits[3] = {0, 0, 0};
    for (int i = 0; i < 600; ++i) {
      const int h = static_cast<int>(random() % mesh.twin.size());
      if (mesh.gone(h)) continue;
      switch (random() % 3) {
        case 0:
          mesh.split(h);
          ++edits[0];
          break;
        case 1:
          if (mesh.across(h) < 0 || mesh.find_either(mesh.apex(h), mesh.apex(mesh.across(h))) >= 0) break;
          mesh.flip(h);
          ++edits[1];
          break;
        default:
          if (!may_collapse(mesh, h)) break;
          // A vertex of the border stays on it.
          mesh.collapse(h, mesh.on_boundary(mesh.from(h)) ? mesh.from(h) : mesh.to(h));
          ++edits[2];
      }
    }
    for (const int count : edits)
      EXPECT_GT(count, 20);
    expect_sound(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 1) << "still a disc";
    const size_t before = mesh.leaving.size();
    const std::vector<int> stay = mesh.compact();
    EXPECT_LT(stay.size(), before);
    EXPECT_TRUE(std::is_sorted(stay.begin(), stay.end()));
    EXPECT_EQ(mesh.leaving.size(), stay.size());
    expect_sound(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 1);
  }
}

TEST(HalfEdges, AVertexWhereFansMeetIsFixed) {
  TriangleMesh bow;
  bow.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(-1, 0, 0), Vec3(-1, -1, 0)};
  bow.triangles = {{0, 1, 2}, {0, 3, 4}};
  const HalfEdges mesh(bow);
  EXPECT_TRUE(mesh.fixed[0]);
  EXPECT_FALSE(mesh.fixed[1]);
  EXPECT_FALSE(mesh.may_edit(1)) << "the side from 1 to 2 has it across";
}

TEST(HalfEdges, EdgesOfThreeTrianglesAreBorders) {
  TriangleMesh fin;
  fin.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1)};
  fin.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const HalfEdges mesh(fin);
  for (const int h : {0, 3, 6})
    EXPECT_EQ(mesh.across(h), -1);
  EXPECT_FALSE(mesh.may_edit(0));
}

}  // namespace
}  // namespace fascia
