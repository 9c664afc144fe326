#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/reference_solver.h"
#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

/// A patch on two bones with two fibres, carriers, a pressure and an eyeball, bent far from rest: what a face
/// has.
struct Patch {
  testing::PatchOptions options;
  rig::TissueLevel level;
  Jaw jaw = jaw_of(rig::JawJoint{});
  Patch() : level(testing::make_patch(options)) {
    testing::add_fibre(level, options, 0, 4, 1, 5, 0.3F);
    testing::add_fibre(level, options, 1, 2, 7, 3, 0.2F);
    for (uint32_t i = 2; i < 6; ++i) {
      const uint32_t column = testing::column_at(options, i, 6);
      testing::add_carrier(level, 2, column, rig::Vec3f(0, 0.02F, -0.02F), 0.2F, -0.1F);
    }
    for (uint32_t c = 0; c < level.columns; ++c)
      if (level.kinds[level.columns + c] == rig::NodeKind::free)
        level.kinds[2 * level.columns + c] = rig::NodeKind::mucosa;
    for (uint32_t t = 40; t < 60; ++t) {
      level.pressure_channel.push_back(3);
      level.pressure_prism.push_back(t);
      level.pressure.push_back(200.0F);
    }
    for (size_t i = 0; i < level.rest.size(); ++i) {
      level.jaw_weights[i] = level.rest[i].y() < 0 ? std::min(1.0F, -level.rest[i].y() * 60.0F) : 0.0F;
      if (level.kinds[i] == rig::NodeKind::fixed && level.rest[i].y() < -0.019F)
        level.kinds[i] = rig::NodeKind::fixed_mandible;
    }
    jaw.origin = Vec3(0, 0.05, -0.08);
    jaw.open_angle = 0.1;
  }
};

TEST(Adjoint, GradientsMatchDifferencesOfThePose) {
  const Patch patch;
  const FaceModel model(lattice_of(patch.level), patch.jaw);
  ASSERT_TRUE(model.valid()) << model.fault();
  ReferenceSolver face(model, 4);
  PoseOptions tight;
  tight.solver = {400, 1e-10};
  const size_t nodes = patch.level.rest.size();
  Positions slope(nodes);
  for (size_t i = 0; i < nodes; ++i)
    slope[i] = Vec3(std::sin(0.7 * static_cast<double>(i)), std::cos(1.3 * static_cast<double>(i)), 0.5);
  std::vector<float> at = {0.6F, 0.4F, 0.5F, 0.3F};
  JawPose jaw{0.3F, 0.2F, 0.1F};
  const auto loss = [&] {
    std::vector<Vec3f> ignored(nodes);
    EXPECT_TRUE(face.static_pose({at, jaw, Vec3::Zero()}, tight, ignored).converged);
    double sum = 0.0;
    for (size_t i = 0; i < nodes; ++i)
      sum += slope[i].dot(face.pose()[i]);
    return sum;
  };
  loss();
  std::vector<double> by_channel(4);
  std::array<double, 3> by_jaw{};
  const AdjointResult result = face.static_gradient({at, jaw, Vec3::Zero()}, slope, by_channel, by_jaw);
  EXPECT_TRUE(result.converged) << result.residual;
  const auto difference = [&](float& value) {
    const float middle = value, step = 4e-3F;
    value = middle + step;
    const double ahead = loss();
    const float high = value;
    value = middle - step;
    const double behind = loss();
    const double slope_of_it = (ahead - behind) / static_cast<double>(high - value);
    value = middle;
    return slope_of_it;
  };
  for (size_t c = 0; c < 4; ++c) {
    const double expected = difference(at[c]);
    EXPECT_GT(std::abs(expected), 1e-4) << c;  // there is something to compare
    EXPECT_NEAR(by_channel[c], expected, 3e-3 * std::abs(expected)) << c;
  }
  const double expected_jaw[] = {difference(jaw.open), difference(jaw.forward), difference(jaw.lateral)};
  for (size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(by_jaw[k], expected_jaw[k], 3e-3 * std::abs(expected_jaw[k])) << k;
}

}  // namespace
}  // namespace fascia::sim
