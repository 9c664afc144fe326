// What becomes of files: outputs that would destroy inputs, places that are not there, text as other tools
// write it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "builder/rigging/embedded_head.h"
#include "formats/scene.h"
#include "gltf/read/container.h"
#include "rig/read/read.h"
#include "rig/write/write.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class FilesOfTheTool : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / "fascia_cli_files_test");
    fs::remove_all(*folder);
    fs::create_directories(*folder);
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    const Outcome built = run("build " + at("head.obj") + " --detail low -o " + at("rig.glb"));
    ASSERT_EQ(built.code, 0) << built.err;
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
  }

  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static Outcome run(const std::string& arguments) { return run_tool(*folder, arguments); }

  static fs::path* folder;
};

fs::path* FilesOfTheTool::folder = nullptr;

TEST_F(FilesOfTheTool, AnOutputNeverDestroysItsInput) {
  const std::string before = text_of(at("rig.glb"));
  fs::create_hard_link(at("rig.glb"), at("same.glb"));
  for (const char* output : {"rig.glb", "same.glb", "./../fascia_cli_files_test/rig.glb"})
    for (const std::string& command : {std::string("pose "), std::string("bake ")}) {
      const Outcome outcome = run(command + at("rig.glb") + " -o " + at(output));
      EXPECT_EQ(outcome.code, 1) << command << output;
      EXPECT_NE(outcome.err.find("another name"), std::string::npos) << outcome.err;
    }
  EXPECT_EQ(text_of(at("rig.glb")), before);
}

TEST_F(FilesOfTheTool, AFailureLeavesNoEmptyFolder) {
  std::ofstream(at("no_mesh.obj")) << "v 0 0 0\n";
  fs::create_directory(at("folder_of_reports"));
  for (const std::string& reports : {at("new_folder"), at("new_folder/"), at("folder_of_reports")})
    for (const std::string& command :
         {"build " + at("no_mesh.obj") + " -o " + at("x.glb") + " --report " + reports,
          "fit " + at("rig.glb") + " --target " + at("no_mesh.obj") + " -o " + at("x.json") + " --report " +
              reports,
          "demo --anatomy " + at("no_such_anatomy") + " --out " + reports}) {
      EXPECT_EQ(run(command).code, 1) << command;
      EXPECT_FALSE(fs::exists(at("new_folder"))) << command;
      EXPECT_TRUE(fs::exists(at("folder_of_reports"))) << command;
    }
}

TEST_F(FilesOfTheTool, NoCommandWritesOverAnythingItReads) {
  const std::string rig = " " + at("rig.glb") + " ", skull = " " + at("head.obj") + " ", in = at("input");
  formats::write_text(in, "what was there before");
  for (const std::string& words :
       {"build " + in + " -o ",
        "build" + skull + "--landmarks " + in + " -o ",
        "build" + skull + "--edits " + in + " -o ",
        "build" + skull + "--muscles " + in + " -o ",
        "pose " + in + " -o ",
        "pose" + rig + "--activations " + in + " -o ",
        "play " + in + " --curves " + at("x.csv") + " -o ",
        "play" + rig + "--curves " + in + " -o ",
        "bake " + in + " -o ",
        "export " + in + " --part skin -o ",
        "render " + in + " -o ",
        "render" + rig + "--activations " + in + " -o ",
        "render" + rig + "--curves " + in + " -o ",
        "check " + in + " --sheet ",
        "fit " + in + " --target " + at("x.obj") + " -o ",
        "fit" + rig + "--target " + in + " -o ",
        "fit" + rig + "--target " + at("x.json") + " --neutral " + in + " -o ",
        "calibrate " + in + " --scans " + at(".") + " -o ",
        "calibrate" + rig + "--scans " + in + " -o ",
        "face " + in + " -o ",
        "face" + skull + "--landmarks " + in + " -o ",
        "face" + skull + "--depths " + in + " -o ",
        "snapshot record " + in + " -o ",
        "snapshot record" + rig + "--poses " + in + " -o ",
        "snapshot record" + rig + "--curves " + in + " -o ",
        "snapshot check" + rig + "--against " + in + " --junit ",
        "snapshot check" + rig + "--against " + in + " --report ",
        "snapshot check" + rig + "--against " + at("x.json") + " --curves " + in + " --junit "}) {
    const Outcome outcome = run(words + in);
    EXPECT_EQ(outcome.code, 1) << words << outcome.err;
    EXPECT_NE(outcome.err.find("another name"), std::string::npos) << words << outcome.err;
    EXPECT_EQ(text_of(in), "what was there before") << words;
  }
}

TEST_F(FilesOfTheTool, NoCommandWritesOneOutputOverAnother) {
  const std::string rig = " " + at("rig.glb") + " ", skull = " " + at("head.obj") + " ";
  fs::create_directories(at("both"));
  fs::create_directory_symlink(at("both"), at("linked"));
  for (const std::string& words :
       {"snapshot check" + rig + "--against " + at("x.json") + " --report " + at("both/a") + " --junit " +
            at("both/../both/a"),
        "snapshot check" + rig + "--against " + at("x.json") + " --report " + at("both/a") + " --junit " +
            at("linked/a"),
        "face" + skull + "-o " + at("both/a.png") + " --sheet " + at("both/a.png"),
        "build" + skull + "-o " + at("both/report.html") + " --report " + at("both"),
        "fit" + rig + "--target " + at("head.obj") + " -o " + at("both/report.md") + " --report " +
            at("both")}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 1) << words;
    EXPECT_NE(outcome.err.find("another name"), std::string::npos) << words << outcome.err;
    EXPECT_TRUE(fs::is_empty(at("both"))) << words;
  }
}

TEST_F(FilesOfTheTool, FilesOutsideAreOpenedWhereTheAdviceIsFollowed) {
  fs::create_directories(at("inside"));
  std::ofstream(at("buffer.bin")) << "1234";
  std::ofstream(at("inside/head.gltf"))
      << R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "../buffer.bin", "byteLength": 4}]})";
  const std::string head = at("inside/head.gltf");
  for (const std::string& words :
       {"build " + head + " -o " + at("x.glb"),
        "fit " + at("rig.glb") + " --target " + head + " -o " + at("x.json"),
        "face " + head + " -o " + at("x.glb"),
        "calibrate " + at("rig.glb") + " --scans " + head + " -o " + at("x.glb")}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 1) << words;
    EXPECT_NE(outcome.err.find("lies outside the folder"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("--allow-outside"), std::string::npos) << outcome.err;
    EXPECT_EQ(run(words + " --allow-outside").err.find("lies outside"), std::string::npos) << words;
  }
}

TEST_F(FilesOfTheTool, AFolderThatIsNotThereIsRefusedNotMade) {
  const Outcome outcome = run("pose " + at("rig.glb") + " -o " + at("nowhere/x.glb"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("is not there"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(at("nowhere")));
}

TEST_F(FilesOfTheTool, NamesNeedNotBeUtf8) {
  const Outcome outcome = run("info " + at("h\xE4ut.glb") + " --json");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(json::parse(outcome.out).contains("error")) << outcome.out;
}

TEST_F(FilesOfTheTool, OutputThatCannotBeWrittenIsAFailure) {
  for (const char* option : {" --json", "", " --channels"}) {
    const int status = std::system(
        (test::tool().string() + " info " + at("rig.glb") + option + " >/dev/full 2>" + at("said.txt"))
            .c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << option;
    EXPECT_NE(text_of(at("said.txt")).find("standard output cannot be written"), std::string::npos) << option;
  }
}

TEST_F(FilesOfTheTool, AMisspeltLandmarkIsWarnedOfOnce) {
  json landmarks = json::parse(text_of(at("landmarks.json")));
  landmarks["landmarks"]["nasionn"] = landmarks["landmarks"]["nasion"];
  landmarks["landmarks"]["qqqqqqqq"] = landmarks["landmarks"]["nasion"];
  std::ofstream(at("misspelt.json")) << landmarks.dump();
  const Outcome outcome = run("build " + at("head.obj") + " --landmarks " + at("misspelt.json") +
                              " --detail low -o " + at("misspelt.glb"));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name : {"'nasionn'", "'qqqqqqqq'"}) {
    const size_t first = outcome.err.find(name);
    ASSERT_NE(first, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(name, first + 1), std::string::npos) << outcome.err;
  }
}

/// A rig with other notes of its source's.
void write_rig_with_notes(const std::string& from, const std::string& to, const std::string& notes) {
  const rig::RigFile file = rig::read(formats::read_bytes(from));
  rig::GltfSource source = rig::original({file.json, file.bin, {}, file.source});
  source.record = file.source;
  source.record.json = notes;
  const std::vector<uint8_t> bytes = rig::write(source, file.rig);
  formats::write_bytes(to, bytes.data(), bytes.size());
}

TEST_F(FilesOfTheTool, DeepJsonIsRefusedByEveryCommandThatReadsIt) {
  const std::string deep =
      R"({"asset":{"version":"2.0"},"extras":)" + std::string(50000, '[') + std::string(50000, ']') + "}";
  const std::vector<uint8_t> glb = gltf::glb_bytes(deep, {});
  formats::write_bytes(at("deep.glb"), glb.data(), glb.size());
  formats::write_text(at("deep.json"), deep);
  write_rig_with_notes(at("rig.glb"), at("noted.glb"), deep);
  for (const std::string& command :
       {"build " + at("deep.glb") + " -o " + at("x.glb"), "info " + at("deep.glb"),
        "play " + at("rig.glb") + " --curves " + at("deep.glb") + " -o " + at("x.glb"),
        "play " + at("rig.glb") + " --curves " + at("deep.json") + " -o " + at("x.glb"),
        "pose " + at("rig.glb") + " --activations " + at("deep.json") + " -o " + at("x.glb"),
        "pose " + at("noted.glb") + " --set jaw_open=0.5 -o " + at("x.obj"),
        "fit " + at("rig.glb") + " --target " + at("deep.json") + " -o " + at("x.json"),
        "build " + at("head.obj") + " --edits " + at("deep.json") + " -o " + at("x.glb"),
        "build " + at("head.obj") + " --muscles " + at("deep.json") + " -o " + at("x.glb"),
        "build " + at("head.obj") + " --landmarks " + at("deep.json") + " -o " + at("x.glb")}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 1) << command;
    EXPECT_NE(outcome.err.find("nested deeper"), std::string::npos) << outcome.err;
  }
}

/// The head with every vertex moved by `offset` and lines ended by CR alone.
void write_far_head(const std::string& from, const std::string& to, const Vec3& offset) {
  std::istringstream lines(text_of(from));
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    double x, y, z;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) {
      char moved[128];
      std::snprintf(moved, sizeof moved, "v %.6f %.6f %.6f", x + offset[0], y + offset[1], z + offset[2]);
      line = moved;
    }
    text += line + "\r";
  }
  formats::write_text(to, text);
}

TEST_F(FilesOfTheTool, AHeadFarFromTheOriginWithOldLineEndsIsPosedLikeTheOther) {
  const Vec3 offset(1e8, -2e7, 3e7);  // millimetres: 100 km and more
  write_far_head(at("head.obj"), at("far.obj"), offset);
  const Outcome built = run("build " + at("far.obj") + " --detail low -o " + at("far.glb") + " --json");
  ASSERT_EQ(built.code, 0) << built.err;
  const json matrix = json::parse(built.out)["input"]["input_to_metres"];
  EXPECT_GT(std::abs(matrix[0][3].get<double>()), 9e4);
  for (const char* rig : {"rig", "far"})
    ASSERT_EQ(run("pose " + at(std::string(rig) + ".glb") + " --set jaw_open=0.6 -o " +
                  at(std::string(rig) + ".posed.obj"))
                  .code,
              0);
  const formats::Scene near = formats::read(at("rig.posed.obj")), far = formats::read(at("far.posed.obj"));
  ASSERT_EQ(near.meshes.size(), far.meshes.size());
  double moved = 0.0;
  std::vector<double> apart;
  const formats::Scene rest = formats::read(at("head.obj"));
  for (size_t m = 0; m < near.meshes.size(); ++m)
    for (size_t v = 0; v < near.meshes[m].positions.size(); ++v) {
      const Vec3& here = near.meshes[m].positions[v];
      apart.push_back((far.meshes[m].positions[v] + far.offset - offset - here).norm());
      moved = std::max(moved, (here - rest.meshes[m].positions[v]).norm());
    }
  EXPECT_GT(moved, 10.0);
  // Millimetres. A head moved a little is cut into slightly other elements, as one near the origin is too.
  std::sort(apart.begin(), apart.end());
  EXPECT_LT(std::accumulate(apart.begin(), apart.end(), 0.0) / static_cast<double>(apart.size()), 0.05);
  EXPECT_LT(apart[apart.size() * 95 / 100], 0.25);
  // All but digits of vertices is as it came, line ends too.
  const std::string text = text_of(at("far.posed.obj"));
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const std::string source = text_of(at("far.obj"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), std::count(source.begin(), source.end(), '\r'));
}

}  // namespace
}  // namespace fascia::cli
