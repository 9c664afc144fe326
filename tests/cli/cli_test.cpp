// The tool as a user runs it: exit codes, messages, outputs.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "builder/rigging/embedded_head.h"
#include "formats/scene.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Tool : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / "fascia_cli_test");
    fs::remove_all(*folder);
    fs::create_directories(*folder);
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    built = new Outcome(run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
                            " --detail low -o " + at("rig.glb") + " --json"));
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
    delete built;
  }

  static std::string at(const std::string& name) { return (*folder / name).string(); }

  static Outcome run(const std::string& arguments) { return run_tool(*folder, arguments); }

  static void expect_input_error(const std::string& arguments, const std::string& says) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << arguments << "\n" << outcome.err;
  }

  static fs::path* folder;
  static Outcome* built;
};

fs::path* Tool::folder = nullptr;
Outcome* Tool::built = nullptr;

TEST_F(Tool, FindsTheLandmarksItself) {
  const Outcome found = run("build " + at("head.obj") + " --detail low -o " + at("found.glb") + " --json");
  ASSERT_EQ(found.code, 0) << found.err;
  const json report = json::parse(found.out);
  EXPECT_EQ(report["landmarks"]["given"], 0);
  EXPECT_GT(report["landmarks"]["found"], 100);
  EXPECT_TRUE(report["landmarks"]["low_confidence"].empty()) << report["landmarks"];
}

TEST_F(Tool, BuildReportsOneJsonObject) {
  ASSERT_EQ(built->code, 0) << built->err;
  const json report = json::parse(built->out);
  EXPECT_EQ(report["input"]["units"], "mm");
  EXPECT_EQ(report["input"]["input_to_metres"].size(), 4u);
  EXPECT_GE(report["stages"].size(), 5u);
  EXPECT_EQ(report["skull"]["bone_outside_skin"], 0);
  EXPECT_EQ(report["smas"]["outside_layers"], 0);
  EXPECT_GT(report["smas"]["min_angle_deg"].get<double>(), 10.0);
  EXPECT_GT(report["tissue"]["low"]["nodes"].get<int>(), 500);
  std::set<std::string> names;
  for (const json& muscle : report["muscles"])
    names.insert(muscle["name"].get<std::string>());
  for (const char* name :
       {"zygomaticus_major_left", "frontalis_medial_right", "mentalis_left", "depressor_anguli_oris_right",
        "orbicularis_oculi_left", "orbicularis_oris_marginal_upper_left", "corrugator_supercilii_left",
        "levator_labii_superioris_right"})
    EXPECT_TRUE(names.count(name) || names.count(std::string(name).substr(0, std::string(name).rfind('_'))))
        << name;
}

TEST_F(Tool, BuildWritesOnePageThatNeedsNothingElse) {
  const Outcome outcome =
      run("build " + at("head.obj") + " --detail low -o " + at("shown.glb") + " --report " + at("shown"));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string page = text_of(at("shown/report.html"));
  ASSERT_GT(page.size(), 10000u);
  EXPECT_EQ(page.find("http"), std::string::npos) << "no network";
  EXPECT_EQ(page.find("src=\"") != std::string::npos,
            page.find("data:image/png;base64,iVBORw0KGgo") != std::string::npos);
  for (const char* part :
       {"Warnings", "Landmarks", "zygion_left", "SMAS", "Muscles", "+1 SD", "skull", "</html>"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  size_t pictures = 0;
  for (size_t p = page.find("<img "); p != std::string::npos; p = page.find("<img ", p + 1))
    ++pictures;
  EXPECT_TRUE(pictures == 15 || page.find("No pictures: ") != std::string::npos) << pictures;
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(at("shown")))
    files += entry.is_regular_file();
  EXPECT_EQ(files, 1u) << "nothing half written is left";
  // What fails before the page leaves no page.
  EXPECT_EQ(run("build " + at("nobody.obj") + " -o " + at("none.glb") + " --report " + at("none")).code, 1);
  EXPECT_FALSE(std::filesystem::exists(at("none/report.html")));
}

TEST_F(Tool, UsageErrorExitsWith2) {
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("sculpt").code, 2);
  EXPECT_EQ(run("build").code, 2);
  EXPECT_EQ(run("build " + at("head.obj") + " -o " + at("x.glb") + " --detail enormous").code, 2);
  EXPECT_EQ(run("export " + at("rig.glb") + " --part liver -o " + at("x.obj")).code, 2);
  EXPECT_EQ(run("render " + at("rig.glb") + " --no-such-flag -o " + at("x.png")).code, 2);
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_EQ(run("--version").code, 0);
  EXPECT_NE(run("bild").err.find("did you mean 'build'"), std::string::npos);
}

TEST_F(Tool, VersionTellsHowItWasBuilt) {
  const auto told = run("--version");
  EXPECT_EQ(told.code, 0);
  EXPECT_EQ(told.out.find("fascia "), 0U);
  for (const char* fact :
       {"\ncommit: ", "\ncompiler: ", "\nbuild: ", "\nvector unit: ", "Eigen 3.", "oneTBB 20"})
    EXPECT_NE(told.out.find(fact), std::string::npos) << fact;
  EXPECT_EQ(told.out.find("/home"), std::string::npos) << "a place on the builder's machine";
}

TEST_F(Tool, EveryCommandExplainsItself) {
  for (const char* command :
       {"build", "info", "export", "pose", "play", "bake", "render", "check", "demo", "fit", "manual"}) {
    const Outcome help = run(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0) << help.err;
    EXPECT_NE(help.out.find(std::string("Usage: fascia ") + command), std::string::npos) << help.out;
    EXPECT_NE(help.out.find("(default: "), std::string::npos) << help.out;
  }
}

TEST_F(Tool, FoldersThatAreNotThereAreNotMade) {
  for (const std::string& arguments :
       {"build " + at("head.obj") + " -o " + at("no/x.glb"),
        "build " + at("head.obj") + " -o " + at("x.glb") + " --report " + at("no/x"),
        "bake " + at("rig.glb") + " --level low --format obj-sequence -o " + at("no/shapes"),
        "demo --out " + at("no/out")})
    expect_input_error(arguments, "/no' is not there");
  EXPECT_FALSE(fs::exists(at("no")));
}

TEST_F(Tool, BakedFilesBearTheNameOfTheirFormat) {
  expect_input_error("bake " + at("rig.glb") + " --level low --format glb -o " + at("x.pc2"),
                     "--format glb writes .glb");
  EXPECT_FALSE(fs::exists(at("x.pc2")));
}

TEST_F(Tool, InputErrorExitsWith1AndNamesTheFile) {
  std::ofstream(at("empty.glb"));
  std::ofstream(at("text.glb")) << "hello";
  const std::string rig = text_of(at("rig.glb"));
  std::ofstream(at("cut.glb"), std::ios::binary) << rig.substr(0, rig.size() / 2);
  for (const char* command : {"info ", "pose ", "render ", "bake "}) {
    const std::string tail =
        std::string(command) == "info "
            ? ""
            : std::string(" -o ") + at(std::string(command) == "render " ? "x.png" : "x.glb");
    expect_input_error(command + at("missing.glb") + tail, "missing.glb");
    expect_input_error(command + at("empty.glb") + tail, "empty");
    expect_input_error(command + at("text.glb") + tail, "text.glb");
    expect_input_error(command + at("cut.glb") + tail, "cut.glb");
    expect_input_error(command + at("head.obj") + tail, "head.obj");
  }
  expect_input_error("build " + at("missing.obj") + " -o " + at("x.glb"), "missing.obj");
  std::ofstream(at("cube.obj"))
      << ("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
          "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  expect_input_error("build " + at("cube.obj") + " -o " + at("x.glb"), "no face was found");
  expect_input_error("build " + at("head.obj") + " --landmarks " + at("text.glb") + " -o " + at("x.glb"),
                     "text.glb");
  expect_input_error(
      "build " + at("head.obj") + " --landmarks " + at("landmarks.json") + " -o " + at("x.fbx"), ".glb");
  expect_input_error("pose " + at("rig.glb") + " --set no_such_muscle=1 -o " + at("x.glb"), "no_such_muscle");
  expect_input_error("pose " + at("rig.glb") + " --set zigomaticus_major_left=1 -o " + at("x.glb"),
                     "did you mean 'zygomaticus_major_left'");
  expect_input_error("pose " + at("rig.glb") + " --set arkit:mouthSmileLeftt=1 -o " + at("x.glb"),
                     "did you mean 'arkit:mouthSmileLeft'");
  expect_input_error("bake " + at("rig.glb") + " --shapes arkti -o " + at("x.glb"), "did you mean 'arkit'");
  expect_input_error("pose " + at("rig.glb") + " --set jaw_open -o " + at("x.glb"), "NAME=VALUE");
  expect_input_error(
      "pose " + at("rig.glb") + " --activations " + at("landmarks.json") + " -o " + at("x.glb"),
      "activations");
  expect_input_error("play " + at("rig.glb") + " --curves " + at("landmarks.json") + " -o " + at("x.glb"),
                     "landmarks.json");
  expect_input_error("render " + at("rig.glb") + " --layers liver -o " + at("x.png"), "liver");
  expect_input_error("render " + at("rig.glb") + " --view inside -o " + at("x.png"), "inside");
  expect_input_error("batch " + at("rig.glb") + " -o " + at("x"), "not a JSON object");
  EXPECT_FALSE(fs::exists(at("x.glb")));
  EXPECT_FALSE(fs::exists(at("x.png")));
}

TEST_F(Tool, FailureWithJsonIsJsonToo) {
  const Outcome outcome = run("info " + at("missing.glb") + " --json");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(json::parse(outcome.out)["error"].get<std::string>().find("missing.glb"), std::string::npos);
}

TEST_F(Tool, InfoListsChannelsAndValidates) {
  const json info = json::parse(run("info " + at("rig.glb") + " --channels --validate --json").out);
  EXPECT_EQ(info["valid"], true);
  EXPECT_EQ(info["sets"]["arkit"], 52);
  EXPECT_EQ(info["channel_list"].size(), info["channels"].get<size_t>());
}

TEST_F(Tool, InfoReportsRigsThatTheRuntimeRefuses) {
  // The knots at which a member's response is given have to rise: the first is put behind the others.
  std::string file = text_of(at("rig.glb"));
  uint32_t json_length = 0;
  std::memcpy(&json_length, file.data() + 12, sizeof json_length);
  const json root = json::parse(file.substr(20, json_length));
  for (const json& set : root["extensions"]["FASCIA_actuation"]["sets"])
    if (set.contains("responseWeights")) {
      const json& knots = root["accessors"][set["responseWeights"].get<size_t>()];
      const json& view = root["bufferViews"][knots["bufferView"].get<size_t>()];
      const float behind = 0.99F;
      std::memcpy(file.data() + 28 + json_length + view.value("byteOffset", 0) + knots.value("byteOffset", 0),
                  &behind, sizeof behind);
      break;
    }
  std::ofstream(at("unsound.glb"), std::ios::binary) << file;
  const Outcome outcome = run("info " + at("unsound.glb") + " --validate");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("response"), std::string::npos) << outcome.err;
}

/// The lines of two texts that differ, as pairs.
int differing_lines(const std::string& a, const std::string& b, bool* only_vertices) {
  std::istringstream left(a), right(b);
  int count = 0;
  *only_vertices = true;
  std::string x, y;
  while (true) {
    const bool more_left = static_cast<bool>(std::getline(left, x)),
               more_right = static_cast<bool>(std::getline(right, y));
    if (more_left != more_right) *only_vertices = false;
    if (!more_left || !more_right) return count;
    if (x == y) continue;
    ++count;
    *only_vertices = *only_vertices && x.rfind("v ", 0) == 0 && y.rfind("v ", 0) == 0;
  }
}

TEST_F(Tool, PosedObjDiffersOnlyInItsVertices) {
  ASSERT_EQ(run("pose " + at("rig.glb") + " -o " + at("rest.obj")).code, 0);
  EXPECT_EQ(text_of(at("rest.obj")), text_of(at("head.obj"))) << "zero activation is rest, to the byte";
  ASSERT_EQ(run("pose " + at("rig.glb") + " --set jaw_open=1 -o " + at("open.obj")).code, 0);
  bool only_vertices = false;
  EXPECT_GT(differing_lines(text_of(at("head.obj")), text_of(at("open.obj")), &only_vertices), 200);
  EXPECT_TRUE(only_vertices);
}

TEST_F(Tool, PosedGlbKeepsMeshesAndCounts) {
  ASSERT_EQ(run("pose " + at("rig.glb") + " --set arkit:jawOpen=0.5 -o " + at("pose.glb")).code, 0);
  const formats::Scene rest = formats::read(at("rig.glb")), posed = formats::read(at("pose.glb"));
  ASSERT_EQ(rest.meshes.size(), posed.meshes.size());
  for (size_t m = 0; m < rest.meshes.size(); ++m) {
    EXPECT_EQ(rest.meshes[m].name, posed.meshes[m].name);
    EXPECT_EQ(rest.meshes[m].positions.size(), posed.meshes[m].positions.size());
    EXPECT_EQ(rest.meshes[m].triangles, posed.meshes[m].triangles);
  }
}

#ifdef FASCIA_HAS_BULLET
TEST_F(Tool, LoadsBulletsModuleForItsSolver) {
  std::ofstream(at("still.csv")) << "time,jaw_open\n0,0\n0.2,0.1\n";
  const Outcome played = run("play " + at("rig.glb") + " --curves " + at("still.csv") +
                             " --solver bullet --fps 30 -o " + at("bullet.glb"));
  EXPECT_EQ(played.code, 0) << played.err;
}
#endif

TEST_F(Tool, WarnsOfClampedValues) {
  const Outcome outcome = run("pose " + at("rig.glb") + " -o " + at("wide.glb") +
                              " --set jaw_open=5 --set arkit:mouthSmileLeft=1.5 --set arkit:browInnerUp=1 "
                              "--set jaw_lateral=-1");
  EXPECT_EQ(outcome.code, 0);
  for (const std::string says : {"'jaw_open': 5 lies beyond its range, 0 to 1",
                                 "'arkit:mouthSmileLeft': 1.5 lies beyond its range, 0 to 1"})
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("browInnerUp"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("jaw_lateral"), std::string::npos) << outcome.err;
}

TEST_F(Tool, ExportsEveryPart) {
  for (const char* part : {"skin", "cranium", "mandible", "teeth", "eyes", "smas", "muscles", "all"})
    for (const char* extension : {".ply", ".obj", ".glb"}) {
      const std::string out = at(std::string(part) + extension);
      const Outcome outcome = run("export " + at("rig.glb") + " --part " + part + " -o " + out);
      EXPECT_EQ(outcome.code, 0) << part << extension << outcome.err;
      EXPECT_GT(fs::file_size(out), 200u);
    }
  EXPECT_NE(text_of(at("muscles.obj")).find("\ng zygomaticus_major"), std::string::npos);
  expect_input_error("export " + at("rig.glb") + " --part muscles -o " + at("m.stl"), "STL");
}

TEST_F(Tool, LandmarksGoOutAndComeBackIn) {
  ASSERT_EQ(run("export " + at("rig.glb") + " --part landmarks -o " + at("out_landmarks.json")).code, 0);
  const json out = json::parse(text_of(at("out_landmarks.json")));
  EXPECT_EQ(out["units"], "mm");
  EXPECT_TRUE(out["landmarks"]["nasion"].contains("bone"));
  const Outcome again = run("build " + at("head.obj") + " --landmarks " + at("out_landmarks.json") +
                            " --detail low -o " + at("again.glb"));
  EXPECT_EQ(again.code, 0) << again.err;

  // Of units without a name the metres are said.
  ASSERT_EQ(run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
                " --units 0.00109 --detail low -o " + at("odd.glb"))
                .code,
            0);
  ASSERT_EQ(run("export " + at("odd.glb") + " --part landmarks -o " + at("odd_landmarks.json")).code, 0);
  const json odd = json::parse(text_of(at("odd_landmarks.json")));
  ASSERT_TRUE(odd["units"].is_number()) << odd["units"];
  EXPECT_NEAR(odd["units"].get<double>(), 0.00109, 1e-8);
  const Outcome as_written = run("build " + at("head.obj") + " --landmarks " + at("odd_landmarks.json") +
                                 " --detail low -o " + at("again.glb"));
  EXPECT_EQ(as_written.code, 0) << as_written.err;
}

TEST_F(Tool, PlaysCurvesIntoWeightsAndPointers) {
  std::ofstream(at("curves.csv"))
      << "time,jaw_open,arkit:mouthSmileLeft,nobody_knows_me\n0,0,0,0\n0.25,0.5,0,1\n0.5,0,1,0\n";
  const Outcome outcome = run("play " + at("rig.glb") + " --curves " + at("curves.csv") + " --fps 30 -o " +
                              at("play.glb") + " --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["frames"], 16);
  EXPECT_LE(report["morph_targets"].get<int>(), 64);
  EXPECT_LE(report["largest_error_mm"].get<double>(), 0.1);
  EXPECT_EQ(report["unmatched"], json::array({"nobody_knows_me"}));
  EXPECT_EQ(report["resets"], 0);
}

TEST_F(Tool, BakesArkitByItsNames) {
  const Outcome outcome = run("bake " + at("rig.glb") + " --shapes arkit -o " + at("arkit.glb") + " --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json names = json::parse(outcome.out)["shapes"];
  EXPECT_EQ(names.size(), 52u);
  EXPECT_NE(std::find(names.begin(), names.end(), "jawOpen"), names.end());
  EXPECT_NE(text_of(at("arkit.glb")).find("\"targetNames\":[\""), std::string::npos);
}

TEST_F(Tool, Draws) {
  for (const char* view : {"front", "side", "three-quarter", "back"}) {
    const Outcome outcome = run("render " + at("rig.glb") +
                                " --set jaw_open=0.5 --layers skin,skull,muscles,smas --size 200 --view " +
                                view + " -o " + at("picture.png"));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_GT(fs::file_size(at("picture.png")), 2000u);
  }
}

TEST_F(Tool, DrawsEveryLayerAnotherWay) {
  std::set<std::string> pictures;
  const std::vector<std::string> layers = {"skin",    "eyes",      "teeth",   "skull",     "fat",   "smas",
                                           "muscles", "ligaments", "lattice", "landmarks", "strain"};
  for (const std::string& layer : layers) {
    const Outcome outcome = run("render " + at("rig.glb") + " --layers " + layer +
                                " --size 64 --samples 1 -o " + at("layer.png"));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    pictures.insert(text_of(at("layer.png")));
  }
  EXPECT_EQ(pictures.size(), layers.size());
}

}  // namespace
}  // namespace fascia::cli
