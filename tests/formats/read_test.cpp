#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "formats/gltf_document.h"
#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"

namespace fascia::formats {
namespace {

std::vector<uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string message_of(const std::string& name, const std::string& text) {
  try {
    read(name, bytes_of(text));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const char* two_quads =
    "# comment\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 9\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\no front\nf 1/1 "
    "2/2 3/3 4/4\n"
    "o back\nf 1/1 4/4 3/3 2/2\n";

TEST(ReadObj, KeepsObjectsQuadsAndSourceVertices) {
  const Scene scene = read("square.obj", bytes_of(two_quads));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "front");
  EXPECT_EQ(scene.meshes[0].polygons[0].size(), 4u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(scene.meshes[1].source_vertices, (std::vector<int>{0, 3, 2, 1}));
  EXPECT_EQ(scene.meshes[0].uvs.size(), 4u);
}

TEST(ReadObj, NamesAFaceBeyondTheVertices) {
  EXPECT_NE(message_of("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").find("vertex 9 of 3"),
            std::string::npos);
}

TEST(Read, RefusesWhatIsNoMesh) {
  EXPECT_NE(message_of("empty.obj", "").find("is empty"), std::string::npos);
  EXPECT_NE(message_of("points.obj", "v 0 0 0\n").find("no triangles"), std::string::npos);
  EXPECT_NE(message_of("text.txt", "hello").find("use GLB, glTF, OBJ, PLY or STL"), std::string::npos);
  EXPECT_THROW(read("/nowhere/at/all.glb"), Error);
}

TEST(ReadPly, ReadsAsciiAndFindsTruncation) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const Scene scene = read("quad.ply", bytes_of(header + points + "4 0 1 2 3\n"));
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_NE(message_of("cut.ply", header + points).find("truncated"), std::string::npos);
  EXPECT_NE(message_of("bad.ply", header + points + "4 0 1 2 7\n").find("not there"), std::string::npos);
}

Drawing tetrahedron() {
  Drawing drawing;
  drawing.surfaces.push_back({"bone",
                              {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
                               {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}});
  return drawing;
}

TEST(ReadBack, EveryFormatReturnsTheSurfaceWritten) {
  const auto folder = std::filesystem::temp_directory_path() / "fascia_formats_test";
  for (const char* extension : {".obj", ".ply", ".stl", ".glb"}) {
    const auto path = folder / (std::string("shape") + extension);
    write(path, tetrahedron());
    const Scene scene = read(path);
    ASSERT_EQ(scene.meshes.size(), 1u) << extension;
    EXPECT_EQ(scene.meshes[0].triangles.size(), 4u) << extension;
    double volume = 0;
    for (const Triangle& t : scene.meshes[0].triangles) {
      const auto& p = scene.meshes[0].positions;
      Mat3 corners;
      corners << p[size_t(t[0])], p[size_t(t[1])], p[size_t(t[2])];
      volume += corners.determinant() / 6;
    }
    EXPECT_NEAR(volume, 1.0 / 6, 1e-6) << extension;
  }
  std::filesystem::remove_all(folder);
}

std::string gltf_with(const std::string& nodes) {
  // One triangle, positions as little-endian floats in a data URI.
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"name":"head","primitives":[{"attributes":{"POSITION":0}}]}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
  "bufferViews":[{"buffer":0,"byteLength":36}],
  "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

TEST(ReadGltf, AppliesNodeTransformsInOrder) {
  const Scene scene = read(
      "tree.gltf",
      bytes_of(gltf_with(
          R"([{"children":[1],"translation":[0,5,0]},{"mesh":0,"scale":[2,2,2],"rotation":[0,0,0.70710678,0.70710678]}])")));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "head");
  // (1,0,0) scaled by two, turned a quarter about z, lifted by five.
  EXPECT_NEAR((scene.meshes[0].positions[1] - Vec3(0, 7, 0)).norm(), 0, 1e-6);
}

TEST(ReadGltf, RefusesACycleAndARangeError) {
  EXPECT_NE(
      message_of("cycle.gltf", gltf_with(R"([{"children":[1]},{"mesh":0,"children":[0]}])")).find("cycle"),
      std::string::npos);
  std::string short_buffer = gltf_with(R"([{"mesh":0}])");
  short_buffer.replace(short_buffer.find("\"count\":3"), 9, "\"count\":9");
  EXPECT_NE(message_of("short.gltf", short_buffer).find("past the end"), std::string::npos);
}

TEST(ReadGltf, EveryTruncationIsAnErrorNotACrash) {
  const auto path = std::filesystem::temp_directory_path() / "fascia_truncated.glb";
  write(path, tetrahedron());
  const std::vector<uint8_t> whole = read_bytes(path);
  for (size_t size = 1; size < whole.size(); size += 7)
    EXPECT_THROW(read("cut.glb", std::vector<uint8_t>(whole.begin(), whole.begin() + long(size))), Error)
        << size;
  std::filesystem::remove(path);
}

TEST(GltfDocument, BringsEverythingIntoOneChunk) {
  const GltfDocument document = gltf_document("a.gltf", bytes_of(gltf_with(R"([{"mesh":0}])")));
  EXPECT_EQ(document.binary.size(), 36u);
  EXPECT_EQ(document.json.find("uri"), std::string::npos);
  const GltfDocument again = gltf_document("a.glb", glb_bytes(document));
  EXPECT_EQ(again.binary, document.binary);
}

}  // namespace
}  // namespace fascia::formats
