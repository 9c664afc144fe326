// What a solver of soft tissue has to show beside its gradients: order of convergence, kept volume, strain, a
// jaw that its muscles move, and a long wild drive.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "sim/jaw_muscles.h"
#include "sim/reference_solver.h"
#include "sim/strain.h"
#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

using testing::add_fibre;
using testing::column_at;
using testing::make_patch;
using testing::PatchOptions;

/// One node of 0.5 kg on a spring of 20 N/m, 0.1 m long, let go at 5 cm/s: x(t) = 0.1 + v/w sin(w t).
double miss_of_a_spring(double step) {
  rig::TissueLevel level;
  level.columns = 1;
  level.rest = {rig::Vec3f(0, 0, 0), rig::Vec3f(0.1F, 0, 0), rig::Vec3f(0.2F, 0, 0)};
  level.kinds = {rig::NodeKind::fixed, rig::NodeKind::free, rig::NodeKind::fixed};
  level.masses = {1, 0.5F, 1};
  level.jaw_weights = {0, 0, 0};
  level.skin_bending = level.smas_bending = {0};
  level.spring_nodes.push_back({0, 1});
  level.spring_stiffness.push_back(20.0F);
  level.spring_limit_strain.push_back(10.0F);
  level.spring_second_stiffness.push_back(20.0F);
  level.spring_one_sided.push_back(0);
  FaceModelOptions options;
  options.substep = step;
  options.stiffness_damping = options.mass_damping = 0.0;
  const FaceModel model(lattice_of(level), {}, options);
  ReferenceSolver face(model, 0);
  face.velocities()[1] = Vec3(0.05, 0, 0);
  StepOptions stepping;
  stepping.solver = {50, 1e-13};
  stepping.largest_displacement = 1.0;
  const int steps = static_cast<int>(std::lround(0.2 / step));
  for (int i = 0; i < steps; ++i)
    face.step(step, {}, stepping);
  const double omega = std::sqrt(40.0);
  return std::abs(face.state()[1].x() - 0.1 - 0.05 / omega * std::sin(0.2 * omega));
}

TEST(Proofs, HalvingTheStepHalvesTheError) {
  const double coarse = miss_of_a_spring(0.004), middle = miss_of_a_spring(0.002),
               fine = miss_of_a_spring(0.001);
  EXPECT_NEAR(std::log2(coarse / middle), 1.0, 0.1);
  EXPECT_NEAR(std::log2(middle / fine), 1.0, 0.05);
}

/// A block of the two layers of a wide patch on a plate, pressed evenly: it gives by force over stiffness of
/// its springs.
TEST(Proofs, PressedBlockGivesByForceOverStiffness) {
  PatchOptions o;
  o.clamp_rim = false;
  o.membrane = 1e-4F;
  o.bending = 0.0F;
  o.volume = 0.0F;
  o.tether_normal = o.tether_tangential = 0.0F;
  o.retinacula = 0.0F;
  rig::TissueLevel level = make_patch(o);
  const uint32_t columns = level.columns;
  for (uint32_t c = 0; c < columns; ++c)
    for (uint32_t layer = 0; layer < 3; ++layer)
      level.rest[layer * columns + c].z() = -0.004F * static_cast<float>(layer);
  for (uint32_t c = 0; c < columns; ++c)
    for (uint32_t layer = 0; layer < 2; ++layer) {
      level.spring_nodes.push_back({layer * columns + c, (layer + 1) * columns + c});
      level.spring_stiffness.push_back(layer == 0 ? 10.0F : 5.0F);
      level.spring_limit_strain.push_back(10.0F);
      level.spring_second_stiffness.push_back(10.0F);
      level.spring_one_sided.push_back(0);
    }
  const FaceModel model(lattice_of(level), {});
  ASSERT_TRUE(model.valid()) << model.fault();
  ReferenceSolver face(model, 0);
  std::vector<NodeForce> press;
  for (uint32_t c = 0; c < columns; ++c)
    press.push_back({c, Vec3(0, 0, -0.002)});
  std::vector<Vec3f> x(level.rest.size());
  PoseOptions tight;
  tight.solver = {500, 1e-9};
  EXPECT_TRUE(face.static_pose({{}, {}, Vec3::Zero(), press}, tight, x).converged);
  const uint32_t middle = column_at(o, 4, 4);
  EXPECT_NEAR(level.rest[middle].z() - x[middle].z(), 0.002 * (1 / 10.0 + 1 / 5.0), 1e-6);
  EXPECT_NEAR(level.rest[columns + middle].z() - x[columns + middle].z(), 0.002 / 5.0, 1e-6);
}

TEST(Proofs, AContractedMuscleBulgesAtKeptVolume) {
  PatchOptions o;
  o.across = 12;
  o.volume = 2e5F;
  rig::TissueLevel level = make_patch(o);
  for (uint32_t j = 3; j <= 5; ++j)
    add_fibre(level, o, 0, j, 2, 10, 0.3F);
  const FaceModel model(lattice_of(level), {});
  ReferenceSolver face(model, 1);
  std::vector<Vec3f> x(level.rest.size());
  const float full[] = {1.0F};
  EXPECT_TRUE(face.static_pose({full, {}, Vec3::Zero()}, {}, x).converged);
  Positions p;
  for (const Vec3f& v : x)
    p.push_back(v.cast<double>());
  double before = 0.0, after = 0.0;
  for (const Prism& prism : model.prisms()) {
    before += prism.volume;
    after += prism_volume(prism.nodes, p.data());
  }
  EXPECT_NEAR(after / before, 1.0, 0.01);
  const uint32_t end = level.columns + column_at(o, 10, 4), belly = column_at(o, 5, 4);
  EXPECT_LT(x[end].x() - level.rest[end].x(), -0.001F);      // shorter by a millimetre and more
  EXPECT_GT(x[belly].z() - level.rest[belly].z(), 0.0001F);  // and thicker over its belly
}

TEST(Proofs, StrainIsThatOfTheStretch) {
  PatchOptions o;
  const rig::TissueLevel level = make_patch(o);
  const FaceModel model(lattice_of(level), {});
  std::vector<Vec3f> u(level.rest.size(), Vec3f::Zero());
  std::vector<Strain> strain(level.columns);
  skin_strain(model, u, strain);
  for (const Strain& s : strain)
    EXPECT_TRUE(s.isZero(0.0F));
  for (size_t i = 0; i < u.size(); ++i)
    u[i] = Vec3f(-0.2F * level.rest[i].x(), 0.1F * level.rest[i].y(), 0.0F);
  skin_strain(model, u, strain);
  const Vec3f compression = strongest_compression(strain[column_at(o, 4, 4)]);  // at the dome's top, flat
  EXPECT_NEAR(compression.x(), 0.2F, 0.01F);
  EXPECT_NEAR(compression.y(), 0.0F, 0.01F);
  // A turn is no strain.
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(0.7F, Vec3f(1, 2, 3).normalized()).toRotationMatrix();
  for (size_t i = 0; i < u.size(); ++i)
    u[i] = turn * level.rest[i] - level.rest[i];
  skin_strain(model, u, strain);
  for (const Strain& s : strain)
    EXPECT_LT(s.norm(), 1e-4F);
}

TEST(JawMuscles, OpenersOpenClosersCloseAndOneSidePullsAcross) {
  Jaw jaw = jaw_of(rig::JawJoint{});
  jaw.origin = Vec3(0, 0, 0);  // condyles at x = +-50 mm
  const std::vector<JawMuscle> muscles = {
      {0, Vec3(0.01, -0.10, 0.04), Vec3(0.01, -0.05, 0.08), 20},    // digastric, left
      {1, Vec3(-0.01, -0.10, 0.04), Vec3(-0.01, -0.05, 0.08), 20},  // right
      {2, Vec3(0.055, 0.01, 0.04), Vec3(0.045, -0.05, 0.02), 150},  // masseter, left
      {3, Vec3(-0.055, 0.01, 0.04), Vec3(-0.045, -0.05, 0.02), 150},
      {4, Vec3(0.03, 0.0, 0.035), Vec3(0.05, 0.0, 0.0),
       60},  // lateral pterygoid, left: to the condyle's neck
      {5, Vec3(-0.03, 0.0, 0.035), Vec3(-0.05, 0.0, 0.0), 60}};
  const JawMuscles moves(jaw, muscles);
  const auto at = [&](std::vector<float> a, JawPose pose = {}) { return moves.moved(pose, a); };
  EXPECT_TRUE(at({0, 0, 0, 0, 0, 0}).at_rest());
  EXPECT_GT(at({1, 1, 0, 0, 1, 1}).open, 0.9F);
  EXPECT_NEAR(at({1, 1, 0, 0, 1, 1}).lateral, 0.0F, 1e-4F);
  EXPECT_EQ(at({1, 1, 1, 1, 0, 0}).open, 0.0F);
  EXPECT_LT(at({0, 0, 0.2F, 0.2F, 0, 0}, {0.8F, 0, 0}).open, 0.5F);
  EXPECT_GT(at({0, 0, 0, 0, 1, 1}).forward, 0.9F);
  EXPECT_LT(at({0, 0, 0, 0, 1, 0}).lateral, -0.3F);  // the left one takes the chin to the right
  EXPECT_NEAR(at({0, 0, 0, 0, 1, 0}).lateral, -at({0, 0, 0, 0, 0, 1}).lateral, 1e-3F);
}

TEST(Proofs, RandomActivationInvertsNoPrism) {
  PatchOptions o;
  o.across = 10;
  rig::TissueLevel level = make_patch(o);
  add_fibre(level, o, 0, 4, 1, 5, 0.4F);
  add_fibre(level, o, 1, 4, 9, 5, 0.4F);
  add_fibre(level, o, 2, 6, 2, 8, 0.4F);
  for (size_t i = 0; i < level.rest.size(); ++i)
    level.jaw_weights[i] = level.rest[i].y() < 0 ? std::min(1.0F, -level.rest[i].y() * 60.0F) : 0.0F;
  Jaw jaw = jaw_of(rig::JawJoint{});
  jaw.origin = Vec3(0, 0.05, -0.08);
  jaw.open_angle = 0.1;
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 3);
  std::mt19937 random(7);
  const auto chance = [&] { return static_cast<float>(random() % 1000U) / 999.0F; };
  float drive[3] = {0, 0, 0};
  JawPose pose;
  for (int frame = 0; frame < 12 * 30; ++frame) {
    if (frame % 7 == 0) {
      for (float& value : drive)
        value = chance() < 0.3F ? 1.0F : chance() < 0.5F ? 0.0F : chance();
      pose = {chance(), 0.3F * chance(), 0.4F * chance() - 0.2F};
    }
    const Vec3 shake(40 * chance() - 20, 40 * chance() - 20, 40 * chance() - 20);
    ASSERT_EQ(face.step(1.0 / 30, {drive, pose, shake}).status, StepStatus::done) << frame;
    for (const Prism& prism : model.prisms())
      ASSERT_GT(prism_volume(prism.nodes, face.state().data()), 0.0) << frame;
  }
}

}  // namespace
}  // namespace fascia::sim
