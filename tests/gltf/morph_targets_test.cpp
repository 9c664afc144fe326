#include "gltf/edit/morph_targets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gltf/edit/instances.h"
#include "gltf/edit/room.h"
#include "tests/gltf/sheet.h"

namespace fascia::gltf {
namespace {

using test::bump;
using test::floats;
using test::sheet;
using test::SheetOptions;

struct Result {
  Document document;
  Json json;
  std::vector<MeshTargets> targets;
  std::vector<std::string> warnings;
};

Result morphed(const SheetOptions& sheet_options, const std::vector<std::string>& names,
               const std::vector<std::vector<PrimitiveMotion>>& shapes, const MorphOptions& options = {}) {
  Edit edit(sheet(sheet_options));
  Result result;
  result.targets = add_morph_targets(edit, names, shapes, options, &result.warnings);
  result.document = glb_document(edit.bytes(), "result");
  result.json = Json::parse(result.document.json);
  return result;
}

Vec3f element(const std::vector<float>& flat, std::size_t i) {
  return Vec3f(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
}

TEST(MorphTargets, NormalsTurnWithTheSurface) {
  SheetOptions with;
  with.normals = with.tangents = true;
  const Result result = morphed(with, {"bump"}, {bump(1)});
  const Json target = result.json["meshes"][0]["primitives"][0]["targets"][0];
  EXPECT_EQ(element(floats(result.document, target["POSITION"]), 12), Vec3f(0, 0, 1));
  const std::vector<float> normals = floats(result.document, target["NORMAL"]);
  // Round vertex 11, left of the bump, lie six triangles of half a unit each: four level ones, and two that
  // rise to the bump, with area vectors (-1, 0, 1) / 2 and (-1, 1, 1) / 2 by the sheet's diagonals, or their
  // mirror images.
  const Vec3f left = Vec3f(0, 0, 1) + element(normals, 11), right = Vec3f(0, 0, 1) + element(normals, 13);
  EXPECT_NEAR(left.norm(), 1, 1e-6);
  EXPECT_NEAR(left.x() / left.z(), -1.0 / 3, 1e-5);
  EXPECT_NEAR(left.x(), -right.x(), 1e-6);
  EXPECT_TRUE(element(normals, 0).isZero(0));
  // Tangents stay square with the normals and of length 1.
  const Vec3f tangent = Vec3f(1, 0, 0) + element(floats(result.document, target["TANGENT"]), 11);
  EXPECT_NEAR(tangent.norm(), 1, 1e-6);
  EXPECT_NEAR(tangent.dot(left), 0, 1e-6);
  EXPECT_GT(tangent.z(), 0);  // it climbs
}

TEST(MorphTargets, AHeadWithoutNormalsGetsSmoothOnes) {
  const Result result = morphed({}, {"bump"}, {bump(1)});
  const Json primitive = result.json["meshes"][0]["primitives"][0];
  const std::vector<float> normals = floats(result.document, primitive["attributes"]["NORMAL"]);
  for (std::size_t v = 0; v < 25; ++v)
    EXPECT_EQ(element(normals, v), Vec3f(0, 0, 1));
  EXPECT_TRUE(primitive["targets"][0].contains("NORMAL"));
}

TEST(MorphTargets, OnlyWhatMovesIsStored) {
  std::vector<PrimitiveMotion> still = bump(0);
  const Result result = morphed({}, {"still", "bump"}, {still, bump(1)});
  EXPECT_EQ(result.json["meshes"][0]["primitives"][0]["targets"].size(), 1U);
  EXPECT_EQ(result.json["meshes"][0]["extras"]["targetNames"], Json::array({"bump"}));
  EXPECT_EQ(result.targets[0].targets, (std::vector<int>{-1, 0}));
  const Json position =
      result.json["accessors"]
                 [result.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(position["sparse"]["count"], 1);
  EXPECT_TRUE(morphed({}, {"still"}, {still}).targets.empty());
}

TEST(MorphTargets, NoAccessorIsWithoutData) {
  // Two primitives with buffers of their own would be given; here the second stands still.
  SheetOptions two;
  two.primitives = 2;
  const Result result = morphed(two, {"bump"}, {{bump(1, 2)[0]}});
  for (const Json& accessor : result.json["accessors"])
    EXPECT_TRUE(accessor.contains("bufferView") || accessor.contains("sparse")) << accessor;
}

TEST(MorphTargets, ASharedVertexBufferStaysShared) {
  SheetOptions seven;
  seven.primitives = 7;
  const Result shared = morphed(seven, {"bump"}, {bump(1, 7)}), one = morphed({}, {"bump"}, {bump(1)});
  const Json& primitives = shared.json["meshes"][0]["primitives"];
  for (const Json& primitive : primitives) {
    EXPECT_EQ(primitive["targets"], primitives[0]["targets"]);
    EXPECT_EQ(primitive["attributes"], primitives[0]["attributes"]);
  }
  EXPECT_LT(shared.document.bin.size(), one.document.bin.size() + 400);
}

TEST(MorphTargets, ClipsWeightsAndNamesThatWereThereStay) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  with.clip = true;
  const Result result = morphed(with, {"jawOpen", "bump"}, {bump(1), bump(2)});
  const Json mesh = result.json["meshes"][0];
  EXPECT_EQ(mesh["extras"]["targetNames"], Json({"lift", "jawOpen", "fascia_jawOpen", "bump"}));
  EXPECT_EQ(mesh["primitives"][0]["targets"].size(), 4U);
  EXPECT_EQ(mesh["weights"].size(), 4U);
  EXPECT_NEAR(mesh["weights"][0].get<double>(), 0.8, 1e-6);
  const Json sampler = result.json["animations"][0]["samplers"][0];
  EXPECT_EQ(floats(result.document, sampler["output"]),
            (std::vector<float>{0.8F, 0, 0, 0, 0.5F, 0.25F, 0, 0, 0, 1, 0, 0}));
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("jawOpen"), std::string::npos);
}

TEST(MorphTargets, AShapeTakesAnOldOnesPlaceOnRequest) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  with.clip = true;
  MorphOptions replace;
  replace.existing = MorphOptions::Existing::replace;
  const Result result = morphed(with, {"jawOpen"}, {bump(1)}, replace);
  const Json mesh = result.json["meshes"][0];
  EXPECT_EQ(mesh["extras"]["targetNames"], Json({"lift", "jawOpen"}));
  EXPECT_EQ(element(floats(result.document, mesh["primitives"][0]["targets"][1]["POSITION"]), 12),
            Vec3f(0, 0, 1));
  EXPECT_EQ(result.targets[0].targets, std::vector<int>{1});
}

TEST(MorphTargets, AReplacedShapesRoomIsUsedAgain) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  with.primitives = 3;
  MorphOptions replace;
  replace.existing = MorphOptions::Existing::replace;
  const Document before = sheet(with);
  const Result result = morphed(with, {"jawOpen"}, {bump(1, 3)}, replace);
  const Json old = Json::parse(before.json)["meshes"][0]["primitives"][0]["targets"];
  for (const Json& primitive : result.json["meshes"][0]["primitives"]) {
    EXPECT_EQ(primitive["targets"][1]["POSITION"], old[1]["POSITION"]);
    EXPECT_EQ(element(floats(result.document, primitive["targets"][1]["POSITION"]), 12), Vec3f(0, 0, 1));
    EXPECT_EQ(element(floats(result.document, primitive["targets"][0]["POSITION"]), 12), Vec3f(0, 0, 1));
    EXPECT_EQ(element(floats(result.document, primitive["targets"][0]["POSITION"]), 3), Vec3f(0, 0, 1));
  }
  const Json accessor = result.json["accessors"][old[1]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(accessor["min"], Json({0, 0, 0}));
  EXPECT_EQ(accessor["max"], Json({0, 0, 1}));
  std::size_t unused = 0;
  for (std::size_t a = 0; a < result.json["accessors"].size(); ++a)
    unused += uses_of(result.json, a) == 0 ? 1 : 0;
  EXPECT_EQ(unused, 0U);
}

TEST(MorphTargets, RoomThatOthersUseIsNotGivenBack) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  MorphOptions replace;
  replace.existing = MorphOptions::Existing::replace;
  const auto replaced = [&](const std::function<void(Json&)>& change) {
    Document document = sheet(with);
    Json json = Json::parse(document.json);
    change(json);
    document.json = json.dump();
    Edit edit(document);
    add_morph_targets(edit, {"jawOpen"}, {bump(1)}, replace);
    return glb_document(edit.bytes(), "result");
  };
  const auto corner_of_lift = [](const Document& document) {
    return element(
        floats(document, Json::parse(document.json)["meshes"][0]["primitives"][0]["targets"][0]["POSITION"]),
        3);
  };
  // "lift" has the accessor of "jawOpen"; or one of its own over the same buffer view, or the same bytes.
  const Vec3f slide(1, 0, 0);
  EXPECT_EQ(corner_of_lift(replaced([](Json& json) {
              Json& targets = json["meshes"][0]["primitives"][0]["targets"];
              targets[0] = targets[1];
            })),
            slide);
  EXPECT_EQ(corner_of_lift(replaced([](Json& json) {
              const Json& targets = json["meshes"][0]["primitives"][0]["targets"];
              json["accessors"][targets[0]["POSITION"].get<std::size_t>()] =
                  json["accessors"][targets[1]["POSITION"].get<std::size_t>()];
            })),
            slide);
  EXPECT_EQ(corner_of_lift(replaced([](Json& json) {
              const Json& targets = json["meshes"][0]["primitives"][0]["targets"];
              const Json& slides = json["accessors"][targets[1]["POSITION"].get<std::size_t>()];
              Json& lifts = json["accessors"][targets[0]["POSITION"].get<std::size_t>()];
              json["bufferViews"].push_back(json["bufferViews"][slides["bufferView"].get<std::size_t>()]);
              lifts["bufferView"] = json["bufferViews"].size() - 1;
            })),
            slide);
}

TEST(MorphTargets, NumbersInExtensionsMayBeAccessors) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  Document document = sheet(with);
  Json json = Json::parse(document.json);
  const std::size_t slide = json["meshes"][0]["primitives"][0]["targets"][1]["POSITION"];
  EXPECT_EQ(uses_of(json, slide), 1U);
  json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = slide;
  EXPECT_EQ(uses_of(json, slide), 2U);
  json["nodes"][0]["extensions"] = {{"FASCIA_tissue", {{"count", slide}}}};
  EXPECT_EQ(uses_of(json, slide), 1U);
}

TEST(MorphTargets, RoomIsGivenBackOnce) {
  // The base of a sparse accessor and its values in one view.
  Edit edit(sheet({}));
  const std::size_t view = edit.json["bufferViews"].size();
  const std::vector<uint8_t> bytes(25 * 12 + 4);
  edit.data().add_view(bytes);
  edit.json["accessors"].push_back(
      {{"bufferView", view},
       {"componentType", 5126},
       {"count", 25},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 2},
         {"indices", {{"bufferView", view}, {"byteOffset", 300}, {"componentType", 5123}}},
         {"values", {{"bufferView", view}}}}}});
  const OwnRoom own = own_room(edit.json, edit.json["accessors"].size() - 1);
  ASSERT_EQ(own.bytes.size(), 2U);
  EXPECT_FALSE(own.bytes[0].meets(own.bytes[1]));
  EXPECT_EQ(own.bytes[0].size() + own.bytes[1].size(), bytes.size());
  EXPECT_EQ(own.views, std::vector<std::size_t>{view});
}

TEST(MorphTargets, AShapeThatIsOnByDefaultIsNotReplaced) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  MorphOptions replace;
  replace.existing = MorphOptions::Existing::replace;
  const Result result = morphed(with, {"lift"}, {bump(2)}, replace);
  const Json mesh = result.json["meshes"][0];
  EXPECT_EQ(mesh["extras"]["targetNames"], Json({"lift", "jawOpen", "fascia_lift"}));
  EXPECT_EQ(element(floats(result.document, mesh["primitives"][0]["targets"][0]["POSITION"]), 3),
            Vec3f(0, 0, 1));
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("on by default"), std::string::npos);
}

TEST(MorphTargets, AllOfOneNameAreReplacedAndWhatStaysIsSaid) {
  SheetOptions with;
  with.weights = {0, 0};
  Document document = sheet(with);
  Json json = Json::parse(document.json);
  json["meshes"][0]["extras"]["targetNames"] = {"jawOpen", "jawOpen"};
  document.json = json.dump();
  MorphOptions replace;
  replace.existing = MorphOptions::Existing::replace;
  Edit edit(document);
  add_morph_targets(edit, {"jawOpen"}, {bump(1)}, replace);
  const Document out = glb_document(edit.bytes(), "result");
  const Json targets = Json::parse(out.json)["meshes"][0]["primitives"][0]["targets"];
  for (int t = 0; t < 2; ++t) {
    EXPECT_EQ(element(floats(out, targets[t]["POSITION"]), 12), Vec3f(0, 0, 1));
    EXPECT_EQ(element(floats(out, targets[t]["POSITION"]), 3), Vec3f(0, 0, 0));
  }
  const Result still = morphed(with, {"lift", "new"}, {bump(0), bump(1)}, replace);
  ASSERT_EQ(still.warnings.size(), 1U);
  EXPECT_NE(still.warnings[0].find("it stays in the meshes"), std::string::npos);
}

TEST(MorphTargets, WeightChannelsKeepDefaultWeights) {
  SheetOptions with;
  with.weights = {0.8F, 0};
  Edit edit(sheet(with));
  const std::vector<MeshTargets> targets = add_morph_targets(edit, {"bump"}, {bump(1)});
  Json animation = {{"samplers", Json::array()}, {"channels", Json::array()}};
  const std::vector<float> times = {0, 1};
  add_weight_channels(
      edit, targets, 2, [](std::size_t, std::size_t key) { return static_cast<float>(key); },
      edit.add_floats(times, 1, true), animation);
  EXPECT_EQ(floats(glb_document(edit.bytes(), "x"), animation["samplers"][0]["output"]),
            (std::vector<float>{0.8F, 0, 0, 0.8F, 0, 1}));
}

TEST(MorphTargets, ALinearShapeHasNoSide) {
  SheetOptions with;
  with.normals = true;
  MorphOptions linear;
  linear.is_linear = true;
  const Result up = morphed(with, {"a"}, {bump(1)}, linear), down = morphed(with, {"a"}, {bump(-1)}, linear);
  const auto normal = [](const Result& result) {
    return element(floats(result.document, result.json["meshes"][0]["primitives"][0]["targets"][0]["NORMAL"]),
                   11);
  };
  EXPECT_LT((normal(up) + normal(down)).norm(), 1e-6);
  EXPECT_NEAR(normal(up).z(), 0, 1e-6);
}

TEST(SetPose, TakesOffWhatDefaultWeightsAdd) {
  SheetOptions with;
  with.weights = {0.5F, 0};
  Edit edit(sheet(with));
  std::vector<float> seen;
  for (int v = 0; v < 25; ++v)
    seen.insert(seen.end(), {static_cast<float>(v % 5), static_cast<float>(v / 5), v == 12 ? 4.5F : 3.5F});
  set_pose(edit, {{0, 0, seen}});
  const Document posed = glb_document(edit.bytes(), "x");
  const Json primitive = Json::parse(posed.json)["meshes"][0]["primitives"][0];
  EXPECT_EQ(element(floats(posed, primitive["attributes"]["POSITION"]), 7), Vec3f(2, 1, 3));
  const Vec3f normal = element(floats(posed, primitive["attributes"]["NORMAL"]), 11);
  EXPECT_NEAR(normal.x() / normal.z(), -1.0 / 3, 1e-5);  // as the baked bump above
}

TEST(Instances, EachNodeGetsAMeshOfItsOwn) {
  Json root = Json::parse(R"({"nodes":[{"mesh":0},{"mesh":1,"scale":[-1,1,1]},{"mesh":1},{}],
                              "meshes":[{"name":"skin"},{"name":"eye"}]})");
  EXPECT_EQ(separate_instances(root), 1U);
  EXPECT_EQ(root["nodes"][1]["mesh"], 1);
  EXPECT_EQ(root["nodes"][2]["mesh"], 2);
  EXPECT_EQ(root["meshes"][2]["name"], "eye");
  EXPECT_EQ(separate_instances(root), 0U);
}

}  // namespace
}  // namespace fascia::gltf
