#include "sim/realtime/solver.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <random>
#include <thread>

#include "tests/sim/instruction_sets.h"
#include "tests/sim/patch.h"

namespace fascia::sim::realtime {
namespace {

using testing::add_fibre;
using testing::make_patch;
using testing::PatchOptions;

/// A patch with a bit of everything: fibres, a jaw, a carrier, a globe under it, pressure behind it.
struct Everything : ::testing::Test {
  PatchOptions options;
  rig::TissueLevel level;
  Jaw jaw = jaw_of(rig::JawJoint{});
  Everything() {
    options.across = 12;
    options.along = 8;
    level = make_patch(options);
    add_fibre(level, options, 0, 6, 2, 11,
              0.3F);  // longer than those it shares a batch with, and before them
    add_fibre(level, options, 0, 4, 1, 5, 0.4F);
    add_fibre(level, options, 1, 4, 11, 7, 0.4F);
    add_fibre(level, options, 1, 2, 2, 9, 0.2F);
    for (size_t i = 0; i < level.rest.size(); ++i)
      level.jaw_weights[i] = level.rest[i].y() < 0 ? std::min(1.0F, -level.rest[i].y() * 60.0F) : 0.0F;
    jaw.origin = Vec3(0, 0.05, -0.08);
    jaw.open_angle = 0.1;
    const uint32_t middle = column_at(options, 6, 5);
    level.carrier_channel = {2};
    level.carrier_node = {middle};
    level.carrier_origin = {level.rest[middle] - rig::Vec3f(0, 0, 0.012F)};
    level.carrier_axis = {rig::Vec3f(1, 0, 0)};
    level.carrier_angle = {0.5F};
    level.carrier_reverse = {0.3F};
    level.carrier_stiffness = {3.0F};
    level.carrier_drive = {4.0F};
    level.pressure_channel = {3, 3, 3};
    level.pressure_prism = {40, 41, 60};
    level.pressure = {300.0F, 300.0F, 300.0F};
    level.globe_centre = {level.rest[level.columns + middle] - rig::Vec3f(0, 0, 0.010F)};
    level.globe_radius = {0.010F};
    for (const uint32_t node : {middle, middle + 1, level.columns + middle, level.columns + middle + 1}) {
      level.globe_contact_node.push_back(node);
      level.globe_contact_globe.push_back(0);
    }
  }
  const std::vector<float> pull = {0.8F, 0.4F, 0.7F, 0.5F};
  Controls drive() const { return {pull, {0.8F, 0.2F, -0.5F}, Vec3(1, -3, 2)}; }
};

double farthest(const std::vector<Vec3f>& a, std::span<const Vec3f> b) {
  double most = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    most = std::max<double>(most, (a[i] - b[i]).norm());
  return most;
}

TEST_F(Everything, EnergyAndGradientAreTheReferences) {
  const FaceModel face(lattice_of(level), jaw);
  ASSERT_TRUE(face.valid()) << face.fault();
  const Model model(face);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  const JawPose pose{0.8F, 0.2F, -0.5F};
  Frame frame = face.make_frame();
  face.place({pull, pose, Vec3::Zero()}, frame);
  for (const double size :
       {0.0, 1e-4, 1e-3, 3e-3}) {  // the last turns some prisms over and crushes membranes
    Positions x = frame.carried, expected(x.size());
    Floats places(model.places()), gradient(model.places());
    for (const uint32_t node : face.unknowns())
      x[node] += size * Vec3(normal(random), normal(random), normal(random));
    for (size_t i = 0; i < x.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        places.data()[model.slot_of(i) + axis] = static_cast<float>(x[i][axis]);
        x[i][axis] = static_cast<double>(static_cast<float>(x[i][axis]));
      }
    const double energy = face.energy(frame, x.data(), expected.data());
    std::unique_ptr<Workspace> work = model.borrow();
    Boundary boundary = model.boundary(*work);
    std::copy(pull.begin(), pull.end(), work->values.begin());
    model.set_jaw(pose, boundary);
    model.loops().place(model.packed(), boundary);
    const double own = model.loops().energy(model.packed(), boundary, places.data(), gradient.data());
    EXPECT_NEAR(own, energy, 1e-4 * std::abs(energy) + 1e-7) << size;
    double largest = 0.0, off = 0.0;
    for (const uint32_t node : face.unknowns()) {
      const float* g = gradient.data() + model.slot_of(node);
      largest = std::max(largest, expected[node].norm());
      off = std::max(off, (expected[node] - Vec3(g[0], g[1], g[2])).norm());
    }
    EXPECT_GT(largest, 0.01);
    EXPECT_LT(off, 2e-4 * largest + 1e-5) << size;
    model.give_back(std::move(work));
  }
}

TEST_F(Everything, TheFactorSolvesItsMatrix) {
  const FaceModel face(lattice_of(level), jaw);
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix = face.stiffness();
  Positions places;
  for (const uint32_t node : face.unknowns())
    places.push_back(face.rest()[node]);
  const Dissection dissection(matrix, places);
  std::vector<uint32_t> sorted = dissection.order();
  std::sort(sorted.begin(), sorted.end());
  for (uint32_t i = 0; i < sorted.size(); ++i)
    ASSERT_EQ(sorted[i], i);
  EXPECT_GT(dissection.fronts().size(), 8U);
  PanelFactor factor;
  ASSERT_TRUE(factor.compute(dissection, matrix));
  Eigen::MatrixXd right = Eigen::MatrixXd::Random(matrix.rows(), 3);
  const Eigen::SparseMatrix<double> columns = matrix;
  const Eigen::MatrixXd expected = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>(columns).solve(right);
  for (const lanes::InstructionSet set : testing::all_instruction_sets()) {
    const Model model(face, set);
    Floats list(model.unknown_floats());
    for (size_t k = 0; k < dissection.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        list.data()[4 * k + static_cast<size_t>(axis)] =
            static_cast<float>(right(dissection.order()[k], axis));
    Floats scratch(factor.scratch());
    model.loops().solve(factor.view(), list.data(), scratch.data());
    // Fronts are rounded to eight bits, 2^-9 of each number.
    double off = 0.0, size = 0.0;
    for (size_t k = 0; k < dissection.size(); ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const double wanted = expected(dissection.order()[k], axis),
                     found = static_cast<double>(list.data()[4 * k + static_cast<size_t>(axis)]);
        off += (found - wanted) * (found - wanted);
        size += wanted * wanted;
      }
    EXPECT_LT(std::sqrt(off / size), 0.01);
  }
}

TEST_F(Everything, RestIsRestToTheLastBit) {
  const FaceModel reference(lattice_of(level), jaw);
  const Model model(reference);
  Solver face(model, 4);
  std::vector<Vec3f> x(level.rest.size());
  EXPECT_EQ(face.static_pose({}, {}, x).iterations, 0);
  for (size_t i = 0; i < x.size(); ++i)
    EXPECT_EQ(x[i], level.rest[i]);
  for (int i = 0; i < 30; ++i)
    face.step(1.0 / 47.0, {});
  face.displacements(x);
  for (const Vec3f& d : x)
    EXPECT_EQ(d, Vec3f::Zero());
}

TEST_F(Everything, PosesAreTheReferences) {
  const FaceModel reference(lattice_of(level), jaw);
  const Model model(reference);
  sim::ReferenceSolver slow(reference, 4);
  Solver fast(model, 4);
  std::vector<Vec3f> expected(level.rest.size()), pose(level.rest.size());
  ASSERT_TRUE(slow.static_pose(drive(), {}, expected).converged);
  const MinimiseResult cold = fast.static_pose(drive(), {}, pose);
  EXPECT_TRUE(cold.converged);
  EXPECT_GT(farthest(expected, level.rest), 2e-3);
  EXPECT_LT(farthest(pose, expected), 2e-5);
  PoseOptions warm;
  warm.from_last_pose = true;
  EXPECT_LT(fast.static_pose(drive(), warm, pose).iterations, cold.iterations / 2);
}

TEST_F(Everything, HessiansOfThePoseConvergeWhereTheFactorAtRestDoesNot) {
  const FaceModel reference(lattice_of(level), jaw);
  const Model model(reference);
  Solver face(model, 4);
  std::vector<Vec3f> expected(level.rest.size()), pose(level.rest.size());
  PoseOptions few;
  few.solver.iterations = 5;
  few.newton.iterations = 0;
  EXPECT_FALSE(face.static_pose(drive(), few, pose).converged);
  ASSERT_TRUE(face.static_pose(drive(), {}, expected).converged);
  EXPECT_GT(farthest(pose, expected), 1e-4);
  few.newton.iterations = 10;
  few.jaw_stage = 0.0;  // nothing but five iterations beforehand
  const MinimiseResult result = face.static_pose(drive(), few, pose);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.iterations, 5);
  EXPECT_LT(farthest(pose, expected), 2e-5);
}

TEST_F(Everything, ConvergedStepsAreTheReferencesAndFewIterationsStayNear) {
  FaceModelOptions quiet;
  quiet.contact.friction = 0.0;  // what has slipped stays: the last digits of a step would count for ever
  const FaceModel reference(lattice_of(level), jaw, quiet);
  const Model model(reference);
  sim::ReferenceSolver slow(reference, 4);
  Solver converged(model, 4), fast(model, 4);
  sim::StepOptions tight;
  tight.solver = {100, 1e-7};
  StepOptions own;
  own.iterations = 100;
  own.checks_last = true;
  std::vector<Vec3f> expected(level.rest.size()), x(level.rest.size());
  for (int frame = 1; frame <= 30; ++frame) {
    std::vector<float> now = pull;
    const float share = std::min(1.0F, static_cast<float>(frame) / 6.0F);
    for (float& value : now)
      value *= share;
    const Controls moving{now, {0.8F * share, 0.2F * share, -0.5F * share}, Vec3::Zero()};
    slow.step(1.0 / 60.0, moving, tight);
    ASSERT_EQ(converged.step(1.0 / 60.0, moving, own).status, StepStatus::done);
    ASSERT_EQ(fast.step(1.0 / 60.0, moving).status, StepStatus::done);
    slow.displacements(expected);
    converged.displacements(x);
    EXPECT_LT(farthest(x, expected), 5e-5) << frame;
    fast.displacements(x);
    EXPECT_LT(farthest(x, expected), 1.5e-3) << frame;
  }
  EXPECT_LT(farthest(x, expected), 1e-4);  // what is left dies out
}

std::vector<Vec3f> played(const Model& model, std::span<const float> pull, int frames, float speed) {
  Solver face(model, 4);
  std::vector<float> now(pull.begin(), pull.end());
  for (int frame = 0; frame < frames; ++frame) {
    for (size_t c = 0; c < now.size(); ++c)
      now[c] = pull[c] * (0.5F + 0.5F * std::sin(speed * static_cast<float>(frame) + static_cast<float>(c)));
    face.step(1.0 / 60.0, {now, {now[0], 0, 0}, Vec3::Zero()});
  }
  std::vector<Vec3f> out(model.face().rest().size());
  face.displacements(out);
  return out;
}

TEST_F(Everything, EveryInstructionSetAndAnyNumberOfThreadsGiveTheSameBits) {
  const FaceModel reference(lattice_of(level), jaw);
  const Model baseline(reference, lanes::InstructionSet::baseline);
  const std::vector<Vec3f> expected = played(baseline, pull, 20, 0.3F);
  EXPECT_GT(farthest(expected, std::vector<Vec3f>(expected.size(), Vec3f::Zero())), 1e-4);
  for (const lanes::InstructionSet set : testing::all_instruction_sets())
    EXPECT_EQ(played(Model(reference, set), pull, 20, 0.3F), expected);
  // Many faces of one model, on one thread and on two.
  const Model model(reference);
  constexpr size_t count = 12;
  std::vector<std::vector<Vec3f>> one(count), two(count);
  for (size_t i = 0; i < count; ++i)
    one[i] = played(model, pull, 10, 0.1F * static_cast<float>(i));
  const auto half = [&](size_t begin) {
    for (size_t i = begin; i < count; i += 2)
      two[i] = played(model, pull, 10, 0.1F * static_cast<float>(i));
  };
  std::thread other(half, 1);
  half(0);
  other.join();
  EXPECT_EQ(one, two);
}

TEST_F(Everything, RandomActivationStaysFiniteAndInvalidNumbersReset) {
  level.fibre_strength.assign(level.fibre_strength.size(), 4.0F);
  const FaceModel reference(lattice_of(level), jaw);
  const Model model(reference);
  Solver face(model, 4);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<Vec3f> x(level.rest.size());
  for (int frame = 0; frame < 200; ++frame) {
    const std::vector<float> wild = {uniform(random), uniform(random), uniform(random), uniform(random)};
    face.step(1.0 / 60.0, {wild, {uniform(random), uniform(random), uniform(random)}, Vec3::Zero()});
    face.displacements(x);
    for (const Vec3f& d : x)
      ASSERT_LT(d.norm(), 0.1F) << frame;
  }
  const std::vector<float> bad = {NAN, 0, 0, 0};
  EXPECT_EQ(face.step(1.0 / 60.0, {bad, {}, Vec3::Zero()}).status, StepStatus::reset);
  face.displacements(x);
  for (const Vec3f& d : x)
    EXPECT_EQ(d, Vec3f::Zero());
}

}  // namespace
}  // namespace fascia::sim::realtime
