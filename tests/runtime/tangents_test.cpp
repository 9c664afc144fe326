#include "runtime/tangents.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace {

using namespace fascia::runtime;

/// A square of 5 x 5 vertices in the plane z = 0; its first texture coordinate grows along (1, 1, 0).
fascia::rig::Primitive square(bool is_mirrored) {
  fascia::rig::Primitive primitive;
  for (uint32_t y = 0; y < 5; ++y)
    for (uint32_t x = 0; x < 5; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      primitive.positions.emplace_back(fx, fy, 0.0F);
      primitive.texture.emplace_back(fx + fy, is_mirrored ? fx - fy : fy - fx);
      if (x + 1 < 5 && y + 1 < 5) {
        const uint32_t a = 5 * y + x;
        primitive.triangles.push_back({a, a + 1, a + 6});
        primitive.triangles.push_back({a, a + 6, a + 5});
      }
    }
  return primitive;
}

TEST(TangentsTest, AreThoseOfTheTextureCoordinates) {
  for (const bool is_mirrored : {false, true}) {
    const auto primitive = square(is_mirrored);
    const std::vector<Vec3f> normals(25, Vec3f::UnitZ());
    const Tangents tangents(primitive, primitive.positions, normals, Eigen::Matrix3f::Identity());
    std::vector<Vec4f> found;
    tangents.at(primitive.positions, primitive.positions, normals, found);
    ASSERT_EQ(found.size(), 25U);
    for (const Vec4f& tangent : found) {
      EXPECT_LT((tangent.head<3>() - Vec3f(1, 1, 0).normalized()).norm(), 1e-6F);
      EXPECT_EQ(tangent.w(), is_mirrored ? -1.0F : 1.0F);
    }
  }
}

TEST(TangentsTest, TurnAndShearWithTheSurface) {
  const auto primitive = square(false);
  const std::vector<Vec3f> normals(25, Vec3f::UnitZ());
  const Tangents tangents(primitive, primitive.positions, normals, Eigen::Matrix3f::Identity());
  // A turn about an oblique axis after a shear in the plane: (1, 1) goes to (1.5, 1).
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(0.8F, Vec3f(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3f> moved, moved_normals(25, turn * Vec3f::UnitZ());
  for (const Vec3f& p : primitive.positions)
    moved.push_back(turn * Vec3f(p.x() + 0.5F * p.y(), p.y(), 0.0F));
  std::vector<Vec4f> found;
  tangents.at(moved, primitive.positions, moved_normals, found);
  for (const Vec4f& tangent : found)
    EXPECT_LT((tangent.head<3>() - turn * Vec3f(1.5F, 1, 0).normalized()).norm(), 1e-5F);
}

TEST(TangentsTest, TheFilesOwnComeFirstAndStayAtRest) {
  auto primitive = square(false);
  primitive.tangents.assign(25, {0, 1, 0, -1});
  const std::vector<Vec3f> normals(25, Vec3f::UnitZ());
  const Tangents tangents(primitive, primitive.positions, normals, Eigen::Matrix3f::Identity());
  std::vector<Vec4f> found;
  tangents.at(primitive.positions, primitive.positions, normals, found);
  for (const Vec4f& tangent : found)
    EXPECT_EQ(tangent, Vec4f(0, 1, 0, -1));
}

TEST(TangentsTest, NoneWithoutEither) {
  auto primitive = square(false);
  primitive.texture.clear();
  const std::vector<Vec3f> normals(25, Vec3f::UnitZ());
  const Tangents tangents(primitive, primitive.positions, normals, Eigen::Matrix3f::Identity());
  std::vector<Vec4f> found(3);
  tangents.at(primitive.positions, primitive.positions, normals, found);
  EXPECT_TRUE(found.empty());
}

TEST(TangentsTest, WithoutAreaThereIsStillATangent) {
  auto primitive = square(false);
  primitive.texture.assign(25, {0.5F, 0.5F});
  const std::vector<Vec3f> normals(25, Vec3f::UnitZ());
  const Tangents tangents(primitive, primitive.positions, normals, Eigen::Matrix3f::Identity());
  std::vector<Vec3f> flat(25, Vec3f::Zero());  // and no triangle has an area
  std::vector<Vec4f> found;
  tangents.at(flat, primitive.positions, normals, found);
  for (const Vec4f& tangent : found) {
    EXPECT_NEAR(tangent.head<3>().norm(), 1.0F, 1e-5F);
    EXPECT_NEAR(tangent.z(), 0.0F, 1e-6F);
  }
}

}  // namespace
