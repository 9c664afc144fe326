#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

std::vector<uint8_t> saved(fascia_face* face) {
  size_t size = 0;
  EXPECT_EQ(fascia_face_save(face, nullptr, 0, &size), FASCIA_OK) << fascia_last_message();
  std::vector<uint8_t> bytes(size);
  EXPECT_EQ(fascia_face_save(face, bytes.data(), bytes.size(), &size), FASCIA_OK) << fascia_last_message();
  EXPECT_EQ(size, bytes.size());
  return bytes;
}

/// Some seconds of everything that a state must remember.
std::vector<float> play(const Face& face, int from, int frames) {
  std::vector<float> seen;
  for (int frame = from; frame < from + frames; ++frame) {
    const auto time = static_cast<float>(frame) / 50.0F;  // no whole number of substeps
    fascia_face_values(face.face)[0] = 0.5F + 0.5F * std::sin(9.0F * time);
    if (frame == 12) fascia_face_set(face.face, "arkit:jawOpen", 0.7F);
    float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    place[13] = 0.05F * std::sin(12.0F * time);
    fascia_face_move_head(face.face, place, 1.0F);
    if (frame == 10) {
      const float push[3] = {0, 0, -0.3F};
      fascia_face_touch(face.face, 0, 40, push);
    }
    EXPECT_EQ(fascia_face_step(face.face, 0.02F), FASCIA_OK);
    const std::vector<float> positions = face.positions();
    seen.insert(seen.end(), positions.begin(), positions.end());
  }
  return seen;
}

TEST(State, RestoredStateContinuesBitIdentically) {
  const Loaded rig;
  const Face face(rig.asset), other(rig.asset);
  fascia_face_blend(face.face, 0.6F, 1.0F);
  play(face, 0, 20);
  const std::vector<uint8_t> state = saved(face.face);
  const std::vector<float> first = play(face, 20, 20);
  play(other, 0, 7);  // another past
  ASSERT_EQ(fascia_face_restore(face.face, state.data(), state.size()), FASCIA_OK) << fascia_last_message();
  EXPECT_EQ(saved(face.face), state);
  EXPECT_EQ(play(face, 20, 20), first);
  ASSERT_EQ(fascia_face_restore(other.face, state.data(), state.size()), FASCIA_OK) << fascia_last_message();
  EXPECT_EQ(play(other, 20, 20), first);
}

TEST(State, TheReferenceSolverHasOneToo) {
  const Loaded rig;
  fascia_face_options options = fascia_default_face_options();
  options.solver = FASCIA_SOLVER_REFERENCE;
  fascia_face* face = nullptr;
  ASSERT_EQ(fascia_face_create(rig.asset, &options, &face), FASCIA_OK);
  fascia_vectors positions = {};
  positions.struct_size = sizeof positions;
  ASSERT_EQ(fascia_face_positions(face, 0, &positions), FASCIA_OK);
  const auto steps = [&] {
    fascia_face_values(face)[0] = 0.8F;
    for (int i = 0; i < 3; ++i)
      fascia_face_step(face, 0.02F);
    return std::vector<float>(positions.data, positions.data + 3 * positions.count);
  };
  steps();
  const std::vector<uint8_t> state = saved(face);
  const std::vector<float> first = steps();
  ASSERT_EQ(fascia_face_restore(face, state.data(), state.size()), FASCIA_OK);
  EXPECT_EQ(steps(), first);
  // A face of another solver does not take it.
  const Face own(rig.asset);
  EXPECT_EQ(fascia_face_restore(own.face, state.data(), state.size()), FASCIA_ERROR_MISMATCH);
  fascia_face_release(face);
}

TEST(State, MismatchedBytesAreRejected) {
  const Loaded rig;
  const Face face(rig.asset), layered(rig.asset);
  play(face, 0, 15);
  const std::vector<uint8_t> state = saved(face.face);
  const std::vector<float> positions = face.positions();
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{9}, std::size_t{20}, state.size() / 2, state.size() - 1}) {
    std::vector<uint8_t> damaged = state;
    damaged[at] ^= 4;
    EXPECT_NE(fascia_face_restore(face.face, damaged.data(), damaged.size()), FASCIA_OK) << at;
  }
  EXPECT_EQ(fascia_face_restore(face.face, state.data(), state.size() - 1), FASCIA_ERROR_FORMAT);
  EXPECT_EQ(fascia_face_restore(face.face, state.data(), 3), FASCIA_ERROR_FORMAT);
  EXPECT_EQ(face.positions(), positions);
  EXPECT_EQ(saved(face.face), state);
  const fascia_layer layer = {sizeof layer, FASCIA_COMBINE_ADD, 1.0F, 0, nullptr};
  ASSERT_EQ(fascia_face_set_layer(layered.face, 3, &layer), FASCIA_OK);
  EXPECT_EQ(fascia_face_restore(layered.face, state.data(), state.size()), FASCIA_ERROR_MISMATCH);
  std::vector<uint8_t> small(10);
  size_t size = 0;
  EXPECT_EQ(fascia_face_save(face.face, small.data(), small.size(), &size), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(size, state.size());
}

/// The tiny rig with a second level, softer than the first.
std::vector<uint8_t> rig_of_two_levels() {
  fascia::rig::Rig rig = tiny_rig();
  fascia::rig::TissueLevel level = rig.tissue.levels[0];
  level.name = "medium";
  for (float& strength : level.fibre_strength)
    strength *= 0.6F;
  rig.tissue.levels.push_back(level);
  rig.tissue.bindings.push_back(rig.tissue.bindings[0]);
  return fascia::rig::write(tiny_head(), rig);
}

TEST(State, OfAnotherRigIsRejectedThoughItsPlacesAreTheSame) {
  fascia::rig::Rig other = tiny_rig();
  for (float& mass : other.tissue.levels[0].masses)
    mass *= 1.05F;
  const std::vector<uint8_t> bytes = fascia::rig::write(tiny_head(), other);
  fascia_asset* asset = nullptr;
  ASSERT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK) << fascia_last_message();
  const Loaded rig;
  const Face face(rig.asset), heavier(asset);
  const std::vector<uint8_t> state = saved(face.face);
  EXPECT_EQ(fascia_face_restore(heavier.face, state.data(), state.size()), FASCIA_ERROR_MISMATCH);
  fascia_asset_release(asset);
}

TEST(Levels, SwitchContinuously) {
  const Loaded rig(rig_of_two_levels());
  const Face face(rig.asset), fine(rig.asset);
  ASSERT_EQ(fascia_face_level(face.face), 1);
  ASSERT_EQ(fascia_face_set_level(face.face, 0, 0.0F), FASCIA_OK) << fascia_last_message();
  const std::vector<float> rest = face.positions();
  fascia_vectors kept = {};
  kept.struct_size = sizeof kept;
  ASSERT_EQ(fascia_face_positions(face.face, 0, &kept), FASCIA_OK);
  fascia_face_values(face.face)[0] = fascia_face_values(fine.face)[0] = 0.8F;
  fascia_face_pose(face.face);
  fascia_face_pose(fine.face);
  const std::vector<float> coarse = face.positions();
  const double apart = largest_motion(coarse, fine.positions());
  ASSERT_GT(apart, 3e-4);
  ASSERT_EQ(fascia_face_set_level(face.face, 1, 0.25F), FASCIA_OK) << fascia_last_message();
  EXPECT_EQ(fascia_face_level(face.face), 1);
  EXPECT_EQ(face.positions(), coarse);
  std::vector<float> before = coarse;
  for (int frame = 0; frame < 16; ++frame) {
    ASSERT_EQ(fascia_face_step(face.face, 1.0F / 60.0F), FASCIA_OK);
    EXPECT_LT(largest_motion(face.positions(), before), 0.2 * apart) << frame;
    before = face.positions();
  }
  for (int frame = 0; frame < 60; ++frame)
    fascia_face_step(face.face, 1.0F / 60.0F);
  EXPECT_LT(largest_motion(face.positions(), fine.positions()), 2e-5);
  EXPECT_EQ(std::vector<float>(kept.data, kept.data + 3 * kept.count), face.positions());
  // At rest it is the file again, to the last bit.
  fascia_face_clear(face.face);
  fascia_face_set_level(face.face, 0, 0.1F);
  fascia_face_reset(face.face);
  EXPECT_EQ(face.positions(), rest);
  EXPECT_EQ(fascia_face_set_level(face.face, 2, 0.1F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_level(face.face), 0);
  EXPECT_EQ(fascia_face_level(nullptr), -1);
}

}  // namespace
