#include "builder/tissue/mirror.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "geometry/connectivity.h"
#include "tests/shapes/grid.h"

namespace fascia::tissue {
namespace {

/// A vault of 160 by 120 mm, the same on both sides of x = 0, cut into triangles that are not.
TriangleMesh vault(double lopsided = 0.0) {
  return testing::waving_vault(23, 17, 0.001, [&](double x, double) { return lopsided * x; });
}

RemeshResult remeshed_half(const TriangleMesh& mesh, const Symmetry& symmetry) {
  const HalfRegion half = left_half(mesh, symmetry);
  return on_region(remesh(half.mesh, std::vector<double>(half.mesh.vertices.size(), 0.009)), half, symmetry);
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    area += triangle_area(mesh, t);
  return area;
}

TEST(Mirror, AHalfIsTheLeftOfThePlaneAndKnowsItsPlaces) {
  const TriangleMesh mesh = vault();
  const HalfRegion half = left_half(mesh, {});
  for (size_t v = 0; v < half.source.size(); ++v) {
    EXPECT_GE(half.mesh.vertices[v].x(), 0.0);
    EXPECT_LT((half.mesh.vertices[v] - position(mesh, half.source[v])).norm(), 6e-5);
  }
  // Triangles straddle the middle otherwise on each side, so the halves' areas differ by what that flattens.
  EXPECT_NEAR(area_of(half.mesh), 0.5 * area_of(mesh), 0.003 * area_of(mesh));
}

TEST(Mirror, ImagesAreExactAndTheHalvesJoined) {
  Symmetry symmetry;
  symmetry.is_exact = true;
  FaceRegion region;
  region.mesh = vault();
  const RemeshResult half = remeshed_half(region.mesh, symmetry);
  std::vector<size_t> left;
  const auto full = with_images(half, region, {}, symmetry, left);
  ASSERT_TRUE(full);
  const size_t first = half.mesh.vertices.size();
  ASSERT_EQ(full->mesh.vertices.size(), first + left.size());
  EXPECT_GT(first - left.size(), 8U);  // a row of vertices on the plane itself
  for (size_t k = 0; k < left.size(); ++k) {
    const Vec3 &p = full->mesh.vertices[left[k]], &q = full->mesh.vertices[first + k];
    EXPECT_EQ(p.x(), -q.x());
    EXPECT_EQ(p.y(), q.y());
    EXPECT_EQ(p.z(), q.z());
    EXPECT_LT((q - position(region.mesh, full->source[first + k])).norm(), 6e-4);
  }
  const Connectivity links = connectivity(full->mesh);
  EXPECT_EQ(links.irregular_edges, 0);
  EXPECT_EQ(boundary_loops(full->mesh, links).size(), 1U);
  for (int t = 0; t < full->mesh.triangle_count(); ++t)
    EXPECT_GT(triangle_normal(full->mesh, t).z(), 0.0);
}

TEST(Mirror, ImagesStayOnTheLipOfTheirOriginals) {
  // The vault parted along a row, as lips are that came closed.
  const TriangleMesh whole = vault();
  FaceRegion region;
  std::vector<double> lower_lip;
  std::vector<int> below(whole.vertices.size(), -1);
  region.mesh.vertices = whole.vertices;
  lower_lip.assign(whole.vertices.size(), 0.0);
  const double line = 0.12 * (8.0 / 17.0 - 0.5);  // metres
  const auto row = [&](int v) { return std::abs(whole.vertices[static_cast<size_t>(v)].y() - line) < 1e-6; };
  for (fascia::Triangle t : whole.triangles) {
    double y = 0.0;
    for (const int v : t)
      y += whole.vertices[static_cast<size_t>(v)].y() / 3.0;
    for (int& v : t)
      if (y < line && row(v)) {
        int& copy = below[static_cast<size_t>(v)];
        if (copy < 0) {
          copy = region.mesh.vertex_count();
          region.mesh.vertices.push_back(whole.vertices[static_cast<size_t>(v)]);
          lower_lip.push_back(1.0);
        }
        v = copy;
      } else if (y < line) {
        lower_lip[static_cast<size_t>(v)] = 1.0;
      }
    region.mesh.triangles.push_back(t);
  }
  ASSERT_GT(lower_lip.size(), whole.vertices.size() + 10U);
  const RemeshResult half = remeshed_half(region.mesh, {});
  const auto lip_of = [&](const SurfacePoint& place) {
    return lower_lip[static_cast<size_t>(region.mesh.triangles[static_cast<size_t>(place.triangle)][0])];
  };
  std::vector<size_t> left;
  const auto full = with_images(half, region, lower_lip, {}, left);
  ASSERT_TRUE(full);
  for (size_t k = 0; k < left.size(); ++k)
    EXPECT_EQ(lip_of(full->source[half.source.size() + k]), lip_of(full->source[left[k]])) << k;
  const auto without = with_images(half, region, {}, {}, left);
  ASSERT_TRUE(without);
  int astray = 0;
  for (size_t k = 0; k < left.size(); ++k)
    astray += lip_of(without->source[half.source.size() + k]) != lip_of(without->source[left[k]]);
  EXPECT_GT(astray, 0);  // the case is a hard one
}

TEST(Mirror, OnALopsidedSkinImagesLieOnIt) {
  FaceRegion region;
  region.mesh = vault(0.02);
  const RemeshResult half = remeshed_half(region.mesh, {});
  std::vector<size_t> left;
  const auto full = with_images(half, region, {}, {}, left);
  ASSERT_TRUE(full);
  for (size_t v = 0; v < full->source.size(); ++v)
    EXPECT_LT((full->mesh.vertices[v] - position(region.mesh, full->source[v])).norm(), 2e-4);
  EXPECT_EQ(boundary_loops(full->mesh, connectivity(full->mesh)).size(), 1U);
}

TEST(Mirror, MissingSidesAreNotInvented) {
  FaceRegion region;
  const TriangleMesh whole = vault();
  std::vector<bool> keep;
  for (int t = 0; t < whole.triangle_count(); ++t) {
    double x = 0.0;
    for (const int v : whole.triangles[static_cast<size_t>(t)])
      x += whole.vertices[static_cast<size_t>(v)].x() / 3.0;
    keep.push_back(x > -0.03);
  }
  std::vector<int> map;
  region.mesh = submesh(whole, keep, &map);
  std::vector<size_t> left;
  EXPECT_FALSE(with_images(remeshed_half(region.mesh, {}), region, {}, {}, left));
}

TEST(Mirror, MusclesOfTheRightAreImagesUnlessTheyWereChanged) {
  TissueInputs inputs;
  for (const char* name : {"risorius_left", "risorius_right", "procerus"}) {
    rig::Muscle muscle;
    muscle.name = name;
    muscle.fibre_offsets = {0, 2};
    const float side = muscle.name == "risorius_left" ? 0.03F : -0.04F;
    muscle.points = {{side, 0.01F, 0.05F}, {2.0F * side, 0.0F, 0.04F}};
    inputs.muscles.push_back(muscle);
  }
  const TissueInputs mirrored = with_mirrored_sides(inputs, {});
  EXPECT_EQ(mirrored.muscles[1].points[0].x(), -0.03F);
  EXPECT_EQ(mirrored.muscles[2].points[0].x(), -0.04F);
  inputs.has_muscles_by_hand = true;
  EXPECT_EQ(with_mirrored_sides(inputs, {}).muscles[1].points[0].x(), -0.04F);
}

}  // namespace
}  // namespace fascia::tissue
