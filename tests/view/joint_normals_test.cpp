#include "view/face/joint_normals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::view {
namespace {

/// One of the two sides of a roof over y = 0, as a mesh of its own: up from the ridge at x = 0 to x = `side`.
std::vector<Vec3> half_roof(double side) {
  return {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(side, 1, -0.5), Vec3(side, 0, -0.5)};
}

const std::vector<Triangle> clockwise = {{0, 2, 1}, {0, 3, 2}}, anticlockwise = {{0, 1, 2}, {0, 2, 3}};

TEST(JointNormals, TwoMeshesThatMeetAreSmoothAcrossTheirBorder) {
  const std::vector<std::vector<Vec3>> meshes = {half_roof(-1), half_roof(1)};
  const auto normals = JointNormals(meshes, {clockwise, anticlockwise}).of(meshes);
  for (size_t v : {0U, 1U}) {
    EXPECT_EQ(normals[0][v], normals[1][v]);
    EXPECT_NEAR(std::abs(normals[0][v].z()), 1.0, 1e-12) << "the ridge faces neither side";
  }
  EXPECT_LT(normals[0][2].dot(normals[1][2]), 0.9) << "what does not meet keeps its own";
}

TEST(JointNormals, HoldsInAPoseThatPullsTheBorderApartByRounding) {
  std::vector<std::vector<Vec3>> meshes = {half_roof(-1), half_roof(1)};
  const JointNormals joint(meshes, {clockwise, anticlockwise});
  meshes[1][0].x() += 1e-9;
  const auto normals = joint.of(meshes);
  EXPECT_EQ(normals[0][0], normals[1][0]);
}

TEST(JointNormals, TheBackOfADoubledSheetKeepsItsOwn) {
  const std::vector<std::vector<Vec3>> meshes = {half_roof(1), half_roof(1)};
  const auto normals = JointNormals(meshes, {anticlockwise, clockwise}).of(meshes);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(normals[0][v].norm(), 1.0, 1e-12);
    EXPECT_NEAR((normals[0][v] + normals[1][v]).norm(), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace fascia::view
