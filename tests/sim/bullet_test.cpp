#include "sim/bullet/bullet_face.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/reference_solver.h"
#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

struct Compared {
  double apart = 0.0, size = 0.0;
};

Compared compare(const rig::TissueLevel& level, const Jaw& jaw, const Controls& drive, size_t channels) {
  const FaceModel model(lattice_of(level), jaw);
  EXPECT_TRUE(model.valid()) << model.fault();
  ReferenceSolver own(model, channels);
  BulletFace bullet(model, channels);
  std::vector<Vec3f> a(level.rest.size()), b(a);
  PoseOptions options;
  options.solver = {1000, 1e-8};
  EXPECT_TRUE(own.static_pose(drive, options, a).converged);
  bullet.settle(drive);
  bullet.displacements(b);
  Compared result;
  for (size_t i = 0; i < a.size(); ++i) {
    result.apart = std::max<double>(result.apart, (a[i] - level.rest[i] - b[i]).norm());
    result.size = std::max<double>(result.size, (a[i] - level.rest[i]).norm());
  }
  return result;
}

TEST(Bullet, ASpringLatticeHangsAsOurs) {
  testing::PatchOptions o;
  o.membrane = 0.0F;
  o.bending = 0.0F;
  o.volume = 0.0F;
  o.tether_normal = 0.0F;
  o.tether_tangential = 0.0F;
  o.retinacula = 4.0F;
  const rig::TissueLevel level = testing::make_patch(o);
  const Compared c = compare(level, {}, {{}, {}, Vec3(20, 0, 60)}, 0);
  EXPECT_GT(c.size, 5e-4);
  EXPECT_LT(c.apart, 5e-4);
  EXPECT_LT(c.apart, 0.15 * c.size);
}

TEST(Bullet, AFullPatchUnderLargeStrainMovesAsOurs) {
  testing::PatchOptions o;
  rig::TissueLevel level = testing::make_patch(o);
  testing::add_fibre(level, o, 0, 4, 1, 5, 0.3F);
  for (size_t i = 0; i < level.rest.size(); ++i) {
    level.jaw_weights[i] = std::clamp(0.5F - 50.0F * level.rest[i].y(), 0.0F, 1.0F);
    if (level.kinds[i] == rig::NodeKind::fixed_cranium && level.jaw_weights[i] > 0)
      level.kinds[i] = rig::NodeKind::fixed_mandible;
  }
  Jaw jaw = jaw_of(rig::JawJoint{});
  jaw.origin = Vec3(0, 0.05, -0.08);
  jaw.open_angle = 0.05;
  jaw.open_glide.setZero();
  const float pull[] = {1.0F};
  const Compared c = compare(level, jaw, {pull, {1.0F, 0, 0}, Vec3::Zero()}, 1);
  EXPECT_GT(c.size, 1e-3);
  EXPECT_LT(c.apart, 5e-4);
}

TEST(Bullet, ItsMandibleAgreesWithTheClosedForm) {
  const rig::TissueLevel level = testing::make_patch({});
  Jaw jaw = jaw_of(rig::JawJoint{});
  jaw.origin = Vec3(0, 0.01, -0.02);
  const FaceModel model(lattice_of(level), jaw);
  BulletFace face(model, 0);
  const JawPose pose{0.8F, 0.3F, -0.5F};
  for (int i = 0; i < 12; ++i)
    EXPECT_EQ(face.step(1.0 / 60, {{}, pose, Vec3::Zero()}).status, StepStatus::done);
  const Vec3 chin(0, -0.07, 0.09);
  EXPECT_LT((face.mandible() * chin - jaw_transform(jaw, pose) * chin).norm(), 1e-4);
}

TEST(Bullet, RestStaysAtRest) {
  const rig::TissueLevel level = testing::make_patch({});
  const FaceModel model(lattice_of(level), {});
  BulletFace face(model, 0);
  face.step(0.1, {});
  std::vector<Vec3f> x(level.rest.size());
  face.displacements(x);
  for (const Vec3f& moved : x)
    EXPECT_LT(moved.norm(), 1e-6F);
}

}  // namespace
}  // namespace fascia::sim
