#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"
#include "gltf/edit/document.h"
#include "gltf/read/container.h"

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

TEST(ReadObj, ANumberThatWouldWrapIsNoVertex) {
  for (const char* face : {"f 4294967297 2 3", "f 1 2 18446744073709551617", "\tf 1/1 2/1 -4294967298/1"}) {
    const std::string message =
        message_of("wrap.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n" + std::string(face) + "\n");
    EXPECT_NE(message.find("which no file has"), std::string::npos) << face << ": " << message;
  }
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
  std::filesystem::create_directories(folder);
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

const char* triangle_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(ReadObj, LineEndsFoldsAndAByteOrderMarkAreNoMatter) {
  const std::string plain = "v 0 0 0\nv 1.5 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf -4 -1 -2\n";
  std::string cr = plain, crlf;
  std::replace(cr.begin(), cr.end(), '\n', '\r');
  for (const char c : plain)
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
  crlf.resize(crlf.size() - 2);  // no end of line at the end
  const std::string folded = "v 0 0 0\nv 1.5 \\\n  0 0\nv 0 1 0\nv 0 \\\r\n0 1\nf 1 2 \\\n3\nf -4 -1 -2\n";
  const Scene expected = read("plain.obj", bytes_of(plain));
  ASSERT_EQ(expected.meshes[0].triangles.size(), 2u);
  for (const std::string& text : {cr, crlf, folded, "\xEF\xBB\xBF" + plain}) {
    const Scene scene = read("other.obj", bytes_of(text));
    ASSERT_EQ(scene.meshes.size(), 1u) << text;
    EXPECT_EQ(scene.meshes[0].triangles, expected.meshes[0].triangles) << text;
    for (size_t v = 0; v < 4; ++v)
      EXPECT_EQ(scene.meshes[0].positions[v], expected.meshes[0].positions[v]) << text;
  }
}

TEST(ReadObj, RefusesWhatIsNoNumberByItsLine) {
  for (const char* bad : {"nan", "inf", "1,5", "x"})
    EXPECT_NE(message_of("bad.obj", "# head\nv 0 0 0\nv 1 " + std::string(bad) + " 0\nv 0 1 0\nf 1 2 3\n")
                  .find("line 3"),
              std::string::npos)
        << bad;
  EXPECT_NE(message_of("short.obj", "v 0 0\nf 1 1 1\n").find("line 1"), std::string::npos);
}

TEST(ReadObj, NamesNeedNotBeUtf8) {
  const Scene scene = read("x.obj", bytes_of("o H\xE4ut\n" + std::string(triangle_obj)));
  EXPECT_EQ(scene.meshes[0].name, "H\xC3\xA4ut");
}

double area(const Scene& scene) {
  double sum = 0;
  for (const SceneMesh& mesh : scene.meshes)
    for (const Triangle& t : mesh.triangles)
      sum += triangle_area({mesh.positions, {t}}, 0);
  return sum;
}

TEST(ReadObj, PolygonsNeedNotBeConvex) {
  // An L of area 3 (a fan from its first corner covers 5), and an arrow head of area 1 as a quad.
  EXPECT_NEAR(
      area(read("l.obj", bytes_of("v 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4 5 6\n"))),
      3, 1e-12);
  EXPECT_NEAR(area(read("a.obj", bytes_of("v 0 0 0\nv 1 -1 0\nv 0 1 0\nv -1 -1 0\nf 1 2 3 4\n"))), 1, 1e-12);
  EXPECT_NEAR(area(read("b.obj", bytes_of("v 0 0 0\nv 1 -1 0\nv 0 1 0\nv -1 -1 0\nf 2 3 4 1\n"))), 1, 1e-12);
}

TEST(Read, TakesAFarOriginOff) {
  const Scene near = read("near.obj", bytes_of("v 0 0 0\nv 1.25 0 0\nv 0 1 0\nf 1 2 3\n"));
  const Scene far =
      read("far.obj", bytes_of("v 500000 4649776.25 0\nv 500001.25 4649776.25 0\nv 500000 4649777.25 0\n"
                               "f 1 2 3\n"));
  EXPECT_TRUE(near.offset.isZero(0));
  EXPECT_EQ(far.meshes[0].to_file, Mat4(Mat4::Identity()));
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_LT(far.meshes[0].positions[v].norm(), 10);
    EXPECT_EQ(Vec3(far.meshes[0].positions[v] + far.offset),
              Vec3(near.meshes[0].positions[v] + Vec3(500000, 4649776.25, 0)));
  }
}

TEST(Read, RefusesAbsurdSizes) {
  EXPECT_NE(message_of("tiny.obj", "v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n").find("units large"),
            std::string::npos);
  EXPECT_NE(message_of("huge.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1e30 0\nf 1 2 3\n").find("units large"),
            std::string::npos);
}

const std::string ply_points = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";

TEST(ReadPly, TextureCoordinatesAreNoVertices) {
  const std::string text =
      "ply\nformat ascii 1.0\n" + ply_points +
      "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 -0.02 0 7 0 1 99 0 1\n";
  EXPECT_NEAR(area(read("wedge.ply", bytes_of(text))), 1, 1e-12);
}

TEST(ReadPly, ReadsStripsAndFacesBeforeVertices) {
  const std::string strips = "ply\nformat ascii 1.0\n" + ply_points +
                             "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n";
  const Scene scene = read("strips.ply", bytes_of(strips));
  ASSERT_EQ(scene.meshes[0].triangles.size(), 3u);
  for (int t = 0; t < 3; ++t)
    EXPECT_GT(triangle_normal({scene.meshes[0].positions, scene.meshes[0].triangles}, t).z(), 0.9) << t;
  const std::string early = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n" +
                            ply_points + "end_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n0 0 9\n";
  EXPECT_NEAR(area(read("early.ply", bytes_of(early))), 0.5, 1e-12);
}

TEST(ReadPly, LineEndsAreNoMatter) {
  const std::string text = "ply\nformat ascii 1.0\ncomment end_header comes later\n" + ply_points +
                           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
  std::string cr = text;
  std::replace(cr.begin(), cr.end(), '\n', '\r');
  EXPECT_NEAR(area(read("cr.ply", bytes_of(cr))), 1, 1e-12);
  EXPECT_NEAR(area(read("lf.ply", bytes_of(text))), 1, 1e-12);
}

TEST(ReadStl, CaseBlanksAndByteOrderMarkAreNoMatter) {
  const std::string text =
      "solid head\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid head\n";
  std::string capitals = text;
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](unsigned char c) { return std::toupper(c); });
  for (const std::string& form : {text, capitals, "\n  " + text, "\xEF\xBB\xBF" + text})
    EXPECT_NEAR(area(read("x.stl", bytes_of(form))), 0.5, 1e-12) << form;
  EXPECT_NE(message_of("x.stl", "solid\nfacet\nvertex 0 0 nine\n").find("vertex line"), std::string::npos);
}

TEST(ReadStl, ABinaryFileMayBeginWithSolidAndHaveATail) {
  std::vector<uint8_t> bytes(84 + 50, 0);
  std::memcpy(bytes.data(), "solid facet", 11);
  bytes[80] = 1;
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::memcpy(&bytes[84 + 12], corners, sizeof corners);
  EXPECT_NEAR(area(read("x.stl", bytes)), 0.5, 1e-12);
  bytes.resize(bytes.size() + 7);
  EXPECT_NEAR(area(read("x.stl", bytes)), 0.5, 1e-12);
}

std::string gltf_with(const std::string& nodes) {
  // One triangle, positions as little-endian floats in a data URI.
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"name":"head","primitives":[{"attributes":{"POSITION":0}}]}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
  "bufferViews":[{"buffer":0,"byteLength":36}],
  "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

TEST(ReadGltf, OtherMajorVersionsAreRefusedByTheirNumber) {
  const auto with_version = [](const std::string& version) {
    std::string text = gltf_with(R"([{"mesh":0}])");
    return text.replace(text.find(R"("2.0")"), 5, version);
  };
  EXPECT_NE(message_of("three.gltf", with_version(R"("3.0")")).find("it is glTF 3.0"), std::string::npos);
  EXPECT_EQ(read("later.gltf", bytes_of(with_version(R"("2.1")"))).meshes.size(), 1u);
  EXPECT_NE(message_of("one.gltf", R"({"asset":{"version":"1.0"},"meshes":{"m":{}},"buffers":{"b":{}}})")
                .find("export it as glTF 2.0"),
            std::string::npos);
  EXPECT_NE(message_of("none.gltf", R"({"meshes":[]})").find("'asset' is missing"), std::string::npos);
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

TEST(ReadGltf, ANodeThatMirrorsTurnsItsTrianglesOver) {
  for (const auto& [scale, is_mirrored] : {std::pair{"[-1,1,1]", true}, {"[-1,-1,1]", false}}) {
    const Scene scene =
        read("mirrored.gltf", bytes_of(gltf_with(std::string(R"([{"mesh":0,"scale":)") + scale + "}]")));
    ASSERT_EQ(scene.meshes[0].triangles.size(), 1u);
    EXPECT_EQ(scene.meshes[0].triangles[0], is_mirrored ? (Triangle{0, 2, 1}) : (Triangle{0, 1, 2}));
  }
}

TEST(ReadGltf, RefusesACycleAndARangeError) {
  EXPECT_NE(
      message_of("cycle.gltf", gltf_with(R"([{"children":[1]},{"mesh":0,"children":[0]}])")).find("cycle"),
      std::string::npos);
  std::string short_buffer = gltf_with(R"([{"mesh":0}])");
  short_buffer.replace(short_buffer.find("\"count\":3"), 9, "\"count\":9");
  EXPECT_NE(message_of("short.gltf", short_buffer).find("reaches beyond"), std::string::npos);
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

TEST(ReadGltf, AnOffsetThatWrapsIsAnErrorNotACrash) {
  for (const char* offset : {"4294967295", "18446744073709551612", "9223372036854775807"}) {
    std::string wrapped = gltf_with(R"([{"mesh":0}])");
    wrapped.replace(wrapped.find("\"componentType\""), 0, "\"byteOffset\":" + std::string(offset) + ",");
    EXPECT_NE(message_of("wrap.gltf", wrapped), "") << offset;
  }
  std::string many = gltf_with(R"([{"mesh":0}])");
  many.replace(many.find("\"count\":3"), 9, "\"count\":1000000000");
  EXPECT_NE(message_of("many.gltf", many), "");
}

TEST(ReadGltf, IndicesAndOffsetsAreWholeNumbersAndNoneIsCutShort) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = gltf_with(R"([{"mesh":0}])");
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::string view = R"("bufferView":0,)";
  for (const char* wrong : {R"("bufferView":4294967296,)", R"("bufferView":0,"byteOffset":-12,)",
                            R"("bufferView":0,"byteOffset":0.5,)", R"("bufferView":1e300,)"})
    EXPECT_NE(message_of("w.gltf", changed(view, wrong)).find("accessors/0/"), std::string::npos) << wrong;
  EXPECT_NE(message_of("w.gltf", changed(R"("mesh":0}])", R"("mesh":4294967296}])")).find("nodes/0/mesh"),
            std::string::npos);
  EXPECT_NE(message_of("w.gltf", changed(R"("POSITION":0)", R"("POSITION":-1)")).find("attributes/POSITION"),
            std::string::npos);
  // Whole, but written as decimals: what is meant is read.
  EXPECT_EQ(
      read("w.gltf", bytes_of(changed(view, R"("bufferView":0.0,"byteOffset":0.0,)"))).meshes[0].positions[1],
      Vec3(1, 0, 0));
  EXPECT_NE(
      message_of("w.gltf", changed(view, R"("bufferView":0,"byteOffset":12.0,)")).find("reaches beyond"),
      std::string::npos);
}

TEST(ReadGltf, DefaultWeightsOfMorphTargetsAreSeen) {
  std::string morphed = gltf_with(R"([{"mesh":0,"weights":[0.5]}])");
  // The target is the mesh itself: half of it is added.
  morphed.replace(morphed.find("{\"POSITION\":0}}"), 15, R"({"POSITION":0},"targets":[{"POSITION":0}]})");
  morphed.replace(morphed.find("\"name\":\"head\""), 0, "\"weights\":[0],");
  EXPECT_EQ(read("m.gltf", bytes_of(morphed)).meshes[0].positions[1], Vec3(1.5, 0, 0));
}

TEST(ReadGltf, EachNodeOfASharedMeshGetsItsOwn) {
  const Scene scene = read("pair.gltf", bytes_of(gltf_with(R"([{"mesh":0},{"mesh":0,"scale":[-1,1,1]}])")));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_NE(scene.meshes[0].mesh, scene.meshes[1].mesh);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(ReadGltf, RefusesARequiredExtensionThatMayChangeTheShape) {
  const auto with = [](const std::string& extensions) {
    std::string text = gltf_with(R"([{"mesh":0}])");
    return text.replace(1, 0,
                        "\"extensionsUsed\":" + extensions + ",\"extensionsRequired\":" + extensions + ",");
  };
  const std::string said =
      message_of("x.gltf", with(R"(["KHR_materials_unlit","ACME_shapes","EXT_mesh_gpu_instancing"])"));
  EXPECT_NE(said.find("without ACME_shapes, EXT_mesh_gpu_instancing"), std::string::npos) << said;
  EXPECT_NE(said.find("export it"), std::string::npos) << said;
  const Scene scene =
      read("y.gltf", bytes_of(with(R"(["KHR_materials_unlit","KHR_audio_emitter","VRMC_vrm"])")));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(ReadGltf, FarNodesComeNearAndTheirPrimitivesStay) {
  const Scene scene = read("far.gltf", bytes_of(gltf_with(R"([{"mesh":0,"translation":[100000,0,-7000]}])")));
  EXPECT_GT(scene.offset.norm(), 9e4);
  EXPECT_LT(scene.meshes[0].positions[1].norm(), 10);
  EXPECT_EQ(transform_point(scene.meshes[0].to_file, Vec3(1, 0, 0)), scene.meshes[0].positions[1]);
}

TEST(ReadGltf, ChainsOfNodesMayBeLong) {
  std::string nodes = "[{\"mesh\":0}";
  for (int n = 1; n < 50000; ++n)
    nodes += ",{\"children\":[" + std::to_string(n - 1) + "],\"translation\":[0,0,1]}";
  const Scene scene = read("chain.gltf", bytes_of(gltf_with(nodes + "]")));
  EXPECT_NEAR(scene.meshes[0].positions[0].z() + scene.offset.z(), 49999, 1e-6);
}

TEST(GltfDocument, BringsEverythingIntoOneChunk) {
  const gltf::Document document = read("a.gltf", bytes_of(gltf_with(R"([{"mesh":0}])"))).document;
  EXPECT_EQ(document.bin.size(), 36u);
  EXPECT_EQ(document.json.find("uri"), std::string::npos);
  const gltf::Document again = read("a.glb", gltf::glb_bytes(document.json, document.bin)).document;
  EXPECT_EQ(again.bin, document.bin);
  EXPECT_EQ(again.json.substr(0, document.json.size()), document.json);
}

}  // namespace
}  // namespace fascia::formats
