#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

constexpr uint32_t smile_left = 0, smile_right = 1, jaw = 2, pressure = 3, eye_yaw = 4;

fascia_layer layer_of(fascia_combine combine, float weight = 1.0F, const float* mask = nullptr) {
  return {sizeof(fascia_layer), combine, weight, 0, mask};
}

/// What a channel comes to when both layers drive it.
float joined(fascia_combine combine, uint32_t channel, float below, float above, float weight = 1.0F,
             const float* mask = nullptr) {
  const Loaded rig;
  const Face face(rig.asset);
  const fascia_layer layer = layer_of(combine, weight, mask);
  EXPECT_EQ(fascia_face_set_layer(face.face, 2, &layer), FASCIA_OK) << fascia_last_message();
  fascia_face_values(face.face)[channel] = below;
  fascia_face_layer_values(face.face, 2)[channel] = above;
  EXPECT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  return fascia_face_effective_values(face.face)[channel];
}

TEST(Layers, AddUpAndSaturateWithinTheRange) {
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_ADD, jaw, 0.3F, 0.4F), 0.7F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_ADD, jaw, 0.8F, 0.4F), 1.0F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_SATURATE, jaw, 0.6F, 0.5F), 0.8F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_SATURATE, pressure, -0.6F, -0.5F), -0.8F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_SATURATE, pressure, -0.6F, 0.5F), -0.1F);
}

TEST(Layers, TheGreaterDoesNotDriveTwice) {
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_MAX, jaw, 0.6F, 0.5F), 0.6F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_MAX, jaw, 0.5F, 0.6F), 0.6F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_MAX, pressure, -0.7F, 0.5F), -0.7F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_MAX, jaw, 0.4F, 0.6F, 0.5F), 0.4F);
}

TEST(Layers, OverrideAsFarAsWeightAndMaskGo) {
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_OVERRIDE, jaw, 0.2F, 0.8F), 0.8F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_OVERRIDE, jaw, 0.2F, 0.8F, 0.5F), 0.5F);
  const float mask[5] = {1, 1, 0.25F, 0, 1};
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_OVERRIDE, jaw, 0.2F, 0.8F, 1.0F, mask), 0.35F);
  EXPECT_FLOAT_EQ(joined(FASCIA_COMBINE_OVERRIDE, pressure, 0.2F, 0.8F, 1.0F, mask), 0.2F);
}

TEST(Layers, TakeNamesAndCurves) {
  const Loaded rig;
  const Face face(rig.asset);
  const fascia_layer layer = layer_of(FASCIA_COMBINE_MAX);
  ASSERT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_OK);
  ASSERT_EQ(fascia_face_layer_set(face.face, 1, "arkit:mouthSmileLeft", 0.5F), FASCIA_OK);
  const std::string csv = "time,jawOpen\n0,0.6\n1,0.6\n";
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(csv.data(), csv.size(), &curves), FASCIA_OK);
  fascia_face_set(face.face, "jaw_open", 0.2F);
  ASSERT_EQ(fascia_curves_apply_to_layer(curves, 0.0, 1.0F, face.face, 1), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  const float* effective = fascia_face_effective_values(face.face);
  EXPECT_FLOAT_EQ(effective[smile_left], 0.45F);
  EXPECT_FLOAT_EQ(effective[jaw], 0.6F);
  ASSERT_EQ(fascia_face_layer_clear(face.face, 1), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_EQ(effective[smile_left], 0.0F);
  EXPECT_FLOAT_EQ(effective[jaw], 0.2F);
  EXPECT_EQ(fascia_curves_apply_to_layer(curves, 0.0, 1.0F, face.face, 3), FASCIA_ERROR_ARGUMENT);
  fascia_curves_release(curves);
}

TEST(Layers, TakeMembersByIndex) {
  const Loaded rig;
  const Face face(rig.asset);
  const fascia_layer layer = layer_of(FASCIA_COMBINE_MAX);
  ASSERT_EQ(fascia_face_set_layer(face.face, 3, &layer), FASCIA_OK);
  uint32_t set = 9, member = 9;
  ASSERT_EQ(fascia_asset_find_member(rig.asset, "arkit:mouthSmileLeft", &set, &member), FASCIA_OK);
  ASSERT_EQ(fascia_face_layer_set_member(face.face, 3, set, member, 0.5F), FASCIA_OK)
      << fascia_last_message();
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_FLOAT_EQ(fascia_face_effective_values(face.face)[smile_left], 0.45F);
  float own = 1.0F;  // layer 0 has none of it
  ASSERT_EQ(fascia_face_get(face.face, "arkit:mouthSmileLeft", &own), FASCIA_OK);
  EXPECT_EQ(own, 0.0F);
  // Layer 0 is the face itself.
  ASSERT_EQ(fascia_face_layer_set_member(face.face, 0, set, member, 0.25F), FASCIA_OK);
  ASSERT_EQ(fascia_face_get(face.face, "arkit:mouthSmileLeft", &own), FASCIA_OK);
  EXPECT_EQ(own, 0.25F);
  EXPECT_EQ(fascia_face_layer_set_member(face.face, 2, set, member, 0.5F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_set_member(face.face, 8, set, member, 0.5F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_set_member(face.face, 3, 2, 0, 0.5F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_set_member(face.face, 3, 1, 1, 0.5F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_set_member(face.face, 3, set, member, NAN), FASCIA_ERROR_ARGUMENT);
}

TEST(Layers, AreRemoved) {
  const Loaded rig;
  const Face face(rig.asset);
  const float mask[5] = {0, 0, 0.5F, 0, 0};
  fascia_layer layer = layer_of(FASCIA_COMBINE_OVERRIDE, 1.0F, mask);
  size_t without = 0, with = 0, removed = 0;
  ASSERT_EQ(fascia_face_save(face.face, nullptr, 0, &without), FASCIA_OK);
  ASSERT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_OK);
  ASSERT_EQ(fascia_face_save(face.face, nullptr, 0, &with), FASCIA_OK);
  EXPECT_GT(with, without);
  fascia_face_values(face.face)[jaw] = 0.2F;
  fascia_face_layer_values(face.face, 1)[jaw] = 0.8F;
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_FLOAT_EQ(fascia_face_effective_values(face.face)[jaw], 0.5F);
  const std::string csv = "time,jawOpen,eyeYawLeft\n0,0.6,0.2\n1,0.6,0.2\n";  // which go with the layer
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(csv.data(), csv.size(), &curves), FASCIA_OK);
  ASSERT_EQ(fascia_curves_apply_to_layer(curves, 0.0, 1.0F, face.face, 1), FASCIA_OK);
  fascia_curves_release(curves);
  float* const values = fascia_face_layer_values(face.face, 1);
  ASSERT_EQ(fascia_face_layer_remove(face.face, 1), FASCIA_OK) << fascia_last_message();
  EXPECT_EQ(fascia_face_layer_values(face.face, 1), nullptr);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_FLOAT_EQ(fascia_face_effective_values(face.face)[jaw], 0.2F);
  ASSERT_EQ(fascia_face_save(face.face, nullptr, 0, &removed), FASCIA_OK);
  EXPECT_EQ(removed, without);
  // Its values keep their place. Made again it is at rest, and its mask is the new one.
  values[jaw] = 0.7F;
  layer = layer_of(FASCIA_COMBINE_ADD);
  ASSERT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_OK);
  EXPECT_EQ(fascia_face_layer_values(face.face, 1), values);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_FLOAT_EQ(fascia_face_effective_values(face.face)[jaw], 0.2F);
  values[jaw] = 0.1F;
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_FLOAT_EQ(fascia_face_effective_values(face.face)[jaw], 0.3F);
  EXPECT_EQ(fascia_face_layer_remove(face.face, 0), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_remove(face.face, 2), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_remove(face.face, 8), FASCIA_ERROR_ARGUMENT);
}

TEST(Layers, WrongOnesAreRefused) {
  const Loaded rig;
  const Face face(rig.asset);
  fascia_layer layer = layer_of(FASCIA_COMBINE_ADD);
  EXPECT_EQ(fascia_face_set_layer(face.face, 0, &layer), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_set_layer(face.face, 8, &layer), FASCIA_ERROR_ARGUMENT);
  layer.weight = 1.5F;
  EXPECT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_ERROR_ARGUMENT);
  layer = layer_of(static_cast<fascia_combine>(7));
  EXPECT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_ERROR_ARGUMENT);
  const float mask[5] = {1, NAN, 1, 1, 1};
  layer = layer_of(FASCIA_COMBINE_ADD, 1.0F, mask);
  EXPECT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_layer_values(face.face, 1), nullptr);
  EXPECT_EQ(fascia_face_layer_set(face.face, 1, "jaw_open", 1.0F), FASCIA_ERROR_ARGUMENT);
}

TEST(Channels, AreNamedByTheirNumbersToo) {
  const Loaded rig;
  const Face face(rig.asset);
  EXPECT_EQ(fascia_asset_find_channel(rig.asset, "#2"), static_cast<int32_t>(jaw));
  ASSERT_EQ(fascia_face_set(face.face, "#2", 0.5F), FASCIA_OK);
  EXPECT_EQ(fascia_face_values(face.face)[jaw], 0.5F);
  for (const char* const name : {"#5", "#", "#-1", "#2x", "# 2"})
    EXPECT_EQ(fascia_face_set(face.face, name, 0.5F), FASCIA_ERROR_NAME) << name;
}

TEST(Members, AreSetByIndexAsByName) {
  const Loaded rig;
  const Face face(rig.asset);
  uint32_t set = 9, member = 9;
  ASSERT_EQ(fascia_asset_find_member(rig.asset, "au:12", &set, &member), FASCIA_OK);
  EXPECT_EQ(set, 1U);
  EXPECT_EQ(member, 0U);
  ASSERT_EQ(fascia_asset_find_member(rig.asset, "arkit:jawOpen", &set, &member), FASCIA_OK);
  EXPECT_EQ(set, 0U);
  EXPECT_EQ(member, 2U);
  ASSERT_EQ(fascia_face_set_member(face.face, 1, 0, 0.5F), FASCIA_OK);
  float value = 0;
  ASSERT_EQ(fascia_face_get(face.face, "au:12", &value), FASCIA_OK);
  EXPECT_EQ(value, 0.5F);
  EXPECT_EQ(fascia_face_set_member(face.face, 1, 1, 0.5F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_set_member(face.face, 2, 0, 0.5F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_set_member(face.face, 1, 0, NAN), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_asset_find_member(rig.asset, "jaw_open", &set, &member), FASCIA_ERROR_NAME);
}

TEST(Gaze, TurnsEyesToAPoint) {
  const Loaded rig;
  const Face face(rig.asset);
  const float* effective = fascia_face_effective_values(face.face);
  // The left eye's centre is (0.03, 1.63, 0.07): half a metre before it and a tenth to the subject's left.
  const float point[3] = {0.13F, 1.63F, 0.57F};
  ASSERT_EQ(fascia_face_look_at(face.face, point, 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_NEAR(effective[eye_yaw], std::atan2(0.1F, 0.5F), 1e-5F);
  ASSERT_EQ(fascia_face_look_at(face.face, point, 0.5F), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_NEAR(effective[eye_yaw], 0.5F * std::atan2(0.1F, 0.5F), 1e-5F);
  const float aside[3] = {9.0F, 1.63F, 0.07F};  // beyond the eye's range
  ASSERT_EQ(fascia_face_look_at(face.face, aside, 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_EQ(effective[eye_yaw], 0.6F);
  for (const float side : {-0.05F, 0.05F}) {  // behind the head both eyes turn to that side
    const float behind[3] = {side, 1.63F, -0.5F};
    ASSERT_EQ(fascia_face_look_at(face.face, behind, 1.0F), FASCIA_OK);
    ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
    EXPECT_EQ(effective[eye_yaw], side < 0.0F ? -0.6F : 0.6F);
  }
  ASSERT_EQ(fascia_face_look_at(face.face, nullptr, 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_EQ(effective[eye_yaw], 0.0F);
  const float nowhere[3] = {NAN, 0, 0};
  EXPECT_EQ(fascia_face_look_at(face.face, nowhere, 1.0F), FASCIA_ERROR_ARGUMENT);
}

TEST(Blend, FadesAFaceToRestAndBack) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> rest = face.positions();
  const float* effective = fascia_face_effective_values(face.face);
  fascia_face_values(face.face)[smile_left] = 0.8F;
  fascia_face_values(face.face)[smile_right] = 0.4F;
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_blend(face.face, 0.0F, 0.5F), FASCIA_OK);
  float before = effective[smile_left];
  for (int frame = 0; frame < 30; ++frame) {
    ASSERT_EQ(fascia_face_step(face.face, 1.0F / 60.0F), FASCIA_OK);
    EXPECT_LE(effective[smile_left], before);
    EXPECT_LT(before - effective[smile_left], 0.06F);  // no jump
    before = effective[smile_left];
    if (frame == 14) {
      EXPECT_NEAR(effective[smile_left], 0.4F, 1e-3F);
    }
  }
  EXPECT_NEAR(effective[smile_left], 0.0F, 1e-6F);
  for (int frame = 0; frame < 120; ++frame)
    fascia_face_step(face.face, 1.0F / 60.0F);
  EXPECT_LT(largest_motion(face.positions(), rest), 5e-5);
  ASSERT_EQ(fascia_face_blend(face.face, 1.0F, 0.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_EQ(effective[smile_right], 0.4F);
  EXPECT_EQ(fascia_face_blend(face.face, 1.5F, 0.0F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_blend(face.face, 1.0F, -1.0F), FASCIA_ERROR_ARGUMENT);
}

}  // namespace
