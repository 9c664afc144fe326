#include "formats/extend.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "gltf/edit/document.h"
#include "gltf/read/container.h"

namespace fascia::formats {
namespace {

using Json = nlohmann::ordered_json;

/// A glTF file put together accessor by accessor.
class Maker {
 public:
  template <class T>
  size_t add(const std::vector<T>& values, int component, const char* type, size_t count,
             bool normalized = false) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto* raw = reinterpret_cast<const uint8_t*>(values.data());
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}});
    binary.insert(binary.end(), raw, raw + values.size() * sizeof(T));
    Json accessor = {{"bufferView", json["bufferViews"].size() - 1},
                     {"componentType", component},
                     {"count", count},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    return json["accessors"].size() - 1;
  }
  std::vector<uint8_t> glb() {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    return gltf::glb_bytes(json.dump(), binary);
  }
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", Json::array({{{"nodes", {0}}}})}};
  std::vector<uint8_t> binary;
};

/// A square of two triangles with everything a vertex may carry; its node doubles it and moves it to x = 1.
std::vector<uint8_t> square() {
  Maker maker;
  Json attributes;
  attributes["POSITION"] = maker.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5126, "VEC3", 4);
  maker.json["accessors"][0]["min"] = {0, 0, 0};
  maker.json["accessors"][0]["max"] = {1, 1, 0};
  attributes["NORMAL"] = maker.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3", 4);
  attributes["TEXCOORD_0"] =
      maker.add<uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 65535}, 5123, "VEC2", 4, true);
  attributes["COLOR_0"] =
      maker.add<uint8_t>({0, 0, 0, 255, 100, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255}, 5121, "VEC4", 4, true);
  attributes["JOINTS_0"] =
      maker.add<uint8_t>({3, 0, 0, 0, 5, 3, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0}, 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] =
      maker.add<float>({1, 0, 0, 0, .75F, .25F, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  const size_t target = maker.add<float>({0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0}, 5126, "VEC3", 4);
  const size_t indices = maker.add<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 6);
  maker.json["meshes"] =
      Json::array({{{"name", "square"},
                    {"primitives", Json::array({{{"attributes", attributes},
                                                 {"indices", indices},
                                                 {"targets", Json::array({{{"POSITION", target}}})},
                                                 {"extras", {{"kept", true}}}}})}}});
  maker.json["nodes"] = Json::array({{{"mesh", 0}, {"scale", {2, 2, 2}}, {"translation", {1, 0, 0}}}});
  return maker.glb();
}

/// Puts a vertex on the first triangle's edge from 0 to 1, at a quarter of it.
MeshExtension split(Scene& scene) {
  SceneMesh& mesh = scene.meshes[0];
  MeshExtension extension = unchanged(mesh);
  extension.vertices.push_back({0, 1, 0.25, std::nullopt});
  mesh.positions.push_back(0.75 * mesh.positions[0] + 0.25 * mesh.positions[1]);
  mesh.triangles[0] = {0, 4, 2};
  mesh.triangles.push_back({4, 1, 2});
  extension.origin.push_back(0);
  return extension;
}

template <class T>
std::vector<double> numbers(const Scene& scene, const Json& json, size_t index, size_t width) {
  const Json& accessor = json["accessors"][index];
  const Json& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
  const auto begin = view["byteOffset"].get<size_t>(), stride = view.value("byteStride", width * sizeof(T));
  std::vector<double> values;
  for (size_t i = 0; i < accessor["count"].get<size_t>(); ++i)
    for (size_t k = 0; k < width; ++k) {
      T value;
      std::memcpy(&value, &scene.document.bin[begin + i * stride + k * sizeof(T)], sizeof value);
      values.push_back(static_cast<double>(value));
    }
  return values;
}

TEST(Extend, CarriesAllAttributesOfGltf) {
  Scene scene = read("square.glb", square());
  const Json before = Json::parse(scene.document.json);
  const std::vector<uint8_t> bytes = scene.document.bin;
  const MeshExtension extension = split(scene);
  rewrite(scene, {extension});
  const Json json = Json::parse(scene.document.json);
  const Json& primitive = json["meshes"][0]["primitives"][0];
  EXPECT_TRUE(primitive["extras"]["kept"].get<bool>());
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), scene.document.bin.begin()));
  const auto of = [&](const char* name) { return primitive["attributes"][name].get<size_t>(); };
  const auto positions = numbers<float>(scene, json, of("POSITION"), 3);
  ASSERT_EQ(positions.size(), 15U);
  EXPECT_FLOAT_EQ(static_cast<float>(positions[12]), 0.25F);
  EXPECT_EQ(json["accessors"][of("POSITION")]["max"], before["accessors"][0]["max"]);
  EXPECT_EQ(numbers<uint16_t>(scene, json, of("TEXCOORD_0"), 2)[8], 16384.0);
  EXPECT_TRUE(json["accessors"][of("TEXCOORD_0")]["normalized"].get<bool>());
  EXPECT_EQ(numbers<uint8_t>(scene, json, of("COLOR_0"), 4)[16], 25.0);
  const auto joints = numbers<uint8_t>(scene, json, of("JOINTS_0"), 4);
  const auto weights = numbers<float>(scene, json, of("WEIGHTS_0"), 4);
  EXPECT_EQ(joints[16], 3.0);
  EXPECT_EQ(joints[17], 5.0);
  EXPECT_NEAR(weights[16], 0.8125, 1e-6);
  EXPECT_NEAR(weights[17], 0.1875, 1e-6);
  const Json& target = json["accessors"][primitive["targets"][0]["POSITION"].get<size_t>()];
  EXPECT_EQ(target["count"], 5);
  ASSERT_TRUE(target.contains("sparse"));
  EXPECT_EQ(target["sparse"]["count"], 2);
  // As any reader sees it.
  const Scene again = read("square.glb", gltf::glb_bytes(scene.document.json, scene.document.bin));
  ASSERT_EQ(again.meshes[0].positions.size(), 5U);
  EXPECT_LT((again.meshes[0].positions[4] - scene.meshes[0].positions[4]).norm(), 1e-6);
  EXPECT_EQ(again.meshes[0].triangles, scene.meshes[0].triangles);
}

/// The square with the attribute _ODD, an accessor without a buffer view.
std::vector<uint8_t> square_with(const Json& odd) {
  const std::vector<uint8_t> bytes = square();
  const gltf::GlbChunks chunks = gltf::glb_chunks(bytes, "square");
  Json json = Json::parse(chunks.json);
  json["accessors"].push_back(odd);
  json["meshes"][0]["primitives"][0]["attributes"]["_ODD"] = json["accessors"].size() - 1;
  return gltf::glb_bytes(json.dump(), chunks.binary);
}

TEST(Extend, TakesNoMemoryForACountThatTheFileMakesUp) {
  constexpr size_t absurd = size_t{1} << 50;
  Scene scene =
      read("square.glb", square_with({{"componentType", 5126}, {"count", absurd}, {"type", "SCALAR"}}));
  const MeshExtension extension = split(scene);
  EXPECT_NO_THROW(rewrite(scene, {extension}));
  const Json sparse = {{"count", absurd},
                       {"indices", {{"bufferView", 0}, {"componentType", 5125}}},
                       {"values", {{"bufferView", 0}}}};
  Scene other =
      read("square.glb",
           square_with({{"componentType", 5126}, {"count", 4}, {"type", "SCALAR"}, {"sparse", sparse}}));
  const MeshExtension second = split(other);
  EXPECT_THROW(rewrite(other, {second}), Error);
}

TEST(Extend, AddsAMeshWithANodeOfItsOwn) {
  Scene scene = read("square.glb", square());
  SceneMesh ball = scene.meshes[0];
  ball.name = "ball";
  ball.uvs.clear();
  for (Vec3& p : ball.positions)
    p += Vec3(0, 0, 3);
  const std::vector<MeshExtension> extensions = {unchanged(scene.meshes[0])};
  scene.meshes.push_back(ball);
  rewrite(scene, extensions);
  const Scene again = read("square.glb", gltf::glb_bytes(scene.document.json, scene.document.bin));
  ASSERT_EQ(again.meshes.size(), 2U);
  EXPECT_EQ(again.meshes[1].name, "ball");
  for (size_t v = 0; v < ball.positions.size(); ++v)
    EXPECT_LT((again.meshes[1].positions[v] - ball.positions[v]).norm(), 1e-6);
}

std::string rewritten(const std::string& text) {
  Scene scene = read("square.obj", {text.begin(), text.end()});
  const MeshExtension extension = split(scene);
  if (!scene.meshes[0].uvs.empty())
    scene.meshes[0].uvs.push_back(0.75 * scene.meshes[0].uvs[0] + 0.25 * scene.meshes[0].uvs[1]);
  rewrite(scene, {extension});
  const Scene again = read("again.obj", scene.bytes);
  EXPECT_EQ(again.meshes[0].positions.size(), scene.meshes[0].positions.size());
  EXPECT_EQ(again.meshes[0].triangles.size(), scene.meshes[0].triangles.size());
  return {scene.bytes.begin(), scene.bytes.end()};
}

TEST(Extend, WritesOnlyTheFacesOfAnObjAnewThatWereCut) {
  EXPECT_EQ(rewritten("# head\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                      "usemtl skin\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"),
            "# head\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
            "v 0.25 0 0\nvt 0.25 0\n"
            "usemtl skin\nf 1/1 5/5 3/3\nf 5/5 2/2 3/3\nf 1/1 3/3 4/4\n");
}

TEST(Extend, KnowsQuadsColoursAndNumbersCountedBackward) {
  EXPECT_EQ(rewritten("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 0 0 0\nf 1 2 3 4\n"),
            "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 0 0 0\nv 0.25 0 0 0.75 0.25 0\n"
            "f 1 5 3\nf 5 2 3\nf 1 3 4\n");
  EXPECT_EQ(rewritten("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n"),
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 5 3\nf 5 2 3\nf 1 3 4\nv 0.25 0 0\n");
}

}  // namespace
}  // namespace fascia::formats
