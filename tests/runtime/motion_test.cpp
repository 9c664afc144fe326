// What a host tells a face of the world around it: a head that moves, a finger, and what comes back for
// wrinkle shaders.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fascia/fascia.h"
#include "tests/rig/tiny_rig.h"

namespace {

constexpr uint32_t side = 17;
constexpr uint32_t middle = side * (side / 2) + side / 2;
constexpr float frame = 1.0F / 60.0F;

struct Moved : ::testing::Test {
  fascia_asset* asset = nullptr;
  std::vector<fascia_face*> faces;
  void SetUp() override {
    const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
    ASSERT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK) << fascia_last_message();
  }
  void TearDown() override {
    for (fascia_face* face : faces)
      fascia_face_release(face);
    fascia_asset_release(asset);
  }
  fascia_face* face(fascia_solver solver = FASCIA_SOLVER_OWN) {
    fascia_face_options options = fascia_default_face_options();
    options.solver = solver;
    options.space = FASCIA_SPACE_METRES;
    fascia_face* made = nullptr;
    EXPECT_EQ(fascia_face_create(asset, &options, &made), FASCIA_OK);
    faces.push_back(made);
    return made;
  }
};

std::vector<float> vectors(fascia_result (*get)(fascia_face*, uint32_t, fascia_vectors*), fascia_face* face) {
  fascia_vectors out = {};
  out.struct_size = sizeof out;
  EXPECT_EQ(get(face, 0, &out), FASCIA_OK) << fascia_last_message();
  return {out.data, out.data + 3 * out.count};
}
std::vector<float> positions(fascia_face* face) {
  return vectors(fascia_face_positions, face);
}

double apart(const std::vector<float>& a, const std::vector<float>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  return most;
}

/// The head at `x` along the world's first axis, turned by `angle` about the third.
void place(fascia_face* face, double x, float scale, double angle = 0.0) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  const float matrix[16] = {c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, static_cast<float>(x), 0, 0, 1};
  ASSERT_EQ(fascia_face_move_head(face, matrix, scale), FASCIA_OK) << fascia_last_message();
}

TEST_F(Moved, ConstantVelocityCausesNoInertia) {
  fascia_face* const moving = face();
  const std::vector<float> rest = positions(moving);
  for (int k = 0; k < 30; ++k) {
    place(moving, 0.0125 * k, 1.0F);
    ASSERT_EQ(fascia_face_step(moving, frame), FASCIA_OK);
  }
  EXPECT_LT(apart(positions(moving), rest), 2e-6);
}

TEST_F(Moved, AnAcceleratedHeadsTissueLagsAsIfPushedBackTimesTheScale) {
  for (const float scale : {1.0F, 0.5F, 0.0F}) {
    fascia_face *const moving = face(), *const pushed = face();
    const std::vector<float> rest = positions(moving);
    const double acceleration = 8.0;
    for (int k = 0; k < 24; ++k) {
      // Half a t^2 has the same second difference at every step; the first two steps only tell place and
      // speed.
      const double t = static_cast<double>(frame) * k;
      place(moving, 0.5 * acceleration * t * t, scale);
      ASSERT_EQ(fascia_face_step(moving, frame), FASCIA_OK);
      const float felt[3] = {k < 2 ? 0.0F : -scale * static_cast<float>(acceleration), 0, 0};
      fascia_face_set_acceleration(pushed, felt);
      ASSERT_EQ(fascia_face_step(pushed, frame), FASCIA_OK);
    }
    const double lag = apart(positions(pushed), rest);
    EXPECT_LT(apart(positions(moving), positions(pushed)), 0.01 * lag + 1e-7);
    if (scale > 0.0F) {
      EXPECT_GT(lag, 1e-5);
    }
  }
}

TEST_F(Moved, InertiaActsInTheAxesOfTheHead) {
  fascia_face *const moving = face(), *const pushed = face();
  for (int k = 0; k < 20; ++k) {
    const double t = static_cast<double>(frame) * k;
    place(moving, 4.0 * t * t, 1.0F, M_PI / 2);  // the world's first axis is minus the head's second
    ASSERT_EQ(fascia_face_step(moving, frame), FASCIA_OK);
    const float felt[3] = {0, k < 2 ? 0.0F : 8.0F, 0};
    fascia_face_set_acceleration(pushed, felt);
    ASSERT_EQ(fascia_face_step(pushed, frame), FASCIA_OK);
  }
  const std::vector<float> rest = positions(face());
  EXPECT_LT(apart(positions(moving), positions(pushed)), 0.02 * apart(positions(pushed), rest));
}

TEST_F(Moved, ATeleportAndAResetCauseNoInertia) {
  fascia_face* const moving = face();
  const std::vector<float> rest = positions(moving);
  for (int k = 0; k < 10; ++k) {
    place(moving, k == 5 ? 3.0 : k > 5 ? 3.0 : 0.0, 1.0F);
    ASSERT_EQ(fascia_face_step(moving, frame), FASCIA_OK);
    EXPECT_LT(apart(positions(moving), rest), 2e-6) << k;
  }
  // Shaken, then reset: at rest to the last bit, and the jump that follows is not felt.
  for (int k = 0; k < 6; ++k) {
    place(moving, 3.0 + (k % 2) * 0.01, 1.0F);
    ASSERT_EQ(fascia_face_step(moving, frame), FASCIA_OK);
  }
  EXPECT_GT(apart(positions(moving), rest), 1e-5);
  ASSERT_EQ(fascia_face_reset(moving), FASCIA_OK);
  EXPECT_EQ(positions(moving), rest);
  place(moving, 3.3, 1.0F);
  ASSERT_EQ(fascia_face_step(moving, frame), FASCIA_OK);
  EXPECT_LT(apart(positions(moving), rest), 2e-6);
  float bad[16] = {NAN};
  EXPECT_EQ(fascia_face_move_head(moving, bad, 1.0F), FASCIA_ERROR_ARGUMENT);
  const float none[16] = {}, larger[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1},
              mirrored[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
              far[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1e20F, 0, 0, 1};
  for (const float* matrix : {none, larger, mirrored, far})
    EXPECT_EQ(fascia_face_move_head(moving, matrix, 1.0F), FASCIA_ERROR_ARGUMENT) << matrix[0];
}

TEST_F(Moved, AnAbsurdForceCountsAsTheStrongest) {
  fascia_face *const strongest = face(), *const absurd = face();
  const float kilonewton[3] = {0, 0, -1000.0F}, much[3] = {0, 0, -3e38F};
  ASSERT_EQ(fascia_face_touch(strongest, 0, middle, kilonewton), FASCIA_OK);
  ASSERT_EQ(fascia_face_touch(absurd, 0, middle, much), FASCIA_OK);
  EXPECT_EQ(fascia_face_pose(strongest), fascia_face_pose(absurd));
  EXPECT_LT(apart(positions(strongest), positions(absurd)), 1e-6);
}

TEST_F(Moved, AFingerPressesAlongItsForceAndInProportion) {
  fascia_face* const touched = face();
  const std::vector<float> rest = positions(touched);
  std::vector<double> sunk;
  for (const float newton : {0.008F, 0.016F}) {
    const float force[3] = {0, 0, -newton};
    ASSERT_EQ(fascia_face_clear_touches(touched), FASCIA_OK);
    ASSERT_EQ(fascia_face_touch(touched, 0, middle, force), FASCIA_OK);
    ASSERT_EQ(fascia_face_pose(touched), FASCIA_OK);
    const std::vector<float> now = positions(touched);
    sunk.push_back(static_cast<double>(rest[3 * middle + 2] - now[3 * middle + 2]));
    EXPECT_GT(sunk.back(), 1e-6);
    EXPECT_NEAR(apart(now, rest), sunk.back(),
                0.3 * sunk.back());  // nothing moves farther than what is pressed
  }
  EXPECT_NEAR(sunk[1] / sunk[0], 2.0, 0.3);
  ASSERT_EQ(fascia_face_clear_touches(touched), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(touched), FASCIA_OK);
  EXPECT_LT(apart(positions(touched), rest), 1e-6);
  const float force[3] = {0, 0, -0.001F}, bad[3] = {0, NAN, 0};
  EXPECT_EQ(fascia_face_touch(touched, 0, middle, bad), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_touch(touched, 0, side * side, force), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_touch(touched, 9, 0, force), FASCIA_ERROR_ARGUMENT);
  int taken = 0;
  while (taken < 1000 && fascia_face_touch(touched, 0, middle, force) == FASCIA_OK)
    ++taken;
  EXPECT_GE(taken, 64);
  EXPECT_LT(taken, 1000);
}

TEST_F(Moved, CompressionIsHowMuchShorterTheSkinIs) {
  fascia_face* const pulled = face();
  const std::vector<float> rest = positions(pulled);
  for (const float value : vectors(fascia_face_compression, pulled))
    EXPECT_EQ(value, 0.0F);
  fascia_face_values(pulled)[0] = 1.0F;
  ASSERT_EQ(fascia_face_pose(pulled), FASCIA_OK);
  const std::vector<float> now = positions(pulled), compression = vectors(fascia_face_compression, pulled);
  // Beside the closed form: along a row and a column, how much shorter the way to both neighbours has become.
  double strongest = 0.0;
  uint32_t where = middle;
  for (uint32_t v = 0; v < side * side; ++v) {
    const double size = std::hypot(compression[3 * v], compression[3 * v + 1], compression[3 * v + 2]);
    EXPECT_LT(size, 1.0);
    const uint32_t row = v / side, column = v % side;
    if (row == 0 || column == 0 || row + 1 == side || column + 1 == side || size <= strongest) continue;
    strongest = size;
    where = v;
  }
  EXPECT_GT(strongest, 0.01);
  double measured = 0.0;
  for (const uint32_t step : {1U, side, side + 1, side - 1}) {
    const auto length = [&](const std::vector<float>& p) {
      return std::hypot(p[3 * (where + step)] - p[3 * (where - step)],
                        p[3 * (where + step) + 1] - p[3 * (where - step) + 1],
                        p[3 * (where + step) + 2] - p[3 * (where - step) + 2]);
    };
    measured = std::max(measured, 1.0 - static_cast<double>(length(now) / length(rest)));
  }
  EXPECT_NEAR(measured, strongest, 0.4 * strongest);
}

TEST_F(Moved, TheWatchdogResetsADivergedFaceAndReportsIt) {
  fascia_face* const torn = face(FASCIA_SOLVER_REFERENCE);  // which goes as far as it is pushed in one step
  const std::vector<float> rest = positions(torn);
  const float storm[3] = {3e6F, 0, 0};
  ASSERT_EQ(fascia_face_set_acceleration(torn, storm), FASCIA_OK);
  fascia_result result = FASCIA_OK;
  for (int k = 0; k < 300 && result == FASCIA_OK; ++k)
    result = fascia_face_step(torn, frame);
  ASSERT_EQ(result, FASCIA_ERROR_DIVERGED);
  EXPECT_NE(std::string(fascia_last_message()).find("put back"), std::string::npos);
  EXPECT_LT(apart(positions(torn), rest), 1e-6);
  ASSERT_EQ(fascia_face_set_acceleration(torn, nullptr), FASCIA_OK);
  for (int k = 0; k < 30; ++k)
    ASSERT_EQ(fascia_face_step(torn, frame), FASCIA_OK) << fascia_last_message();
  EXPECT_LT(apart(positions(torn), rest), 1e-5);
}

/// What a step moves at most, metres, in each of some steps of these lengths.
std::vector<double> moves(fascia_face* face, const std::vector<float>& seconds) {
  std::vector<double> most;
  std::vector<float> before = positions(face);
  for (const float step : seconds) {
    EXPECT_EQ(fascia_face_step(face, step), FASCIA_OK) << fascia_last_message();
    const std::vector<float> now = positions(face);
    most.push_back(apart(now, before));
    before = now;
  }
  return most;
}

TEST_F(Moved, TimeBeyondTheLongestFrameIsSkipped) {
  for (const fascia_solver solver : {FASCIA_SOLVER_OWN, FASCIA_SOLVER_REFERENCE}) {
    fascia_face *const steady = face(solver), *const paused = face(solver);
    for (fascia_face* one : {steady, paused})
      ASSERT_EQ(fascia_face_set(one, "jaw_open", 0.9F), FASCIA_OK);
    const std::vector<double> even = moves(steady, std::vector<float>(30, frame));
    const double largest = *std::max_element(even.begin(), even.end());
    ASSERT_GT(largest, 1e-4);
    // The pause itself counts as much time as the solver simulates of it, 16 substeps.
    const std::vector<double> after = moves(paused, {0.5F, 1e-9F, 1e-4F, frame, frame, frame});
    for (std::size_t i = 1; i < after.size(); ++i)
      EXPECT_LE(after[i], 1.01 * largest) << i;
    EXPECT_LE(after[1], 1e-6);
  }
}

TEST_F(Moved, SlowMotionGoesInEqualSteps) {
  for (const fascia_solver solver : {FASCIA_SOLVER_OWN, FASCIA_SOLVER_REFERENCE})
    for (const int slowness : {5, 10, 7}) {
      fascia_face* const slow = face(solver);
      ASSERT_EQ(fascia_face_set(slow, "jaw_open", 0.9F), FASCIA_OK);
      const std::vector<double> steps = moves(
          slow,
          std::vector<float>(static_cast<std::size_t>(10 * slowness), frame / static_cast<float>(slowness)));
      fascia_face* const usual = face(solver);
      ASSERT_EQ(fascia_face_set(usual, "jaw_open", 0.9F), FASCIA_OK);
      const std::vector<double> frames = moves(usual, std::vector<float>(10, frame));
      const double largest = *std::max_element(frames.begin(), frames.end());
      // A step moves about its share of the fastest frame; a whole substep at once would be 2.5 shares or
      // more.
      for (std::size_t i = 0; i < steps.size(); ++i)
        EXPECT_LE(steps[i], 2.0 * largest / slowness) << slowness << ": step " << i;
    }
}

}  // namespace
