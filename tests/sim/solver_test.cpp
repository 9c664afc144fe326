#include "sim/solver.h"

#include <gtest/gtest.h>

#include <memory>

#include "sim/realtime/solver.h"
#include "tests/sim/patch.h"

// Whatever stands behind the interface of a solver, it keeps its promises.
namespace fascia::sim {
namespace {

struct Solvers : ::testing::Test {
  rig::TissueLevel level;
  std::unique_ptr<FaceModel> model;
  std::unique_ptr<realtime::Model> lanes;
  std::vector<std::unique_ptr<Solver>> all;
  const std::vector<float> pull = {0.8F, 0.3F};

  Solvers() {
    testing::PatchOptions options;
    level = testing::make_patch(options);
    testing::add_fibre(level, options, 0, 4, 1, 6, 0.4F);
    testing::add_fibre(level, options, 1, 2, 6, 2, 0.4F);
    model = std::make_unique<FaceModel>(lattice_of(level), Jaw{});
    lanes = std::make_unique<realtime::Model>(*model);
    all.push_back(std::make_unique<ReferenceSolver>(*model, pull.size()));
    all.push_back(std::make_unique<realtime::Solver>(*lanes, pull.size()));
  }
  std::vector<Vec3f> moved(const Solver& solver) const {
    std::vector<Vec3f> out(level.rest.size());
    solver.displacements(out);
    return out;
  }
};

double farthest(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  double most = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    most = std::max<double>(most, (a[i] - b[i]).norm());
  return most;
}

TEST_F(Solvers, SettleInOnePose) {
  const std::vector<Vec3f> rest(level.rest.size(), Vec3f::Zero());
  for (const auto& solver : all) {
    EXPECT_TRUE(solver->settle({pull, {0.2F, 0, 0}}).converged);
    EXPECT_GT(farthest(moved(*solver), rest), 1e-3);
    EXPECT_LT(farthest(moved(*solver), moved(*all.front())), 2e-5);
  }
}

TEST_F(Solvers, StayInThePoseTheyHaveSettledIn) {
  for (const auto& solver : all) {
    solver->settle({pull, {}});
    const std::vector<Vec3f> pose = moved(*solver);
    for (int frame = 0; frame < 20; ++frame)
      EXPECT_EQ(solver->step(1.0 / 60.0, {pull, {}}).status, StepStatus::done);
    EXPECT_LT(farthest(moved(*solver), pose), 3e-5);
  }
}

TEST_F(Solvers, AreAtRestAfterReset) {
  const std::vector<Vec3f> rest(level.rest.size(), Vec3f::Zero());
  for (const auto& solver : all) {
    solver->settle({pull, {}});
    solver->reset({});
    EXPECT_EQ(moved(*solver), rest);
    solver->step(0.05, {});
    EXPECT_EQ(moved(*solver), rest);
  }
}

TEST_F(Solvers, FramesOfAnyLengthArriveAtOneMotion) {
  for (const auto& solver : all) {
    solver->reset({});
    for (int frame = 0; frame < 30; ++frame)
      solver->step(1.0 / 60.0, {pull, {}});
    const std::vector<Vec3f> even = moved(*solver);
    solver->reset({});
    // The first frame takes the channels to their values, as above; the others are of any length.
    solver->step(1.0 / 60.0, {pull, {}});
    for (const double seconds : {0.001, 0.1, 0.0, 0.05, 0.1, 0.1, 0.132333333333333})
      solver->step(seconds, {pull, {}});
    EXPECT_LT(farthest(moved(*solver), even), 3e-5);
  }
}

}  // namespace
}  // namespace fascia::sim
