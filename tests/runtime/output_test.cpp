// What is written to the host's memory, at every distance between vertices.
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;
using nlohmann::json;

/// The tiny rig on its head with texture coordinates, so that it has tangents.
std::vector<uint8_t> rig_with_texture() {
  fascia::rig::GltfSource head = tiny_head();
  json document = json::parse(head.json);
  const std::size_t begin = head.bin.size();
  for (uint32_t v = 0; v < side * side; ++v)
    for (const uint32_t number : {v % side, v / side}) {
      const float coordinate = static_cast<float>(number) / static_cast<float>(side - 1);
      const auto* const bytes = reinterpret_cast<const uint8_t*>(&coordinate);
      head.bin.insert(head.bin.end(), bytes, bytes + sizeof coordinate);
    }
  const std::size_t view = document["bufferViews"].size(), accessor = document["accessors"].size();
  document["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", head.bin.size() - begin}});
  document["accessors"].push_back(
      {{"bufferView", view}, {"componentType", 5126}, {"count", side * side}, {"type", "VEC2"}});
  document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = accessor;
  document["buffers"][0]["byteLength"] = head.bin.size();
  head.json = document.dump();
  return fascia::rig::write(head, tiny_rig());
}

using Read = fascia_result (*)(fascia_face*, uint32_t, fascia_vectors*);
using Write = fascia_result (*)(fascia_face*, uint32_t, void*, size_t, size_t);

/// A mesh's vectors by `write` at every `stride` are those that `read` gives, and what lies between is left
/// alone.
void expect_same_at_strides(fascia_face* face, Read read, Write write, std::size_t width) {
  fascia_vectors vectors = {};
  vectors.struct_size = sizeof vectors;
  ASSERT_EQ(read(face, 0, &vectors), FASCIA_OK) << fascia_last_message();
  ASSERT_EQ(vectors.count, side * side);
  ASSERT_EQ(vectors.stride, width);
  constexpr uint8_t untouched = 0xA5;
  for (const std::size_t stride : {width, width + 4, std::size_t{32}, std::size_t{37}}) {
    std::vector<uint8_t> memory(stride * vectors.count, untouched);
    ASSERT_EQ(write(face, 0, memory.data(), stride, vectors.count), FASCIA_OK) << fascia_last_message();
    for (std::size_t v = 0; v < vectors.count; ++v) {
      EXPECT_EQ(std::memcmp(memory.data() + stride * v, vectors.data + width / 4 * v, width), 0)
          << stride << " " << v;
      for (std::size_t between = width; between < stride; ++between)
        ASSERT_EQ(memory[stride * v + between], untouched) << stride << " " << v;
    }
    EXPECT_EQ(write(face, 0, memory.data(), stride, vectors.count - 1), FASCIA_ERROR_ARGUMENT);
  }
  std::vector<uint8_t> memory(width * vectors.count, untouched);
  EXPECT_EQ(write(face, 0, memory.data(), width - 4, vectors.count), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(write(face, 1, memory.data(), width, vectors.count), FASCIA_ERROR_ARGUMENT);
}

TEST(Written, IsWhatTheFaceShowsAtEveryStride) {
  const Loaded rig(rig_with_texture());
  const Face face(rig.asset);
  fascia_face_values(face.face)[0] = 0.8F;
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  expect_same_at_strides(face.face, fascia_face_positions, fascia_face_write_positions, 12);
  expect_same_at_strides(face.face, fascia_face_normals, fascia_face_write_normals, 12);
  expect_same_at_strides(face.face, fascia_face_tangents, fascia_face_write_tangents, 16);
}

TEST(TextureCoordinates, AreTheFiles) {
  const Loaded rig(rig_with_texture());
  fascia_vectors texcoords = {};
  texcoords.struct_size = sizeof texcoords;
  ASSERT_EQ(fascia_asset_texcoords(rig.asset, 0, &texcoords), FASCIA_OK) << fascia_last_message();
  ASSERT_EQ(texcoords.count, side * side);
  ASSERT_EQ(texcoords.stride, 2 * sizeof(float));
  for (uint32_t v = 0; v < texcoords.count; ++v) {
    EXPECT_EQ(texcoords.data[2 * v], static_cast<float>(v % side) / static_cast<float>(side - 1)) << v;
    EXPECT_EQ(texcoords.data[2 * v + 1], static_cast<float>(v / side) / static_cast<float>(side - 1)) << v;
  }
  EXPECT_EQ(fascia_asset_texcoords(rig.asset, 1, &texcoords), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_asset_texcoords(rig.asset, 0, nullptr), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_asset_texcoords(nullptr, 0, &texcoords), FASCIA_ERROR_ARGUMENT);
  const Loaded plain;
  ASSERT_EQ(fascia_asset_texcoords(plain.asset, 0, &texcoords), FASCIA_OK);
  EXPECT_EQ(texcoords.count, 0U);
  EXPECT_EQ(texcoords.data, nullptr);
}

/// Normals and tangents are unit vectors at right angles, before and after the skin has moved.
TEST(Written, NormalsAndTangentsAreAFrame) {
  const Loaded rig(rig_with_texture());
  const Face face(rig.asset);
  for (const float value : {0.0F, 0.8F}) {
    fascia_face_values(face.face)[0] = value;
    ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
    std::vector<float> normals(3 * side * side), tangents(4 * side * side);
    ASSERT_EQ(fascia_face_write_normals(face.face, 0, normals.data(), 12, side * side), FASCIA_OK);
    ASSERT_EQ(fascia_face_write_tangents(face.face, 0, tangents.data(), 16, side * side), FASCIA_OK);
    for (std::size_t v = 0; v < side * side; ++v) {
      const float* const n = &normals[3 * v];
      const float* const t = &tangents[4 * v];
      EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0F, 1e-5F);
      EXPECT_NEAR(t[0] * t[0] + t[1] * t[1] + t[2] * t[2], 1.0F, 1e-5F);
      EXPECT_NEAR(n[0] * t[0] + n[1] * t[1] + n[2] * t[2], 0.0F, 1e-5F);
      EXPECT_EQ(std::abs(t[3]), 1.0F);
    }
  }
}

}  // namespace
