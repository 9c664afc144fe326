#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cstring>
#include <set>

#include "geometry/error.h"
#include "gltf/edit/document.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"

namespace fascia::gltf {
namespace {

struct Geometry {
  std::vector<float> positions;
  std::vector<Triangle> triangles;
};

/// What a plain reader finds in the first primitive.
Geometry geometry_of(const Document& document) {
  const tinygltf::Model model = load_model(glb_bytes(document.json, document.bin), "test");
  const tinygltf::Primitive& primitive = model.meshes.at(0).primitives.at(0);
  const std::vector<float> positions = decode_floats(model, primitive.attributes.at("POSITION"), "test");
  return {positions, decode_triangles(model, primitive, positions.size() / 3, "test")};
}

const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5F, 0.5F, 1, 2, 2, 2};
const std::vector<uint32_t> order = {0, 1, 2, 0, 2, 3, 0, 1, 4, 3, 4, 5};

/// A document whose two views are packed, behind a placeholder buffer as gltfpack writes it.
Document meshopt_document() {
  std::vector<uint8_t> vertices(meshopt_encodeVertexBufferBound(6, 12)),
      indices(meshopt_encodeIndexBufferBound(12, 6));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), corners.data(), 6, 12));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), order.data(), 12));
  const auto view = [](std::size_t offset, std::size_t packed, std::size_t stride, std::size_t count,
                       const char* mode, std::size_t place) {
    return Json{{"buffer", 1},
                {"byteOffset", place},
                {"byteLength", stride * count},
                {"extensions",
                 {{"EXT_meshopt_compression",
                   {{"buffer", 0},
                    {"byteOffset", offset},
                    {"byteLength", packed},
                    {"byteStride", stride},
                    {"count", count},
                    {"mode", mode}}}}}};
  };
  const std::size_t second = (vertices.size() + 3) / 4 * 4;
  Json root = Json::parse(R"({"asset":{"version":"2.0"},"extensionsUsed":["EXT_meshopt_compression"],
    "extensionsRequired":["EXT_meshopt_compression"],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[0,0,0],"max":[2,2,2]},
                 {"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}]})");
  root["bufferViews"] = Json::array({view(0, vertices.size(), 12, 6, "ATTRIBUTES", 0),
                                     view(second, indices.size(), 4, 12, "TRIANGLES", 72)});
  root["buffers"] = Json::array(
      {{{"byteLength", second + indices.size()}},
       {{"byteLength", 120}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}});
  Document document{root.dump(), vertices};
  document.bin.resize(second);
  document.bin.insert(document.bin.end(), indices.begin(), indices.end());
  return document;
}

std::set<std::set<uint32_t>> as_sets(const std::vector<Triangle>& triangles) {
  std::set<std::set<uint32_t>> sets;
  for (const Triangle& t : triangles)
    sets.insert({t.begin(), t.end()});
  return sets;
}

TEST(Meshopt, UnpacksVerticesAndTriangles) {
  const Document plain = self_contained(meshopt_document(), {}, "packed.glb");
  const Json root = Json::parse(plain.json);
  EXPECT_FALSE(root.contains("extensionsUsed"));
  EXPECT_FALSE(root.contains("extensionsRequired"));
  EXPECT_EQ(root["buffers"].size(), 1U);
  const Geometry geometry = geometry_of(plain);
  EXPECT_EQ(geometry.positions, corners);
  EXPECT_EQ(as_sets(geometry.triangles),
            (std::set<std::set<uint32_t>>{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}, {3, 4, 5}}));
}

TEST(Meshopt, DamagedDataAreRefusedBeforeMemoryIsTaken) {
  const Document sound = meshopt_document();
  Document damaged = sound;
  damaged.bin[0] ^= 0xFF;
  EXPECT_THROW(self_contained(damaged, {}, "x"), Error);
  for (const char* promise : {"\"count\":6", "\"count\":12"}) {
    Document greedy = sound;
    const std::size_t at = greedy.json.rfind(promise);
    greedy.json.replace(at, std::strlen(promise), "\"count\":3000000000");
    EXPECT_THROW(self_contained(greedy, {}, "x"), Error);
  }
  Document beyond = sound;
  beyond.bin.resize(8);
  EXPECT_THROW(self_contained(beyond, {}, "x"), Error);
}

/// Two triangles over a square, packed by Draco without quantisation.
Document draco_document() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (uint32_t t = 0; t < 2; ++t)
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), &corners[3 * order[3 * t]],
                                      &corners[3 * order[3 * t + 1]], &corners[3 * order[3 * t + 2]]);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer packed;
  encoder.EncodeMeshToBuffer(*mesh, &packed);
  Json root = Json::parse(R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_draco_mesh_compression"],
    "extensionsRequired":["KHR_draco_mesh_compression"],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":
      {"bufferView":0,"attributes":{"POSITION":0}}}}]}],
    "accessors":[{"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                 {"componentType":5123,"count":6,"type":"SCALAR"}]})");
  root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] =
      mesh->attribute(position)->unique_id();
  root["bufferViews"] = Json::array({{{"buffer", 0}, {"byteLength", packed.size()}}});
  root["buffers"] = Json::array({{{"byteLength", packed.size()}}});
  return {root.dump(), {packed.data(), packed.data() + packed.size()}};
}

TEST(Draco, UnpacksAPrimitive) {
  const Document plain = self_contained(draco_document(), {}, "packed.glb");
  const Json root = Json::parse(plain.json);
  EXPECT_FALSE(root.contains("extensionsRequired"));
  EXPECT_FALSE(root["meshes"][0]["primitives"][0].contains("extensions"));
  const Geometry geometry = geometry_of(plain);
  ASSERT_EQ(geometry.positions.size(), 12U);
  ASSERT_EQ(geometry.triangles.size(), 2U);
  // The encoder orders vertices as it likes: the surface is what counts.
  double area = 0;
  for (const Triangle& t : geometry.triangles) {
    const auto at = [&](uint32_t v, int k) {
      return geometry.positions[3 * v + static_cast<std::size_t>(k)];
    };
    area += 0.5 * ((at(t[1], 0) - at(t[0], 0)) * (at(t[2], 1) - at(t[0], 1)) -
                   (at(t[1], 1) - at(t[0], 1)) * (at(t[2], 0) - at(t[0], 0)));
  }
  EXPECT_NEAR(area, 1, 1e-6);
}

TEST(Draco, DamagedDataAreRefusedByName) {
  Document damaged = draco_document();
  damaged.bin[0] = 'X';
  try {
    self_contained(damaged, {}, "head.glb");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("mesh 0 primitive 0"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace fascia::gltf
