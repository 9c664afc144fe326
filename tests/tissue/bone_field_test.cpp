#include "builder/tissue/bone_field.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::tissue {
namespace {

constexpr double cell = 0.0025, reach = 0.0195;

/// The largest difference between neighbours along the axes, as a share of their distance.
double steepest(const BoneField& field) {
  double most = 0.0;
  for (size_t k = 0; k < field.size[2]; ++k)
    for (size_t j = 0; j < field.size[1]; ++j)
      for (size_t i = 1; i < field.size[0]; ++i)
        most = std::max(most, std::abs(static_cast<double>(field.distance[field.index(i, j, k)]) -
                                       field.distance[field.index(i - 1, j, k)]) /
                                  field.spacing);
  return most;
}

double at(const BoneField& field, const Vec3& p) {
  const Vec3 place = (p - field.origin) / field.spacing;
  return field.distance[field.index(static_cast<size_t>(std::lround(place.x())),
                                    static_cast<size_t>(std::lround(place.y())),
                                    static_cast<size_t>(std::lround(place.z())))];
}

Bounds box_of(double half) {
  Bounds box;
  box.lower = Vec3::Constant(-half);
  box.upper = Vec3::Constant(half);
  return box;
}

/// A cube about the origin, its faces outward; without the face towards +y when `open`.
TriangleMesh cube(double half, bool open) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back(half * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  const int faces[6][4] = {{2, 6, 7, 3}, {0, 1, 5, 4}, {0, 4, 6, 2},
                           {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int f = open ? 1 : 0; f < 6; ++f) {
    mesh.triangles.push_back({faces[f][0], faces[f][1], faces[f][2]});
    mesh.triangles.push_back({faces[f][0], faces[f][2], faces[f][3]});
  }
  return mesh;
}

TEST(BoneField, OfASolidGivesDistances) {
  const BoneField field = sample_bone_field(cube(0.01, false), box_of(0.02), cell, reach);
  EXPECT_NEAR(at(field, Vec3(0.015, 0, 0)), 0.005, 1e-6);
  EXPECT_NEAR(at(field, Vec3(0.005, 0, 0)), -0.005, 1e-6);
  EXPECT_NEAR(at(field, Vec3::Constant(0.015)), 0.005 * std::sqrt(3.0), 1e-6);
  EXPECT_LT(steepest(field), 1.0 + 1e-4);
}

TEST(BoneField, DeepInsideIsInside) {
  const BoneField field = sample_bone_field(cube(0.05, false), box_of(0.06), cell, reach);
  EXPECT_NEAR(at(field, Vec3::Zero()), -reach, 1e-6) << "50 mm from the surface, farther than is looked";
  EXPECT_LT(steepest(field), 1.0 + 1e-4);
}

TEST(BoneField, FarAwayIsOutside) {
  Bounds box;
  box.lower = Vec3(0.09, 0.09, 0.09);
  box.upper = Vec3(0.1, 0.1, 0.1);
  for (const float distance : sample_bone_field(cube(0.01, false), box, cell, reach).distance)
    EXPECT_NEAR(distance, reach, 1e-6);
}

TEST(BoneField, OfAnOpenSurfaceDoesNotJump) {
  const BoneField field = sample_bone_field(cube(0.01, true), box_of(0.025), cell, reach);
  EXPECT_LT(steepest(field), 1.0 + 1e-4);
  EXPECT_GT(at(field, Vec3(0, 0.02, 0)), 0.003) << "before the opening there is no bone";
  EXPECT_NEAR(at(field, Vec3(0.015, -0.005, 0)), 0.005, 1e-6) << "beside it";
}

}  // namespace
}  // namespace fascia::tissue
