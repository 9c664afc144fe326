#include "builder/rigging/gltf_source.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "formats/files.h"

namespace fascia::rigging {
namespace {

namespace fs = std::filesystem;

class MadeFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() /
        ("fascia_made_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The glTF made of a square in the plane z = 0 that faces +Z, with `corners` as its texture coordinates.
  void make(const std::string& library, const std::string& corners) {
    formats::write_text(folder_ / "bumps.png", "\x89PNG\r\n\x1a\n0123456789");
    formats::write_text(folder_ / "looks.mtl", library);
    formats::write_text(folder_ / "head.obj", "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" +
                                                  corners + "usemtl skin\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    const rig::GltfSource source = gltf_source(formats::read(folder_ / "head.obj"), Mat4::Identity());
    json_ = nlohmann::json::parse(source.json);
    bin_ = source.bin;
  }
  const nlohmann::json& attributes() const { return json_["meshes"][0]["primitives"][0]["attributes"]; }
  std::vector<float> numbers(size_t accessor) const {
    const auto& view = json_["bufferViews"][json_["accessors"][accessor]["bufferView"].get<size_t>()];
    std::vector<float> values(view["byteLength"].get<size_t>() / sizeof(float));
    std::memcpy(values.data(), bin_.data() + view.value("byteOffset", size_t{0}),
                values.size() * sizeof(float));
    return values;
  }

  fs::path folder_;
  nlohmann::json json_;
  std::vector<uint8_t> bin_;
};

const std::string upright = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n", mirrored = "vt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\n",
                  turned = "vt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\n";

TEST_F(MadeFile, NormalsAreSmoothAcrossSeamsOfGroupsAndTextures) {
  // A roof: two squares that meet at a right angle along the edge 2 3, each a group with its own texture.
  formats::write_text(folder_ / "head.obj",
                      "v 0 0 0\nv 1 0 1\nv 1 1 1\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                      "o roof\ng left\nf 1/1 2/2 3/3 4/4\ng right\nf 2/1 5/2 6/3 3/4\n");
  const rig::GltfSource source = gltf_source(formats::read(folder_ / "head.obj"), Mat4::Identity());
  json_ = nlohmann::json::parse(source.json);
  bin_ = source.bin;
  ASSERT_EQ(json_["meshes"].size(), 2u);
  std::map<float, std::vector<Eigen::Vector3f>> at_the_ridge;  // by y
  for (const nlohmann::json& mesh : json_["meshes"]) {
    const nlohmann::json& attributes = mesh["primitives"][0]["attributes"];
    const std::vector<float> places = numbers(attributes["POSITION"]),
                             normals = numbers(attributes["NORMAL"]);
    for (size_t v = 0; v < places.size(); v += 3)
      if (places[v] == 1.0F) at_the_ridge[places[v + 1]].emplace_back(normals.data() + v);
  }
  ASSERT_EQ(at_the_ridge.size(), 2u);
  for (const auto& [y, normals] : at_the_ridge) {
    ASSERT_EQ(normals.size(), 2u);
    EXPECT_LT((normals[0] - normals[1]).norm(), 1e-6F);
    EXPECT_GT(normals[0].z(), 0.9F);
  }
}

TEST_F(MadeFile, TangentsOfANormalMapFollowItsTexture) {
  for (const auto& [corners, expected] : {std::pair{upright, std::array{1.0F, 0.0F, 0.0F, 1.0F}},
                                          {mirrored, {-1.0F, 0.0F, 0.0F, -1.0F}},
                                          {turned, {0.0F, 1.0F, 0.0F, 1.0F}}}) {
    make("newmtl skin\nnorm bumps.png\n", corners);
    ASSERT_TRUE(json_["materials"][1].contains("normalTexture"));
    ASSERT_TRUE(attributes().contains("TANGENT")) << attributes();
    const std::vector<float> tangents = numbers(attributes()["TANGENT"]);
    ASSERT_EQ(tangents.size(), 16u);
    for (size_t i = 0; i < tangents.size(); ++i)
      EXPECT_NEAR(tangents[i], expected[i % 4], 1e-6F) << corners << i;
  }
}

TEST_F(MadeFile, HasNoTangentsWithoutANormalMap) {
  make("newmtl skin\nmap_Kd bumps.png\n", upright);
  EXPECT_FALSE(attributes().contains("TANGENT"));
}

TEST_F(MadeFile, TexturesWithoutAreaStillGiveUnitTangents) {
  make("newmtl skin\nnorm bumps.png\n", "vt 0 0\nvt 0 0\nvt 0 0\nvt 0 0\n");
  const std::vector<float> tangents = numbers(attributes()["TANGENT"]);
  for (size_t v = 0; v < tangents.size(); v += 4)
    EXPECT_NEAR(std::hypot(tangents[v], tangents[v + 1], tangents[v + 2]), 1.0F, 1e-6F);
}

}  // namespace
}  // namespace fascia::rigging
