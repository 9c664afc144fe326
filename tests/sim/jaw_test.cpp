#include "sim/jaw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fascia::sim {
namespace {

Jaw adult_jaw() {
  Jaw jaw;
  jaw.open_angle = 0.436;
  jaw.open_glide = Vec3(0, -0.006, 0.008);
  jaw.forward_glide = 0.008;
  jaw.forward_drop = jaw.lateral_glide = 0.003;
  jaw.lateral_angle = 0.14;
  return jaw;
}

TEST(Jaw, OpensDownAndBackAboutTheCondyles) {
  Jaw jaw = adult_jaw();
  jaw.open_glide.setZero();
  const Vec3 chin(0, -0.06, 0.09);
  const Vec3 moved = jaw_transform(jaw, {1.0F, 0, 0}) * chin;
  const double c = std::cos(0.436), s = std::sin(0.436);
  EXPECT_NEAR(moved.y(), -0.06 * c - 0.09 * s, 1e-12);
  EXPECT_NEAR(moved.z(), 0.09 * c - 0.06 * s, 1e-12);
  EXPECT_NEAR((jaw_transform(jaw, {1.0F, 0, 0}) * jaw.origin - jaw.origin).norm(), 0.0, 1e-15);
}

TEST(Jaw, CondylesGlideByTheGivenLengths) {
  Jaw jaw = adult_jaw();
  jaw.origin = Vec3(0, 0.01, -0.02);
  const Vec3 glided = jaw_transform(jaw, {1.0F, 0, 0}) * jaw.origin - jaw.origin;
  EXPECT_NEAR((glided - Vec3(0, -0.006, 0.008)).norm(), 0.0, 1e-12);
  const Vec3 forward = jaw_transform(jaw, {0, 1.0F, 0}) * jaw.origin - jaw.origin;
  EXPECT_NEAR((forward - Vec3(0, -0.003, 0.008)).norm(), 0.0, 1e-12);
}

TEST(Jaw, LateralIsToTheSubjectsLeftAndMirrors) {
  const Jaw jaw = adult_jaw();
  const Vec3 chin(0, -0.06, 0.09);
  const Vec3 left = jaw_transform(jaw, {0.2F, 0, 1.0F}) * chin,
             right = jaw_transform(jaw, {0.2F, 0, -1.0F}) * chin;
  EXPECT_GT(left.x(), 0.01);
  EXPECT_NEAR(left.x(), -right.x(), 1e-12);
  EXPECT_NEAR((left - right).tail<2>().norm(), 0.0, 1e-12);
}

TEST(Jaw, RestIsTheIdentityAndMotionIsRigid) {
  const Jaw jaw = adult_jaw();
  const RigidTransform rest = jaw_transform(jaw, {});
  EXPECT_EQ(rest.rotation, Mat3::Identity());
  EXPECT_EQ(rest.translation, Vec3::Zero());
  EXPECT_EQ(jaw_transform(jaw, {1, 1, 1}, 0.0).rotation, Mat3::Identity());
  const RigidTransform moved = jaw_transform(jaw, {0.7F, 0.3F, -0.5F});
  EXPECT_NEAR((moved.rotation.transpose() * moved.rotation - Mat3::Identity()).norm(), 0.0, 1e-12);
}

TEST(Jaw, LimitsAreKept) {
  const JawPose far = clamped({7.0F, -2.0F, -9.0F});
  EXPECT_EQ(far, (JawPose{1.0F, 0.0F, -1.0F}));
  EXPECT_EQ(clamped({std::numeric_limits<float>::quiet_NaN(), 0, 0}), JawPose{});
}

TEST(Jaw, ChannelsTakeTheTravelTimeAtLeast) {
  JawPose pose;
  const JawPose goal{1.0F, 0.5F, -1.0F};
  for (int frame = 0; frame < 6; ++frame)
    pose = approached(pose, goal, 0.01, 0.12);
  EXPECT_NEAR(pose.open, 0.5F, 1e-6F);
  EXPECT_NEAR(pose.forward, 0.5F, 1e-6F);
  EXPECT_NEAR(pose.lateral, -0.5F, 1e-6F);
  EXPECT_EQ(approached(pose, goal, 1.0, 0.12), goal);
  EXPECT_EQ(approached(pose, goal, 0.0, 0.0), goal) << "no travel time: at once";
  Jaw jaw = adult_jaw();
  EXPECT_EQ(jaw_fault(jaw), nullptr);
  jaw.travel_time = 11.0;
  EXPECT_NE(jaw_fault(jaw), nullptr);
  jaw.travel_time = -0.1;
  EXPECT_NE(jaw_fault(jaw), nullptr);
}

}  // namespace
}  // namespace fascia::sim
