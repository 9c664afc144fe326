#include "geometry/flaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/shapes/grid.h"

namespace fascia {
namespace {

/// A flat grid of `n` by `n` squares of two triangles each, facing up.
TriangleMesh grid(int n) {
  return testing::grid(n, n,
                       [n](double u, double v) { return Vec3(std::round(u * n), std::round(v * n), 0); });
}

TEST(Flaps, OnlyTheFinIsRemoved) {
  TriangleMesh mesh = grid(8);
  const size_t count = mesh.triangles.size();
  const Triangle under = mesh.triangles[40];
  mesh.vertices.emplace_back(4.5, 2.5, 1);
  mesh.triangles.push_back({under[0], under[1], mesh.vertex_count() - 1});
  const std::vector<bool> kept = without_flaps(mesh);
  EXPECT_FALSE(kept.back());
  EXPECT_EQ(std::count(kept.begin(), kept.end(), true), static_cast<std::ptrdiff_t>(count));
}

TEST(Flaps, CrossingSheetsAreBothKept) {
  TriangleMesh mesh = grid(4);
  TriangleMesh other = grid(4);
  std::vector<int> map;
  for (const Vec3& p : other.vertices) {
    const Vec3 stood(p.x(), 2.0, p.y() - 2.0);  // upright, through the row y = 2
    if (stood.z() == 0.0) {
      map.push_back(static_cast<int>(2 * 5 + stood.x()));
      continue;
    }
    map.push_back(mesh.vertex_count());
    mesh.vertices.push_back(stood);
  }
  for (const Triangle& t : other.triangles)
    mesh.triangles.push_back(
        {map[static_cast<size_t>(t[0])], map[static_cast<size_t>(t[1])], map[static_cast<size_t>(t[2])]});
  const std::vector<bool> kept = without_flaps(mesh);
  EXPECT_EQ(std::count(kept.begin(), kept.end(), false), 0);
}

/// A face with a lip of its own: a plate of 20 by 20 squares whose middle is pressed in as a mouth, and along
/// the lower side of that a closed body whose front and back hang on the same `length` edges.
struct FaceWithLip {
  static constexpr int n = 20, from = 8, length = 4;
  TriangleMesh mesh = grid(n);
  size_t first_of_lip = 0;

  FaceWithLip() {
    for (Vec3& p : mesh.vertices)
      if (p.x() > from - 1 && p.x() <= from + length && p.y() > from && p.y() < from + length) p.z() = -2.0;
    first_of_lip = mesh.triangles.size();
    std::vector<int> front{edge(0)}, back{edge(0)};
    for (int i = 1; i < length; ++i)
      for (std::vector<int>* row : {&front, &back}) {
        row->push_back(mesh.vertex_count());
        mesh.vertices.emplace_back(from + i, from + 0.7, row == &front ? 0.5 : -0.5);
      }
    front.push_back(edge(length));
    back.push_back(edge(length));
    for (int i = 0; i < length; ++i) {
      const auto a = static_cast<size_t>(i), b = a + 1;
      add(edge(i), edge(i + 1), front[b]);
      add(edge(i), front[b], front[a]);
      add(edge(i + 1), edge(i), back[b]);
      add(edge(i), back[a], back[b]);
      add(front[a], front[b], back[b]);
      add(front[a], back[b], back[a]);
    }
  }
  /// Vertices along the mouth's lower side.
  static int edge(int i) { return from * (n + 1) + from + i; }
  void add(int a, int b, int c) {
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
};

TEST(Flaps, ALipOfItsOwnBecomesPartOfTheFace) {
  const FaceWithLip face;
  ASSERT_EQ(connectivity(face.mesh).irregular_edges, FaceWithLip::length);
  const std::vector<bool> kept = without_flaps(face.mesh);
  ASSERT_GT(std::count(kept.begin(), kept.end(), false), 0);  // as a fin would
  const TriangleMesh joined = with_hanging_patches_joined(face.mesh);
  const Connectivity links = connectivity(joined);
  EXPECT_EQ(links.irregular_edges, 0);
  EXPECT_EQ(joined.triangles.size(), face.mesh.triangles.size());
  EXPECT_EQ(joined.vertex_count(), face.mesh.vertex_count() + FaceWithLip::length - 1);
  // From the chin the surface goes on over the lip's front, from the mouth over its back.
  for (size_t t = 0; t < face.first_of_lip; ++t)
    for (size_t e = 0; e < 3; ++e) {
      const int next = links.neighbours[t][e];
      if (next < static_cast<int>(face.first_of_lip)) continue;
      const bool is_chin = bounds({joined.vertices[static_cast<size_t>(joined.triangles[t][0])],
                                   joined.vertices[static_cast<size_t>(joined.triangles[t][1])],
                                   joined.vertices[static_cast<size_t>(joined.triangles[t][2])]})
                               .lower.y() < FaceWithLip::from;
      EXPECT_EQ(is_chin, triangle_normal(joined, next).z() > 0.0) << t;
    }
}

TEST(Flaps, AFinHangsOnNothing) {
  TriangleMesh mesh = grid(8);
  const Triangle under = mesh.triangles[40];
  mesh.vertices.emplace_back(4.5, 2.5, 1);
  mesh.triangles.push_back({under[0], under[1], mesh.vertex_count() - 1});
  const TriangleMesh same = with_hanging_patches_joined(mesh);
  EXPECT_EQ(same.vertex_count(), mesh.vertex_count());
  EXPECT_EQ(same.triangles, mesh.triangles);
}

TEST(Flaps, TurnedTrianglesAreFoundFromTheirNeighbours) {
  TriangleMesh mesh = grid(8);
  std::vector<bool> turned(mesh.triangles.size(), false);
  for (const size_t t : {0U, 17U, 18U, 19U, 55U, 127U})
    turned[t] = true;
  for (size_t t = 0; t < turned.size(); ++t)
    if (turned[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  EXPECT_EQ(facing_against(mesh), turned);
}

TEST(Flaps, OfTwoHalvesTheSmallerIsTurned) {
  TriangleMesh mesh = grid(9);
  const size_t first = mesh.triangles.size() * 4 / 9;
  for (size_t t = 0; t < first; ++t)
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  const std::vector<bool> against = facing_against(mesh);
  for (size_t t = 0; t < against.size(); ++t)
    EXPECT_EQ(against[t], t < first) << t;
}

TEST(Flaps, VerticesThatCoincideTurnNothingThatWasOrientedAlike) {
  // A strip whose ends lie in one place, one of them turned: a Moebius strip, once its vertices are merged.
  constexpr int squares = 6;
  std::vector<Triangle> original;
  TriangleMesh mesh;
  for (int i = 0; i < squares; ++i) {
    original.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    original.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
    for (int side = 0; side < 2; ++side)
      mesh.vertices.emplace_back(std::cos(i), std::sin(i), side);
  }
  for (const Triangle& t : original) {
    mesh.triangles.push_back(t);
    for (int& v : mesh.triangles.back())
      if (v >= 2 * squares) v = 2 * squares + 1 - v;
  }
  const std::vector<bool> merged = facing_against(mesh), by_original = facing_against(mesh, original);
  EXPECT_GT(std::count(merged.begin(), merged.end(), true), 0);
  EXPECT_EQ(std::count(by_original.begin(), by_original.end(), true), 0);
}

}  // namespace
}  // namespace fascia
