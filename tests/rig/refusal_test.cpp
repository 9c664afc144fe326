#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "geometry/error.h"
#include "gltf/read/container.h"
#include "rig/read/read.h"
#include "rig/write/write.h"
#include "tests/rig/tiny_rig.h"

namespace fascia {
namespace {

using Json = nlohmann::ordered_json;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// What `read` says of the tiny rig after `change` has had its way with the JSON.
std::string refusal(const std::function<void(Json&)>& change) {
  const rig::GltfSource file = rig::glb_source(test::tiny_rig_file());
  Json root = Json::parse(file.json);
  change(root);
  const std::vector<uint8_t> bytes = gltf::glb_bytes(root.dump(), file.bin);
  return message_of([&] { rig::read(bytes, "head.glb"); });
}

Json& extension(Json& root, const char* name) {
  return root["extensions"][name];
}

Json& accessor_of(Json& root, const Json& index) {
  return root["accessors"][index.get<std::size_t>()];
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

TEST(Refusal, TheUnchangedFileIsAccepted) {
  EXPECT_EQ(refusal([](Json&) {}), "");
}

TEST(Refusal, AMeshFarFromItsRig) {
  EXPECT_SAYS(refusal([](Json& root) {
                extension(root, "FASCIA_tissue")["levels"][0]["bindings"][0]["toRig"][12] = -1e10;
              }),
              "toRig: it carries the mesh");
}

TEST(Refusal, AnInputFartherThanNumbersReach) {
  EXPECT_SAYS(refusal([](Json& root) { extension(root, "FASCIA_tissue")["inputToMetres"][12] = 1e38; }),
              "inputToMetres: it moves by more");
}

TEST(Refusal, JawWeightsBeyondOne) {
  rig::GltfSource file = rig::glb_source(test::tiny_rig_file());
  const Json root = Json::parse(file.json);
  const Json& weights =
      root["accessors"]
          [root["extensions"]["FASCIA_tissue"]["levels"][0]["bindings"][0]["jawWeights"].get<std::size_t>()];
  const Json& view = root["bufferViews"][weights["bufferView"].get<std::size_t>()];
  const float far = 1e5F;
  std::memcpy(file.bin.data() + view.value("byteOffset", 0) + weights.value("byteOffset", 0), &far,
              sizeof far);
  EXPECT_SAYS(message_of([&] { rig::read(gltf::glb_bytes(file.json, file.bin), "head.glb"); }), "jawWeights");
}

TEST(Refusal, UnknownVersion) {
  for (const char* name :
       {"FASCIA_skull", "FASCIA_smas", "FASCIA_muscles", "FASCIA_tissue", "FASCIA_actuation"}) {
    const std::string message = refusal([&](Json& root) { extension(root, name)["specVersion"] = "7.3"; });
    EXPECT_SAYS(message, std::string(name) + "/specVersion");
    EXPECT_SAYS(message, "7.3");
    EXPECT_SAYS(refusal([&](Json& root) { root["extensions"].erase(name); }), name);
  }
}

TEST(Refusal, NamesFileExtensionAndProperty) {
  const std::string message =
      refusal([](Json& root) { extension(root, "FASCIA_smas")["depthToSkin"] = 100000; });
  EXPECT_SAYS(message, "head.glb: FASCIA_smas/depthToSkin");
}

TEST(Refusal, WrongAccessors) {
  const auto level = [](Json& root) -> Json& { return extension(root, "FASCIA_tissue")["levels"][0]; };
  const std::string path = "FASCIA_tissue/levels/0/";
  // A length that does not fit the others.
  EXPECT_SAYS(refusal([&](Json& root) { level(root)["masses"] = level(root)["skinBending"]; }),
              path + "masses");
  EXPECT_SAYS(refusal([&](Json& root) { level(root).erase("masses"); }), path + "masses");
  // Floats where whole numbers are due, and the other way round.
  EXPECT_SAYS(refusal([&](Json& root) { level(root)["kinds"] = level(root)["masses"]; }), path + "kinds");
  EXPECT_SAYS(refusal([&](Json& root) { level(root)["masses"] = level(root)["kinds"]; }), path + "masses");
  // Wrong element type.
  EXPECT_SAYS(refusal([&](Json& root) { accessor_of(root, level(root)["springNodes"])["type"] = "SCALAR"; }),
              path + "springNodes");
  // Beyond the buffer view, and counts that would overflow.
  EXPECT_SAYS(refusal([&](Json& root) { accessor_of(root, level(root)["prisms"])["count"] = 100000; }),
              path + "prisms");
  EXPECT_SAYS(
      refusal([&](Json& root) { accessor_of(root, level(root)["prisms"])["count"] = 0x5555555555555556ULL; }),
      path + "prisms");
  // No accessor at all.
  EXPECT_SAYS(refusal([&](Json& root) { level(root)["prisms"] = -1; }), path + "prisms");
  EXPECT_SAYS(refusal([&](Json& root) { level(root)["prisms"] = "none"; }), path + "prisms");
}

TEST(Refusal, ExtremeButFiniteNumbers) {
  const auto scaled = [](double factor) {
    return [factor](Json& root) {
      Json& matrix = extension(root, "FASCIA_tissue")["inputToMetres"];
      for (size_t k = 0; k < 15; ++k)  // the last stays 1
        matrix[k] = factor * matrix[k].get<double>();
    };
  };
  for (const double factor : {0.0, 1e-30, 1e30})
    EXPECT_SAYS(refusal(scaled(factor)), "inputToMetres");
  EXPECT_EQ(refusal(scaled(1e-3)), "");
  EXPECT_SAYS(refusal([](Json& root) {
                for (Json& value : extension(root, "FASCIA_tissue")["levels"][0]["bindings"][0]["toRig"])
                  value = 0.0;
              }),
              "toRig");
}

TEST(Refusal, MapsThatAreNotAffine) {
  for (const auto& [place, value] : {std::pair(15, 0.0), std::pair(15, 0.001), std::pair(3, 1e3),
                                     std::pair(7, 1e-3), std::pair(11, 5.0)}) {
    EXPECT_SAYS(
        refusal([&](Json& root) { extension(root, "FASCIA_tissue")["inputToMetres"][place] = value; }),
        "inputToMetres: the last row");
    EXPECT_SAYS(refusal([&](Json& root) {
                  extension(root, "FASCIA_tissue")["levels"][0]["bindings"][0]["toRig"][place] = value;
                }),
                "toRig: the last row");
  }
}

TEST(Refusal, ValuesOutOfRange) {
  // Claiming one column less makes indices point past the nodes.
  EXPECT_NE(refusal([](Json& root) { extension(root, "FASCIA_tissue")["levels"][0]["columns"] = 288; }), "");
  EXPECT_NE(refusal([](Json& root) { extension(root, "FASCIA_tissue")["levels"][0]["columns"] = -1; }), "");
  EXPECT_NE(refusal([](Json& root) { extension(root, "FASCIA_tissue")["levels"][0]["columns"] = 289.5; }),
            "");
  EXPECT_SAYS(refusal([](Json& root) { extension(root, "FASCIA_muscles")["muscles"].erase(1); }),
              "FASCIA_muscles");
  EXPECT_SAYS(refusal([](Json& root) { extension(root, "FASCIA_muscles")["muscles"][0]["origin"] = "nose"; }),
              "FASCIA_muscles/muscles/0/origin");
  EXPECT_SAYS(refusal([](Json& root) { extension(root, "FASCIA_actuation")["channels"][0]["muscle"] = 2; }),
              "zygomaticus_major_left");
  EXPECT_SAYS(refusal([](Json& root) { extension(root, "FASCIA_actuation")["channels"][0]["rest"] = 2; }),
              "FASCIA_actuation/channels/0");
  EXPECT_SAYS(refusal([](Json& root) {
                auto& channels = extension(root, "FASCIA_actuation")["channels"];
                channels[1]["name"] = channels[0]["name"];
              }),
              "twice");
}

TEST(Refusal, ConstantsMissingOrOutOfRange) {
  const auto mechanics = [](Json& root) -> Json& { return extension(root, "FASCIA_tissue")["mechanics"]; };
  EXPECT_SAYS(refusal([&](Json& root) { mechanics(root).erase("friction"); }),
              "FASCIA_tissue/mechanics/friction: missing");
  EXPECT_SAYS(refusal([&](Json& root) { mechanics(root)["boneStiffness"] = -1; }),
              "FASCIA_tissue/mechanics/boneStiffness: -1 is not within 0 .. ");
  EXPECT_SAYS(refusal([&](Json& root) { mechanics(root)["massDamping"] = "much"; }),
              "FASCIA_tissue/mechanics/massDamping: not a number");
  EXPECT_SAYS(refusal([&](Json& root) { mechanics(root).erase("lidRange"); }),
              "FASCIA_tissue/mechanics/lidRange/before: missing");
  EXPECT_SAYS(refusal([&](Json& root) { mechanics(root)["lipRange"]["behind"] = 1; }),
              "FASCIA_tissue/mechanics/lipRange/behind: 1 is not within");
  EXPECT_EQ(refusal([](Json& root) { extension(root, "FASCIA_tissue").erase("mechanics"); }), "");
}

TEST(Refusal, AChangedMeshIsFoundOut) {
  rig::GltfSource file = rig::glb_source(test::tiny_rig_file());
  file.bin[4] ^= 1;  // a bit of the first vertex
  const std::string moved = message_of([&] { rig::read(gltf::glb_bytes(file.json, file.bin), "head.glb"); });
  EXPECT_SAYS(moved, "FASCIA_tissue/levels/0/bindings/0");
  EXPECT_SAYS(moved, "face");
  EXPECT_SAYS(moved, "build the rig again");
  EXPECT_SAYS(refusal([](Json& root) { root["accessors"][0]["count"] = 288; }),
              "FASCIA_tissue/levels/0/bindings/0");
  EXPECT_SAYS(
      refusal([](Json& root) { extension(root, "FASCIA_tissue")["levels"][0]["bindings"][0]["mesh"] = 3; }),
      "mesh 3");
}

TEST(Refusal, AHeadWithoutRig) {
  const rig::GltfSource head = test::tiny_head();
  const std::vector<uint8_t> bytes = gltf::glb_bytes(head.json, head.bin);
  // The head's own animation names a FASCIA channel; that alone makes no rig.
  EXPECT_SAYS(message_of([&] { rig::read(bytes, "head.glb"); }), "not a Fascia rig");
  EXPECT_TRUE(rig::is_rig(test::tiny_rig_file()));
  EXPECT_FALSE(rig::is_rig({}));
}

TEST(Refusal, EveryTruncationIsAnError) {
  const std::vector<uint8_t> bytes = test::tiny_rig_file();
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 7)
    EXPECT_THROW(rig::read(std::span(bytes).first(length)), Error) << length;
  EXPECT_THROW(rig::read(std::span(bytes).first(bytes.size() - 1)), Error);
}

TEST(Refusal, NoCorruptionCrashes) {
  const std::vector<uint8_t> sound = test::tiny_rig_file();
  const gltf::GlbChunks chunks = gltf::glb_chunks(sound, "rig");
  const std::size_t json_end = 20 + chunks.json.size();
  std::mt19937 random(7);
  int refused = 0;
  for (int run = 0; run < 400; ++run) {
    std::vector<uint8_t> bytes = sound;
    for (int change = 0; change <= run % 4; ++change) {
      // Header and JSON are where structure can break; digits are where indices and lengths are.
      std::size_t at = random() % (run % 3 == 0 ? bytes.size() : json_end);
      if (run % 3 == 1) {
        while (at < json_end && (bytes[at] < '0' || bytes[at] > '9'))
          ++at;
        bytes[at] = static_cast<uint8_t>('0' + random() % 10);
      } else {
        bytes[at] = static_cast<uint8_t>(random());
      }
    }
    try {
      rig::read(bytes);
    } catch (const Error& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(Refusal, AnInconsistentRigIsNotWritten) {
  const auto written = [](const std::function<void(rig::Rig&)>& change) {
    rig::Rig rig = test::tiny_rig();
    change(rig);
    return message_of([&] { rig::write(test::tiny_head(), rig); });
  };
  EXPECT_EQ(written([](rig::Rig&) {}), "");
  EXPECT_SAYS(written([](rig::Rig& r) { r.tissue.levels[0].masses.pop_back(); }),
              "FASCIA_tissue/levels/0/masses");
  EXPECT_SAYS(written([](rig::Rig& r) { r.tissue.levels[0].spring_nodes[3][1] = 9999; }), "springNodes");
  EXPECT_SAYS(written([](rig::Rig& r) { r.smas.depth_to_skin[5] = std::numeric_limits<float>::quiet_NaN(); }),
              "FASCIA_smas/depthToSkin: element 5");
  EXPECT_SAYS(written([](rig::Rig& r) { r.muscles[1].points.pop_back(); }), "zygomaticus_major_right");
  EXPECT_SAYS(written([](rig::Rig& r) { r.tissue.bindings[0][0].vertex_count = 12; }), "289");
  EXPECT_SAYS(written([](rig::Rig& r) { r.tissue.bindings[0][0].primitive = 1; }), "primitive 1");
  EXPECT_SAYS(written([](rig::Rig& r) { r.tissue.levels.clear(), r.tissue.bindings.clear(); }), "levels");
}

}  // namespace
}  // namespace fascia
