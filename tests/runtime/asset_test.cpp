#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

TEST(Asset, DescribesTheRig) {
  const Loaded rig;
  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_OK);
  EXPECT_EQ(info.level_count, 1U);
  EXPECT_EQ(info.mesh_count, 1U);
  EXPECT_EQ(info.muscle_count, 2U);
  EXPECT_FLOAT_EQ(info.input_to_metres[0], 0.01F);
  fascia_channels channels = {};
  channels.struct_size = sizeof channels;
  ASSERT_EQ(fascia_asset_get_channels(rig.asset, &channels), FASCIA_OK);
  ASSERT_EQ(channels.count, info.channel_count);
  EXPECT_STREQ(channels.names[2], "jaw_open");
  EXPECT_STREQ(channels.groups[0], "muscle");
  EXPECT_EQ(channels.minimum[3], -1.0F);
  fascia_set_info set = {};
  set.struct_size = sizeof set;
  ASSERT_EQ(fascia_asset_get_set(rig.asset, 0, &set), FASCIA_OK);
  EXPECT_STREQ(set.name, "arkit");
  EXPECT_STREQ(set.members[2], "jawOpen");
  fascia_mesh_info mesh = {};
  mesh.struct_size = sizeof mesh;
  ASSERT_EQ(fascia_asset_get_mesh(rig.asset, 0, &mesh), FASCIA_OK);
  EXPECT_STREQ(mesh.part, "skin");
  EXPECT_STREQ(mesh.name, "face");
  EXPECT_EQ(mesh.vertex_count, side * side);
  EXPECT_EQ(mesh.triangle_count, 2 * (side - 1) * (side - 1));
  fascia_surface surface = {};
  surface.struct_size = sizeof surface;
  ASSERT_EQ(fascia_asset_surface(rig.asset, "cranium", &surface), FASCIA_OK);
  EXPECT_EQ(surface.vertex_count, side * side);
  EXPECT_EQ(fascia_asset_surface(rig.asset, "nose", &surface), FASCIA_ERROR_NAME);
  fascia_fibres fibres = {};
  fibres.struct_size = sizeof fibres;
  ASSERT_EQ(fascia_asset_fibres(rig.asset, 0, &fibres), FASCIA_OK);
  EXPECT_EQ(fibres.fibre_count, 6U);
  EXPECT_EQ(fibres.offsets[6], fibres.point_count);
  EXPECT_STREQ(fibres.muscles[5], "zygomaticus_major_right");
  EXPECT_EQ(fascia_asset_find_channel(rig.asset, "JAW_Open"), 2);
  EXPECT_EQ(fascia_asset_find_channel(rig.asset, "jaw"), -1);
}

TEST(Asset, ASmallerStructureIsFilledUpToItsSize) {
  const Loaded rig;
  fascia_asset_info info;
  std::memset(&info, 0x5A, sizeof info);
  info.struct_size = offsetof(fascia_asset_info, channel_count);
  ASSERT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_OK);
  EXPECT_EQ(info.mesh_count, 1U);
  EXPECT_EQ(info.channel_count, 0x5A5A5A5AU);
  info.struct_size = 0;
  EXPECT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_ERROR_ARGUMENT);
}

TEST(Asset, ResultsTellFaultsApart) {
  fascia_asset* asset = nullptr;
  std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  EXPECT_EQ(fascia_asset_load(nullptr, 0, &asset), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_asset_load(bytes.data(), bytes.size() / 2, &asset), FASCIA_ERROR_FORMAT);
  std::vector<uint8_t> moved = bytes;
  const std::vector<uint8_t> head = fascia::test::tiny_head().bin;
  const auto at = std::search(moved.begin(), moved.end(), head.begin(), head.end());
  ASSERT_NE(at, moved.end());
  *at ^= 1;
  EXPECT_EQ(fascia_asset_load(moved.data(), moved.size(), &asset), FASCIA_ERROR_MISMATCH);
  std::string text(bytes.begin(), bytes.end());
  text.replace(text.find("\"specVersion\":\"1.0\""), 19, "\"specVersion\":\"9.0\"");
  EXPECT_EQ(fascia_asset_load(text.data(), text.size(), &asset), FASCIA_ERROR_VERSION);
  EXPECT_NE(std::string(fascia_last_message()).find("9.0"), std::string::npos);
  EXPECT_EQ(asset, nullptr);
}

/// Result of loading the tiny rig with something changed, and of making a face when that went well.
template <class Change>
fascia_result outcome_with(const Change& change) {
  fascia::rig::Rig rig = fascia::test::tiny_rig();
  change(rig);
  const std::vector<uint8_t> bytes = fascia::rig::write(fascia::test::tiny_head(), rig);
  fascia_asset* asset = nullptr;
  const fascia_result loaded = fascia_asset_load(bytes.data(), bytes.size(), &asset);
  if (loaded != FASCIA_OK) return loaded;
  fascia_face* face = nullptr;
  const fascia_result made = fascia_face_create(asset, nullptr, &face);
  fascia_face_release(face);
  fascia_asset_release(asset);
  return made;
}

TEST(Asset, AnEmptyFileIsCalledEmpty) {
  // An empty vector's data may be null; the user hears of the file, not of pointers.
  fascia_asset* asset = nullptr;
  EXPECT_EQ(fascia_asset_load(nullptr, 0, &asset), FASCIA_ERROR_ARGUMENT);
  EXPECT_STREQ(fascia_last_message(), "the file is empty");
  fascia_curves* curves = nullptr;
  EXPECT_EQ(fascia_curves_load("", 0, &curves), FASCIA_ERROR_ARGUMENT);
  EXPECT_STREQ(fascia_last_message(), "the file is empty");
  EXPECT_EQ(fascia_asset_load(nullptr, 4, &asset), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(asset, nullptr);
}

TEST(Asset, WhatCannotBeSimulatedIsRefusedWithItsPlace) {
  EXPECT_EQ(outcome_with([](auto&) {}), FASCIA_OK);
  const auto says = [](const char* what) {
    return std::string(fascia_last_message()).find(what) != std::string::npos;
  };
  EXPECT_EQ(outcome_with([](auto& rig) { rig.tissue.levels[0].spring_stiffness[7] = 1e30F; }),
            FASCIA_ERROR_FORMAT);
  EXPECT_TRUE(says("FASCIA_tissue/levels/0") && says("spring")) << fascia_last_message();
  EXPECT_EQ(outcome_with([](auto& rig) {
              for (auto& place : rig.tissue.levels[0].rest)
                place.z() += 2e4F;
            }),
            FASCIA_ERROR_FORMAT);
  EXPECT_TRUE(says("kilometre")) << fascia_last_message();
  EXPECT_EQ(outcome_with([](auto& rig) { rig.skull.jaw.open_angle = 1e20F; }), FASCIA_ERROR_FORMAT);
  EXPECT_TRUE(says("FASCIA_skull/jaw")) << fascia_last_message();
}

TEST(Log, HearsEveryFailure) {
  std::vector<std::string> heard;
  fascia_set_log(
      [](void* user, fascia_result, const char* message) {
        static_cast<std::vector<std::string>*>(user)->push_back(message);
      },
      &heard);
  fascia_asset* asset = nullptr;
  fascia_asset_load("nothing", 7, &asset);
  fascia_set_log(nullptr, nullptr);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0], fascia_last_message());
}

}  // namespace
