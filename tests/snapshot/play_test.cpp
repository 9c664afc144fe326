// Snapshots of a small rig: what is recorded, what a change of the rig does to it, and the C interface.
#include <fascia/snapshot.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cstdlib>
#include <functional>

#include "geometry/error.h"
#include "snapshot/compare.h"
#include "snapshot/file.h"
#include "snapshot/record.h"
#include "tests/rig/tiny_rig.h"

namespace fascia::snapshot {
namespace {

const std::string smile_curves = "time,arkit:mouthSmileLeft,jaw_open\n0,0,0\n0.3,1,0.2\n0.6,0.2,0.8\n";

TakeFile smile_take() {
  return {"smile.csv", "smile.csv", {smile_curves.begin(), smile_curves.end()}};
}

/// The patch of face watched at its middle, its corners of the mouth and its edge.
Request request() {
  Request request;
  WantedRegion region;
  region.name = "middle";
  region.vertices = {140, 141, 142, 143, 144, 145, 146, 147, 148};
  request.regions.push_back(region);
  region.name = "upper";
  region.vertices = {200, 201, 202, 203, 204};
  request.regions.push_back(region);
  request.takes.push_back(smile_take());
  return request;
}

Snapshot recorded(const std::function<void(rig::Rig&)>& change = {}, int threads = 1) {
  rig::Rig rig = test::tiny_rig();
  if (change) change(rig);
  Request wanted = request();
  wanted.threads = threads;
  return record(rig::write(test::tiny_head(), rig), "tiny", wanted);
}

size_t caught(const std::function<void(rig::Rig&)>& change) {
  return compare(recorded(), recorded(change)).failed;
}

TEST(Record, IsTheSameAtAnyNumberOfThreads) {
  const std::string one = to_text(recorded({}, 1));
  EXPECT_EQ(to_text(recorded({}, 3)), one);
  EXPECT_EQ(to_text(recorded({}, 0)), one);
}

TEST(Record, PlaysEveryChannelShapeAndTake) {
  const Snapshot snapshot = recorded();
  size_t moving = 0;
  for (const State& state : snapshot.states)
    for (const int32_t number : state.quanta)
      if (number != 0) {
        ++moving;
        break;
      }
  EXPECT_GE(snapshot.poses.size(), 5U);
  EXPECT_EQ(snapshot.takes[0].frames.size(), 24U);
  EXPECT_EQ(snapshot.takes[0].frames.back(), 36U);
  EXPECT_GT(moving, 20U);
}

TEST(Replay, OfTheSameRigDiffersNowhere) {
  const std::vector<uint8_t> rig = test::tiny_rig_file();
  const Snapshot then = from_text(to_text(record(rig, "tiny", request())), "file");
  const Snapshot now = replay(rig, "tiny", then, {smile_take()}, 2, {});
  const Comparison comparison = compare(then, now);
  EXPECT_TRUE(comparison.is_same_rig);
  for (const Difference& difference : comparison.differences)
    EXPECT_EQ(difference.largest_mm, 0.0);
}

TEST(Replay, RefusesAnotherTakeMeshOrLevel) {
  const std::vector<uint8_t> rig = test::tiny_rig_file();
  const Snapshot then = record(rig, "tiny", request());
  TakeFile other = smile_take();
  other.bytes[10] ^= 1;
  EXPECT_THROW(replay(rig, "tiny", then, {other}, 1, {}), Error);
  EXPECT_THROW(replay(rig, "tiny", then, {}, 1, {}), Error);
  Snapshot changed = then;
  changed.meshes[0].vertex_count = 288;
  EXPECT_THROW(replay(rig, "tiny", changed, {smile_take()}, 1, {}), Error);
  changed = then;
  changed.level = "none";
  EXPECT_THROW(replay(rig, "tiny", changed, {smile_take()}, 1, {}), Error);
  changed = then;
  changed.poses[0].values = {{"no_such_channel", 1.0}};
  EXPECT_THROW(replay(rig, "tiny", changed, {smile_take()}, 1, {}), Error);
}

TEST(Mutation, FivePercentOfAStiffnessIsCaught) {
  EXPECT_GT(caught([](rig::Rig& rig) {
              for (rig::TissueLevel& level : rig.tissue.levels)
                for (float& value : level.skin_membrane)
                  value *= 1.05F;
            }),
            0U);
  EXPECT_GT(caught([](rig::Rig& rig) {
              for (rig::TissueLevel& level : rig.tissue.levels)
                for (float& value : level.tether_tangential_stiffness)
                  value *= 1.05F;
            }),
            0U);
}

TEST(Mutation, TwoPercentOfAStrengthAreCaught) {
  EXPECT_GT(caught([](rig::Rig& rig) {
              for (rig::TissueLevel& level : rig.tissue.levels)
                for (float& value : level.fibre_strength)
                  value *= 1.02F;
            }),
            0U);
}

TEST(Mutation, AnUnchangedRigPasses) {
  EXPECT_EQ(caught([](rig::Rig&) {}), 0U);
}

struct Seen {
  uint32_t all = 0, failed = 0;
};

void see(void* user, const fascia_snapshot_difference* difference) {
  auto* seen = static_cast<Seen*>(user);
  ++seen->all;
  seen->failed += difference->ok == 0;
  EXPECT_NE(difference->state[0], 0);
  EXPECT_NE(difference->region[0], 0);
}

TEST(CInterface, ReportsInvalidArguments) {
  const std::vector<uint8_t> rig = test::tiny_rig_file();
  const Snapshot then = record(rig, "tiny", request());
  const std::string text = to_text(then);
  const fascia_snapshot_file curves = {smile_curves.data(), smile_curves.size()};
  Seen seen;
  fascia_snapshot_options options = {};
  options.struct_size = sizeof options;
  options.curves = &curves;
  options.curve_count = 1;
  options.difference = see;
  options.user = &seen;
  uint32_t failed = 99;
  ASSERT_EQ(fascia_snapshot_check(rig.data(), rig.size(), text.data(), text.size(), &options, &failed),
            FASCIA_OK)
      << fascia_snapshot_message();
  EXPECT_EQ(failed, 0U);
  EXPECT_EQ(seen.all, then.states.size() * then.regions.size());

  Snapshot moved = then;
  moved.states[1].quanta[0] += 1000;
  const std::string other = to_text(moved);
  ASSERT_EQ(fascia_snapshot_check(rig.data(), rig.size(), other.data(), other.size(), &options, &failed),
            FASCIA_OK);
  EXPECT_EQ(failed, 1U);
  EXPECT_EQ(seen.failed, 1U);

  failed = 99;
  EXPECT_EQ(fascia_snapshot_check(rig.data(), rig.size(), text.data(), text.size(), nullptr, &failed),
            FASCIA_ERROR_FORMAT);
  EXPECT_NE(std::string(fascia_snapshot_message()).find("curves"), std::string::npos);
  EXPECT_EQ(fascia_snapshot_check(rig.data(), 100, text.data(), text.size(), &options, &failed),
            FASCIA_ERROR_FORMAT);
  EXPECT_EQ(fascia_snapshot_check(rig.data(), rig.size(), text.data(), 100, &options, &failed),
            FASCIA_ERROR_FORMAT);
  EXPECT_EQ(fascia_snapshot_check(nullptr, 0, text.data(), text.size(), &options, &failed),
            FASCIA_ERROR_ARGUMENT);
  options.tolerance_mm = -1.0;
  EXPECT_EQ(fascia_snapshot_check(rig.data(), rig.size(), text.data(), text.size(), &options, &failed),
            FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(failed, 99U);
}

/// A host that rounds upwards, and traps what the library's arithmetic may raise, hears the same numbers and
/// has its mode back.
TEST(CInterface, AHostsArithmeticChangesNothing) {
  const std::vector<uint8_t> rig = test::tiny_rig_file();
  Snapshot then = record(rig, "tiny", request());
  for (int32_t& quantum : then.states[1].quanta)
    quantum += 3;  // numbers to hear
  const std::string text = to_text(then);
  const fascia_snapshot_file curves = {smile_curves.data(), smile_curves.size()};
  const auto heard = [&] {
    std::vector<double> numbers;
    fascia_snapshot_options options = {};
    options.struct_size = sizeof options;
    options.threads = 2;
    options.curves = &curves;
    options.curve_count = 1;
    options.user = &numbers;
    options.difference = [](void* user, const fascia_snapshot_difference* difference) {
      static_cast<std::vector<double>*>(user)->push_back(difference->mean_mm);
      static_cast<std::vector<double>*>(user)->push_back(difference->largest_mm);
    };
    uint32_t failed = 0;
    EXPECT_EQ(fascia_snapshot_check(rig.data(), rig.size(), text.data(), text.size(), &options, &failed),
              FASCIA_OK)
        << fascia_snapshot_message();
    return numbers;
  };
  const std::vector<double> usual = heard();
  EXPECT_GT(*std::max_element(usual.begin(), usual.end()), 0.0);
  std::fesetround(FE_UPWARD);
#if defined(__GLIBC__)
  std::feclearexcept(FE_ALL_EXCEPT);
  feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_INEXACT);
#endif
  const std::vector<double> other = heard();
  const int mode = std::fegetround();
#if defined(__GLIBC__)
  EXPECT_EQ(fegetexcept(), FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_INEXACT);
  fedisableexcept(FE_ALL_EXCEPT);
#endif
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(mode, FE_UPWARD);
  EXPECT_EQ(usual, other);
}

}  // namespace
}  // namespace fascia::snapshot
