#include "formats/material_library.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "formats/files.h"

namespace fascia::formats {
namespace {

namespace fs = std::filesystem;

class Materials : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() /
        ("fascia_materials_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void put(const std::string& name, const std::string& text) const { write_text(folder_ / name, text); }
  MaterialLibrary library() const { return read_materials(read(folder_ / "head.obj")); }

  fs::path folder_;
  const std::string png = "\x89PNG\r\n\x1a\n0123456789";
  const std::string two_objects =
      "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\n"
      "o skin\nusemtl rosy\nf 1 2 3\no teeth\nusemtl enamel\nf -3 -2 -1\n";
};

TEST_F(Materials, ComeWithTheirPicturesForTheMeshesThatUseThem) {
  put("head.obj", two_objects);
  put("looks.mtl",
      "newmtl enamel\nKd 0.9 0.8 0.7\nNs 6\nnewmtl rosy\nmap_Kd skin.png\nmap_Pr gloss.png\nd 0.5\n");
  put("skin.png", png);
  put("gloss.png", png + "more");
  const MaterialLibrary found = library();
  ASSERT_EQ(found.materials.size(), 2u);
  EXPECT_EQ(found.of_mesh, (std::vector<int>{1, 0}));
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_NEAR((found.materials[0].colour - Vec3(0.9, 0.8, 0.7)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(found.materials[0].roughness, std::pow(0.25, 0.25),
              1e-6);  // alpha = sqrt(2 / (6 + 2)), squared root
  ASSERT_TRUE(found.materials[1].colour_map && found.materials[1].roughness_map);
  EXPECT_EQ(found.materials[1].colour_map->size(), png.size());
  EXPECT_TRUE(found.materials[1].has_alpha);
  EXPECT_FALSE(found.materials[0].has_alpha);
}

TEST_F(Materials, OfNeighboursThatShareVerticesStayTheirOwn) {
  put("head.obj",
      "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
      "o eye\ng iris\nusemtl blue\nf 1 2 3\ng sclera\nusemtl white\nf 2 4 3\nf 2 5 4\n");
  put("looks.mtl", "newmtl blue\nKd 0 0 1\nnewmtl white\nKd 1 1 1\n");
  const MaterialLibrary found = library();
  EXPECT_EQ(found.of_mesh, (std::vector<int>{0, 1}));
}

TEST_F(Materials, OfOtherKindsAndOutsideTheFolderAreLeftOutWithAWarning) {
  put("head.obj", two_objects);
  put("looks.mtl", "newmtl rosy\nmap_Kd skin.tga\nnewmtl enamel\nmap_Kd ../outside.png\n");
  put("skin.tga", "TGA bytes that are no PNG");
  const MaterialLibrary found = library();
  EXPECT_EQ(found.warnings.size(), 2u);
  for (const SceneMaterial& material : found.materials)
    EXPECT_FALSE(material.colour_map);
}

TEST_F(Materials, SeveralOfOneObjectAreSaid) {
  put("head.obj",
      "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
      "o head\nusemtl lips\nf 1 2 3\nusemtl skin\nf 2 4 3\n");
  put("looks.mtl", "newmtl lips\nKd 1 0 0\nnewmtl skin\nKd 1 1 1\n");
  const MaterialLibrary found = library();
  EXPECT_EQ(found.of_mesh, std::vector<int>{0});
  ASSERT_EQ(found.warnings.size(), 1u);
  EXPECT_NE(found.warnings[0].find("object 'head' has 2 materials"), std::string::npos) << found.warnings[0];
}

TEST_F(Materials, ALibraryOutsideTheFolderIsNotOpenedAndSaid) {
  fs::create_directories(folder_ / "head");
  put("looks.mtl", "newmtl rosy\nKd 1 0 0\n");
  put("head/head.obj", "mtllib ../looks.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl rosy\nf 1 2 3\n");
  const MaterialLibrary found = read_materials(read(folder_ / "head" / "head.obj"));
  EXPECT_TRUE(found.materials.empty());
  ASSERT_EQ(found.warnings.size(), 1u);
  EXPECT_NE(found.warnings[0].find("'../looks.mtl' is left out: lies outside"), std::string::npos)
      << found.warnings[0];
  const MaterialLibrary allowed = read_materials(read(folder_ / "head" / "head.obj", {Outside::allowed}));
  EXPECT_EQ(allowed.of_mesh, std::vector<int>{0});
  EXPECT_TRUE(allowed.warnings.empty());
}

TEST_F(Materials, ThatAreNotThereLeaveMeshesWithoutOne) {
  put("head.obj", two_objects);
  const MaterialLibrary found = library();
  EXPECT_TRUE(found.materials.empty());
  EXPECT_EQ(found.of_mesh, (std::vector<int>{-1, -1}));
  put("looks.mtl", "\x01\xff no such line\nnewmtl\nKd x y z\nmap_Kd\n");
  EXPECT_EQ(library().of_mesh, (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace fascia::formats
