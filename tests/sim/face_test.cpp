#include "sim/reference_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

using testing::add_fibre;
using testing::column_at;
using testing::make_patch;
using testing::PatchOptions;

std::vector<Vec3f> displacements_of(const ReferenceSolver& face) {
  std::vector<Vec3f> out(face.model().rest().size());
  face.displacements(out);
  return out;
}

double largest(const std::vector<Vec3f>& values) {
  double most = 0.0;
  for (const Vec3f& v : values)
    most = std::max<double>(most, v.norm());
  return most;
}

/// A lattice of `columns` columns without any element; tests add what they study.
rig::TissueLevel bare(uint32_t columns) {
  rig::TissueLevel level;
  level.columns = columns;
  level.rest.assign(3 * columns, rig::Vec3f::Zero());
  level.kinds.assign(3 * columns, rig::NodeKind::fixed);
  level.masses.assign(3 * columns, 1.0F);
  level.jaw_weights.assign(3 * columns, 0.0F);
  level.skin_bending.assign(columns, 0.0F);
  level.smas_bending.assign(columns, 0.0F);
  for (uint32_t i = 0; i < 3 * columns; ++i)
    level.rest[i].x() = 0.1F * static_cast<float>(i);
  return level;
}

void add_spring(rig::TissueLevel& level, uint32_t a, uint32_t b, float stiffness) {
  level.spring_nodes.push_back({a, b});
  level.spring_stiffness.push_back(stiffness);
  level.spring_limit_strain.push_back(std::numeric_limits<float>::infinity());
  level.spring_second_stiffness.push_back(stiffness);
  level.spring_one_sided.push_back(0);
}

FaceModelOptions undamped(double substep) {
  FaceModelOptions options;
  options.substep = substep;
  options.stiffness_damping = 0.0;
  options.mass_damping = 0.0;
  return options;
}

/// Mean period of node `node` about the place `middle` along `axis`, from its upward crossings.
double period_of(ReferenceSolver& face, uint32_t node, int axis, double middle, double step, int steps,
                 const Controls& drive) {
  double first = -1.0, last = -1.0, before = face.state()[node][axis] - middle;
  int crossings = 0;
  StepOptions options;
  options.solver = {50, 1e-12};
  options.largest_displacement = 10.0;
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(face.step(step, drive, options).status, StepStatus::done);
    const double now = face.state()[node][axis] - middle;
    if (before < 0.0 && now >= 0.0) {
      last = (i + before / (before - now)) * step;
      if (first < 0.0)
        first = last;
      else
        ++crossings;
    }
    before = now;
  }
  return (last - first) / crossings;
}

TEST(ReferenceSolver, SpringSwingsAtTheSquareRootOfStiffnessOverMass) {
  rig::TissueLevel level = bare(1);
  level.kinds[1] = rig::NodeKind::free;
  level.masses[1] = 0.5F;
  add_spring(level, 0, 1, 20.0F);  // omega = sqrt(40)
  const double step = 2e-4;
  const FaceModel model(lattice_of(level), {}, undamped(step));
  ASSERT_TRUE(model.valid()) << model.fault();
  ReferenceSolver face(model, 0);
  face.velocities()[1] = Vec3(0.05, 0, 0);
  const double period = period_of(face, 1, 0, 0.1, step, 20000, {});
  EXPECT_NEAR(period * std::sqrt(40.0) / (2 * M_PI), 1.0, 2e-3);
}

TEST(ReferenceSolver, PendulumSwingsAtTheSquareRootOfLengthOverGravity) {
  rig::TissueLevel level = bare(1);
  level.rest[1] = rig::Vec3f(0, -0.25F, 0);
  level.kinds[1] = rig::NodeKind::free;
  add_spring(level, 0, 1, 2e5F);
  const double step = 5e-4;
  const FaceModel model(lattice_of(level), {}, undamped(step));
  ASSERT_TRUE(model.valid());
  ReferenceSolver face(model, 0);
  face.velocities()[1] = Vec3(0.05, 0, 0);  // amplitude of 2 degrees
  Controls gravity;
  gravity.acceleration = Vec3(0, -9.81, 0);
  const double period = period_of(face, 1, 0, 0.0, step, 12000, gravity);
  EXPECT_NEAR(period / (2 * M_PI * std::sqrt(0.25 / 9.81)), 1.0, 3e-3);
}

/// A strip of membrane pulled at one end by a known force, sides free.
TEST(ReferenceSolver, PulledStripStretchesByForceOverWidthTimesModulus) {
  PatchOptions o;
  o.across = 24;
  o.along = 4;
  o.retinacula = 0.0F;
  o.volume = 0.0F;
  o.tether_normal = 0.0F;
  o.tether_tangential = 0.0F;
  o.clamp_rim = false;
  rig::TissueLevel level = make_patch(o);
  const uint32_t columns = level.columns;
  for (uint32_t i = 0; i < 3 * columns; ++i) {
    level.rest[i].z() = 0.0F;
    level.kinds[i] = i < columns ? rig::NodeKind::free : rig::NodeKind::fixed;
  }
  for (uint32_t j = 0; j <= o.along; ++j)
    level.kinds[column_at(o, 0, j)] = rig::NodeKind::fixed;
  // Gravity on the end row alone is the pull: the rest of the strip weighs almost nothing.
  for (uint32_t c = 0; c < columns; ++c)
    level.masses[c] = 1e-12F;
  for (uint32_t j = 0; j <= o.along; ++j)
    level.masses[column_at(o, o.across, j)] = (j == 0 || j == o.along) ? 0.5e-3F : 1e-3F;
  const FaceModel model(lattice_of(level), {});
  ASSERT_TRUE(model.valid()) << model.fault();
  ReferenceSolver face(model, 0);
  Controls pull;
  pull.acceleration = Vec3(1, 0, 0);
  std::vector<Vec3f> x(3 * columns);
  PoseOptions options;
  options.solver = {2000, 1e-10};
  EXPECT_TRUE(face.static_pose(pull, options, x).converged);
  // Between two sections away from the ends: strain = F / (width E h), F = 4 mN.
  const double strain_expected = 4e-3 / (4 * 0.005 * 20.0);
  const auto section = [&](uint32_t i) {
    double sum = 0.0;
    for (uint32_t j = 0; j <= o.along; ++j)
      sum += x[column_at(o, i, j)].x() - level.rest[column_at(o, i, j)].x();
    return sum / (o.along + 1);
  };
  EXPECT_NEAR((section(18) - section(6)) / (12 * 0.005) / strain_expected, 1.0, 0.02);
}

TEST(ReferenceSolver, PressedBlockKeepsItsVolume) {
  PatchOptions o;
  o.volume = 2e5F;
  rig::TissueLevel level = make_patch(o);
  const FaceModel model(lattice_of(level), {});
  ASSERT_TRUE(model.valid());
  ReferenceSolver face(model, 0);
  Controls press;
  press.acceleration = Vec3(0, 0, -300.0);
  std::vector<Vec3f> x(level.rest.size());
  const MinimiseResult result = face.static_pose(press, {}, x);
  EXPECT_TRUE(result.converged);
  Positions p;
  for (const Vec3f& v : x)
    p.push_back(v.cast<double>());
  double before = 0.0, after = 0.0, moved = 0.0;
  for (const Prism& prism : model.prisms()) {
    before += prism.volume;
    after += prism_volume(prism.nodes, p.data());
  }
  for (size_t i = 0; i < p.size(); ++i)
    moved = std::max(moved, (p[i] - model.rest()[i]).norm());
  EXPECT_GT(moved, 1e-4);
  EXPECT_NEAR(after / before, 1.0, 0.01);
}

struct Contracting : ::testing::Test {
  PatchOptions options;
  rig::TissueLevel level;
  Contracting() {
    options.across = 12;
    options.along = 8;
    level = make_patch(options);
    add_fibre(level, options, 0, 4, 1, 5, 0.4F);
    add_fibre(level, options, 1, 4, 11, 7, 0.4F);
    for (size_t i = 0; i < level.rest.size(); ++i)
      level.jaw_weights[i] = level.rest[i].y() < 0 ? std::min(1.0F, -level.rest[i].y() * 60.0F) : 0.0F;
    jaw.origin = Vec3(0, 0.05, -0.08);
    jaw.open_angle = 0.1;
  }
  Jaw jaw = jaw_of(rig::JawJoint{});
};

TEST_F(Contracting, RestIsExactlyAnEquilibrium) {
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 2);
  std::vector<Vec3f> x(level.rest.size());
  EXPECT_EQ(face.static_pose({}, {}, x).iterations, 0);
  for (size_t i = 0; i < x.size(); ++i)
    EXPECT_EQ(x[i], level.rest[i]);
  for (int i = 0; i < 30; ++i)
    face.step(1.0 / 47.0, {});
  EXPECT_EQ(largest(displacements_of(face)), 0.0);
}

TEST_F(Contracting, AFibrePullsItsEndTowardsItsOriginAndMirrors) {
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 2);
  std::vector<Vec3f> left(level.rest.size()), right(level.rest.size());
  const float first[] = {1.0F, 0.0F}, second[] = {0.0F, 1.0F};
  PoseOptions tight;
  tight.solver = {400, 1e-9};
  EXPECT_TRUE(face.static_pose({first, {}, Vec3::Zero()}, tight, left).converged);
  EXPECT_TRUE(face.static_pose({second, {}, Vec3::Zero()}, tight, right).converged);
  const uint32_t end = level.columns + column_at(options, 5, 4);
  const float travel = left[end].x() - level.rest[end].x();
  EXPECT_LT(travel, -0.001F);
  double asymmetry = 0.0;
  for (uint32_t layer = 0; layer < 3; ++layer)
    for (uint32_t j = 0; j <= options.along; ++j)
      for (uint32_t i = 0; i <= options.across; ++i) {
        const uint32_t a = layer * level.columns + column_at(options, i, j);
        const uint32_t b = layer * level.columns + column_at(options, options.across - i, j);
        Vec3f mirrored = right[b] - level.rest[b];
        mirrored.x() = -mirrored.x();
        asymmetry = std::max<double>(asymmetry, (left[a] - level.rest[a] - mirrored).norm());
      }
  EXPECT_LT(asymmetry, 1e-4 * -travel);
}

TEST_F(Contracting, NoFibreShortensBeyondItsShortest) {
  level.fibre_strength.assign(2, 500.0F);
  level.fibre_shortest.assign(2, 0.7F);
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 2);
  std::vector<Vec3f> x(level.rest.size());
  const float both[] = {1.0F, 1.0F};
  face.static_pose({both, {}, Vec3::Zero()}, {}, x);
  const uint32_t end = level.columns + column_at(options, 5, 4);
  const double length = (level.fibre_rest[4] - level.fibre_rest[0]).norm();
  const double travel = (level.rest[end] - x[end]).x();
  EXPECT_GT(travel, 0.2 * length);
  EXPECT_LT(travel, 0.301 * length);
}

TEST_F(Contracting, SteppingArrivesAtTheStaticPoseAtAnyFrameRate) {
  const FaceModel model(lattice_of(level), jaw);
  const float pull[] = {1.0F, 0.3F};
  const Controls drive{pull, {1.0F, 0, 0}, Vec3::Zero()};
  ReferenceSolver face(model, 2);
  std::vector<Vec3f> pose(level.rest.size());
  ASSERT_TRUE(face.static_pose(drive, {}, pose).converged);
  const double size = largest([&] {
    auto d = pose;
    for (size_t i = 0; i < d.size(); ++i)
      d[i] -= level.rest[i];
    return d;
  }());
  // 0.1 s after a jump from 0 to 1 in a ramp of one 30 Hz frame, and after two seconds.
  std::vector<std::vector<Vec3f>> early, late;
  for (const int rate : {30, 60, 120, 75}) {
    ReferenceSolver moving(model, 2);
    for (int frame = 1; frame <= 2 * rate; ++frame) {
      const float share = std::min(1.0F, static_cast<float>(frame) * 30.0F / static_cast<float>(rate));
      const float now[] = {pull[0] * share, pull[1] * share};
      ASSERT_EQ(moving.step(1.0 / rate, {now, {share, 0, 0}, Vec3::Zero()}).status, StepStatus::done);
      if (frame == rate / 5) early.push_back(displacements_of(moving));
    }
    late.push_back(displacements_of(moving));
  }
  const auto apart = [&](const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    double most = 0.0;
    for (size_t i = 0; i < a.size(); ++i)
      most = std::max<double>(most, (a[i] - b[i]).norm());
    return most / size;
  };
  for (size_t k = 1; k < early.size(); ++k)
    EXPECT_LT(apart(early[0], early[k]), 0.02) << k;
  for (size_t i = 0; i < pose.size(); ++i)
    pose[i] -= level.rest[i];
  for (const auto& l : late)
    EXPECT_LT(apart(l, pose), 0.02);
}

TEST_F(Contracting, EnergyOfAReleasedFaceDecreasesMonotonically) {
  FaceModelOptions immediate;
  immediate.dynamics = {0.0, 0.0};
  const FaceModel model(lattice_of(level), jaw, immediate);
  ReferenceSolver face(model, 2);
  const float pull[] = {1.0F, 1.0F}, none[] = {0.0F, 0.0F};
  face.settle({pull, {}, Vec3::Zero()});
  StepOptions stepping;
  stepping.solver = {100, 1e-8};
  face.step(1.0 / 120, {none, {}, Vec3::Zero()}, stepping);
  double energy = face.total_energy();
  const double begin = energy;
  for (int i = 0; i < 60; ++i) {
    face.step(1.0 / 120, {none, {}, Vec3::Zero()}, stepping);
    const double now = face.total_energy();
    EXPECT_LE(now, energy + 1e-9 * begin);
    energy = now;
  }
  EXPECT_LT(energy, 0.01 * begin);
}

TEST_F(Contracting, AbruptAndRandomActivationsStayFinite) {
  level.fibre_strength.assign(2, 5.0F);
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 2);
  uint32_t state = 1;
  for (int i = 0; i < 120; ++i) {
    state = state * 1664525U + 1013904223U;
    const float wild[] = {static_cast<float>(state >> 31), static_cast<float>((state >> 30) & 1U)};
    const StepResult result =
        face.step(1.0 / 60, {wild, {static_cast<float>((state >> 29) & 1U), 0, 0}, Vec3::Zero()});
    EXPECT_EQ(result.status, StepStatus::done);
  }
  EXPECT_LT(largest(displacements_of(face)), 0.05);
}

TEST_F(Contracting, TheWatchdogResetsAndReports) {
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 2);
  face.velocities()[level.columns + column_at(options, 5, 4)] = Vec3(1e6, 0, 0);
  EXPECT_EQ(face.step(1.0 / 60, {}).status, StepStatus::reset);
  EXPECT_EQ(largest(displacements_of(face)), 0.0);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), 0.0F};
  EXPECT_EQ(face.step(1.0 / 60, {bad, {}, Vec3::Zero()}).status, StepStatus::reset);
  EXPECT_EQ(face.step(1.0 / 60, {}).status, StepStatus::done);
}

TEST(Activation, RisesByItsTimeConstantForAnyStep) {
  const ActivationDynamics dynamics{0.03, 0.05};
  const float one[] = {1.0F}, zero[] = {0.0F};
  float coarse[] = {0.0F}, fine[] = {0.0F};
  follow(dynamics, 0.03, one, coarse);
  for (int i = 0; i < 30; ++i)
    follow(dynamics, 0.001, one, fine);
  EXPECT_NEAR(coarse[0], 1.0 - std::exp(-1.0), 1e-6);
  EXPECT_NEAR(fine[0], coarse[0], 1e-5);
  follow(dynamics, 0.05, zero, coarse);
  EXPECT_NEAR(coarse[0], (1.0 - std::exp(-1.0)) * std::exp(-1.0), 1e-6);
}

}  // namespace
}  // namespace fascia::sim
