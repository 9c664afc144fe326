// The tool on the embedded head: a snapshot catches small changes of the anatomy, and nothing else.
#include <gtest/gtest.h>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "builder/rigging/embedded_head.h"
#include "gltf/edit/uri.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

class SnapshotOfTheEmbeddedHead : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / "fascia_snapshot_test");
    fs::remove_all(*folder);
    fs::create_directories(*folder);
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    ASSERT_EQ(build("rig.glb").code, 0);
    const Outcome outcome = run("snapshot record " + at("rig.glb") + " -o " + at("snapshot.json"));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
  }
  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static Outcome run(const std::string& arguments) { return run_tool(*folder, arguments); }
  static Outcome build(const std::string& rig, const std::string& more = "") {
    return run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
               " --detail low --quiet -o " + at(rig) + " " + more);
  }
  static Outcome check(const std::string& rig, const std::string& more = "") {
    return run("snapshot check " + at(rig) + " --against " + at("snapshot.json") + " --json " + more);
  }

  /// Builds with one file of the anatomy changed, and how many differences the snapshot finds.
  static size_t caught(const std::string& file, const std::function<void(ordered_json&)>& change) {
    fs::create_directories(at("anatomy"));
    std::ifstream original(test::data().parent_path().parent_path() / "anatomy" / "data" / file);
    ordered_json json = ordered_json::parse(original);
    change(json);
    fs::remove_all(at("anatomy"));
    fs::create_directories(at("anatomy"));
    std::ofstream(at("anatomy/" + file)) << json.dump();
    const Outcome built = build("changed.glb", "--anatomy " + at("anatomy"));
    EXPECT_EQ(built.code, 0) << built.err;
    const Outcome outcome = check("changed.glb");
    const ordered_json report = ordered_json::parse(outcome.out);
    const auto failed = report["failed"].get<size_t>();
    EXPECT_EQ(outcome.code, failed > 0 ? 4 : 0);
    EXPECT_EQ(report["differences"].size(), failed);
    EXPECT_FALSE(report["same_rig"].get<bool>());
    return failed;
  }

  static ordered_json& muscle(ordered_json& muscles, const std::string& name) {
    for (ordered_json& entry : muscles["muscles"])
      if (entry["name"] == name) return entry;
    ADD_FAILURE() << name;
    return muscles;
  }
  static fs::path* folder;
};
fs::path* SnapshotOfTheEmbeddedHead::folder = nullptr;

TEST_F(SnapshotOfTheEmbeddedHead, HoldsForTheSameRigOnEveryVectorUnit) {
  for (const char* unit : {"baseline", "avx2"}) {
    setenv("FASCIA_SIMD", unit, 1);
    const Outcome outcome = check("rig.glb");
    unsetenv("FASCIA_SIMD");
    EXPECT_EQ(outcome.code, 0) << unit << outcome.out << outcome.err;
  }
}

TEST_F(SnapshotOfTheEmbeddedHead, CatchesFivePercentOfAStiffness) {
  EXPECT_GT(caught("mechanics.json",
                   [](ordered_json& json) {
                     ordered_json& value = json["sections"]["skin"]["young_modulus"]["value"];
                     value = 0.95 * value.get<double>();
                   }),
            0U);
}

TEST_F(SnapshotOfTheEmbeddedHead, CatchesTwoPercentOfAStrength) {
  EXPECT_GT(caught("muscles.json",
                   [](ordered_json& json) {
                     ordered_json& area = muscle(json, "risorius")["cross_section_mm2"];
                     area = 1.02 * area.get<double>();
                   }),
            0U);
}

TEST_F(SnapshotOfTheEmbeddedHead, CatchesARegionMovedByTwoMillimetres) {
  EXPECT_GT(caught("muscles.json",
                   [](ordered_json& json) {
                     for (ordered_json& point : muscle(json, "frontalis_medial")["insertion"]["polygon"])
                       point[1] = point[1].get<double>() + 2.0;
                   }),
            0U);
}

/// Moves the vertices of an OBJ file within 16 mm of `centre` by up to `step`, all in millimetres.
void move_skin(const std::string& from, const std::string& to, const std::array<double, 3>& centre,
               const std::array<double, 3>& step) {
  constexpr double reach = 16.0;
  std::istringstream lines(text_of(from));
  std::ofstream file(to);
  size_t moved = 0;
  for (std::string line; std::getline(lines, line);) {
    std::array<double, 3> p;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) {
      const double away = std::hypot(p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]);
      const double share = away < reach ? std::min(1.0, 2.0 * (1.0 - away / reach)) : 0.0;
      moved += share > 0.0;
      char text[128];
      std::snprintf(text, sizeof text, "v %.6f %.6f %.6f", p[0] + share * step[0], p[1] + share * step[1],
                    p[2] + share * step[2]);
      if (share > 0.0) line = text;
    }
    file << line << "\n";
  }
  EXPECT_GT(moved, 5U);
}

TEST_F(SnapshotOfTheEmbeddedHead, CatchesSkinMovedByTwoMillimetres) {
  const auto chin = ordered_json::parse(text_of(at("landmarks.json")))["landmarks"]["gnathion"];
  move_skin(at("head.obj"), at("moved.obj"), chin.get<std::array<double, 3>>(), {0.0, 0.0, 2.0});
  const Outcome built = run("build " + at("moved.obj") + " --landmarks " + at("landmarks.json") +
                            " --detail low --quiet -o " + at("moved.glb"));
  ASSERT_EQ(built.code, 0) << built.err;
  const Outcome outcome = check("moved.glb");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  // At rest the chin alone is elsewhere, by what it was moved; in poses it moves otherwise.
  std::map<std::string, double> at_rest;
  size_t in_poses = 0;
  const ordered_json report = ordered_json::parse(outcome.out);
  for (const ordered_json& row : report["differences"])
    if (row["state"] == "rest")
      at_rest[row["region"]] = row["largest_mm"].get<double>();
    else
      ++in_poses;
  ASSERT_TRUE(at_rest.count("chin")) << outcome.out.substr(0, 2000);
  EXPECT_NEAR(at_rest["chin"], 2.0, 0.1);
  EXPECT_EQ(at_rest.size(), 1U);
  EXPECT_GT(in_poses, 0U);
}

/// The pictures of a page, in order.
std::vector<gltf::DataUri> pictures_of(const std::string& page) {
  std::vector<gltf::DataUri> pictures;
  const std::string source = "src=\"";
  for (size_t at = page.find(source); at != std::string::npos; at = page.find(source, at + 1)) {
    const size_t begin = at + source.size();
    const auto picture = gltf::data_uri(std::string_view(page).substr(begin, page.find('"', begin) - begin));
    EXPECT_TRUE(picture.has_value());
    if (picture) pictures.push_back(*picture);
  }
  return pictures;
}

/// How many pixels of a PNG are of the map's red.
int red_pixels(const gltf::DataUri& png) {
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<unsigned char, decltype(&stbi_image_free)> pixels(
      stbi_load_from_memory(png.bytes.data(), static_cast<int>(png.bytes.size()), &width, &height, &channels,
                            3),
      stbi_image_free);
  EXPECT_TRUE(pixels);
  int red = 0;
  for (int i = 0; pixels && i < width * height; ++i) {
    const unsigned char* rgb = pixels.get() + 3 * i;
    red += rgb[0] > 100 && rgb[0] > 2 * rgb[1] + 30 && rgb[0] > 2 * rgb[2] + 30;
  }
  return red;
}

TEST_F(SnapshotOfTheEmbeddedHead, DrawsWhereAFaceMovesOtherwise) {
  const auto stronger = [](ordered_json& json) {
    ordered_json& area = muscle(json, "risorius")["cross_section_mm2"];
    area = 3.0 * area.get<double>();
  };
  ASSERT_GT(caught("muscles.json", stronger), 0U);
  const Outcome outcome =
      check("changed.glb", "--report " + at("changed.html") + " --junit " + at("changed.xml"));
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  const std::string xml = text_of(at("changed.xml")), page = text_of(at("changed.html"));
  EXPECT_NE(xml.find("<failure"), std::string::npos);
  EXPECT_EQ(xml.find("failures=\"0\""), std::string::npos) << xml.substr(0, 300);
  // Of every state drawn: as recorded, as it is now, and the difference.
  const std::vector<gltf::DataUri> pictures = pictures_of(page);
  ASSERT_GT(pictures.size(), 0U);
  ASSERT_EQ(pictures.size() % 3, 0U);
  int of_maps = 0, of_faces = 0;
  for (size_t i = 0; i < pictures.size(); ++i)
    (i % 3 == 2 ? of_maps : of_faces) += red_pixels(pictures[i]);
  EXPECT_GT(of_maps, 50);
  EXPECT_GT(of_maps, of_faces);
}

TEST_F(SnapshotOfTheEmbeddedHead, ReportsAndIsRenewedOnlyWithAReason) {
  const std::string junit = at("report.xml"), page = at("report.html");
  ASSERT_EQ(check("rig.glb", "--tolerance 0.5 --junit " + junit + " --report " + page).code, 0);
  EXPECT_NE(text_of(junit).find("failures=\"0\""), std::string::npos);
  EXPECT_NE(text_of(page).find("</html>"), std::string::npos);

  fs::copy_file(at("snapshot.json"), at("renewed.json"), fs::copy_options::overwrite_existing);
  const Outcome refused = run("snapshot record " + at("rig.glb") + " -o " + at("renewed.json"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("--reason"), std::string::npos) << refused.err;
  EXPECT_EQ(text_of(at("renewed.json")), text_of(at("snapshot.json")));
  const Outcome renewed =
      run("snapshot record " + at("rig.glb") + " -o " + at("renewed.json") + " --reason 'softer lips'");
  EXPECT_EQ(renewed.code, 0) << renewed.err;
  const ordered_json json = ordered_json::parse(text_of(at("renewed.json")));
  EXPECT_EQ(json["reasons"], (ordered_json{"first recorded", "softer lips"}));
  EXPECT_GT(json["poses"].size(), 100U);
  EXPECT_EQ(run("snapshot diff " + at("renewed.json") + " --against " + at("snapshot.json")).code, 0);
  EXPECT_EQ(run("snapshot check " + at("rig.glb") + " --against " + at("rig.glb")).code, 1);
  EXPECT_EQ(run("snapshot check " + at("rig.glb")).code, 2);
  EXPECT_EQ(run("snapshot").code, 2);
}

}  // namespace
}  // namespace fascia::cli
