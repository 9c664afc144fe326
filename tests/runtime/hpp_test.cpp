#include "fascia/fascia.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/rig/tiny_rig.h"

namespace {

const std::vector<std::uint8_t>& bytes() {
  static const std::vector<std::uint8_t> made = fascia::test::tiny_rig_file();
  return made;
}

TEST(Hpp, HandlesAreOwnedAndMovable) {
  fascia::api::Asset asset = fascia::api::Asset::load(bytes());
  fascia::api::Face face(asset);
  asset = fascia::api::Asset::load(bytes());  // the face keeps its own
  face.set("arkit:mouthSmileLeft", 0.5F);
  EXPECT_EQ(face.get("arkit:mouthSmileLeft"), 0.5F);
  face.values()[1] = 0.25F;
  face.pose();
  EXPECT_FLOAT_EQ(face.effective_values()[0], 0.45F);
  const auto positions = face.positions(0);
  ASSERT_EQ(positions.size(), 289U);
  const fascia::api::Vector3 posed = positions[150];
  const std::vector<std::uint8_t> state = face.save();
  fascia::api::Face moved = std::move(face);
  EXPECT_EQ(moved.positions(0).data(), positions.data());
  moved.clear();
  moved.pose();
  EXPECT_NE(moved.positions(0)[150], posed);
  moved.restore(state);
  EXPECT_EQ(moved.positions(0)[150], posed);
  EXPECT_TRUE(moved.step(1.0F / 60.0F));
  EXPECT_EQ(moved.normals(0).size(), 289U);
  EXPECT_TRUE(moved.tangents(0).empty());
}

TEST(Hpp, ThrowsWhatTheCInterfaceReturns) {
  const fascia::api::Asset asset = fascia::api::Asset::load(bytes());
  fascia::api::Face face(asset);
  try {
    face.set("noSuchThing", 1.0F);
    FAIL();
  } catch (const fascia::api::Error& error) {
    EXPECT_EQ(error.result(), FASCIA_ERROR_NAME);
    EXPECT_NE(std::string(error.what()).find("noSuchThing"), std::string::npos);
  }
  EXPECT_THROW(fascia::api::Asset::load(std::span(bytes()).first(100)), fascia::api::Error);
  EXPECT_THROW(face.positions(7), fascia::api::Error);
  const float mask[2] = {1, 1};
  EXPECT_THROW(face.set_layer(1, FASCIA_COMBINE_ADD, 1.0F, mask), fascia::api::Error);
  face.set_layer(1, FASCIA_COMBINE_MAX);
  EXPECT_EQ(face.layer_values(1).size(), asset.channels().count);
  EXPECT_TRUE(face.layer_values(2).empty());
}

}  // namespace
