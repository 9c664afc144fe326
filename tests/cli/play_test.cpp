// Takes as people have them, played by the tool: late starts, other rates, other names, caches.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "builder/rigging/embedded_head.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Play : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / ("fascia_play_test_" + std::to_string(getpid())));
    fs::create_directories(*folder);
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    const Outcome built = run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
                              " --detail low -o " + at("rig.glb"));
    ASSERT_EQ(built.code, 0) << built.err;
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
  }
  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static Outcome run(const std::string& arguments) { return run_tool(*folder, arguments); }
  static std::string curves(const std::string& text) {
    std::ofstream(at("take.csv"), std::ios::binary) << text;
    return " --curves " + at("take.csv");
  }
  static json play(const std::string& text, const std::string& more = "",
                   const std::string& out = "out.glb") {
    const Outcome outcome =
        run("play " + at("rig.glb") + curves(text) + " --json -o " + at(out) + " " + more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    said = outcome.err;
    return outcome.code == 0 ? json::parse(outcome.out) : json();
  }
  static json gltf(const std::string& name) {
    const std::string bytes = text_of(at(name));
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    return json::parse(bytes.substr(20, length));
  }

  static fs::path* folder;
  static std::string said;
};

fs::path* Play::folder = nullptr;
std::string Play::said;

TEST_F(Play, ATakeStartsAtItsFirstKey) {
  const json epoch = play("time,jawOpen\n1732780800.0,0\n1732780800.5,1\n", "--fps 30");
  EXPECT_EQ(epoch["frames"], 16);
  EXPECT_EQ(epoch["start_seconds"], 1732780800.0);
  const json before = play("time,jawOpen\n-0.5,0\n0,1\n", "--fps 30");
  EXPECT_EQ(before["frames"], 16);
  EXPECT_EQ(before["start_seconds"], -0.5);
  // The same motion: the same file but for its name.
  EXPECT_EQ(before["largest_error_mm"], epoch["largest_error_mm"]);
}

TEST_F(Play, TheLastRowIsPlayedWhereItFallsBetweenFrames) {
  const json whole = play("time,jawOpen\n0,0\n0.5,0\n0.51,1\n", "--fps 30");
  EXPECT_EQ(whole["frames"], 17);
  EXPECT_GT(whole["morph_targets"], 0) << "the jaw opens in the last hundredth of a second only";
  const json piece = play("time,jawOpen\n0,0\n0.5,0\n0.51,1\n", "--fps 30 --to 0.49");
  EXPECT_EQ(piece["frames"], 16);
  EXPECT_EQ(piece["morph_targets"], 0) << "beyond its end the piece holds";
}

TEST_F(Play, TimecodesTellTheirRate) {
  std::string take = "Timecode,BlendShapeCount,JawOpen,HeadYaw,LeftEyeYaw\n";
  for (int f = 0; f < 45; ++f) {
    char row[80];
    std::snprintf(row, sizeof row, "11:02:%02d:%02d.250,61,%.4f,%.4f,0.1\n", 7 + f / 30, f % 30, f / 90.0,
                  f / 45.0);
    take += row;
  }
  const json thirty = play(take, "--fps 30");
  EXPECT_EQ(thirty["frames"], 45);
  EXPECT_NE(said.find("30 frames a second"), std::string::npos) << said;
  EXPECT_NE(said.find("--head keeps it"), std::string::npos) << said;
  EXPECT_EQ(play(take, "--fps 30 --fps-in 60")["frames"], 38);  // half a second of each is missing
  const Outcome slow = run("play " + at("rig.glb") + curves(take) + " --fps-in 15 -o " + at("out.glb"));
  EXPECT_EQ(slow.code, 1);
  EXPECT_NE(slow.err.find("frame 15 cannot be in a second of 15"), std::string::npos) << slow.err;
  play(take, "--fps 30 --head");
  const json file = gltf("out.glb");
  size_t turning = 0;
  for (const json& channel : file["animations"].back()["channels"])
    turning += channel["target"]["path"] == "rotation";
  EXPECT_GE(turning, 1U);
}

TEST_F(Play, OtherProgramsNamesDriveTheRigAndTheRestIsOneLine) {
  const json report = play(
      "time,mouthSmile_L,Joy,viseme_PP,AU12_r,eyesClosed,nobody,noone\n0,0,0,0,0,0,1,1\n0.2,0.5,0,0,0,0,1,"
      "1\n",
      "--fps 30");
  EXPECT_EQ(report["unmatched"], json::array({"nobody", "noone"}));
  EXPECT_NE(said.find("2 of 7 curves drive nothing in the rig: nobody, noone"), std::string::npos) << said;
  const Outcome pose = run("pose " + at("rig.glb") + " --set mouthSmile_L=1 -o " + at("smile.obj"));
  EXPECT_EQ(pose.code, 0) << pose.err;
  const Outcome wrong = run("pose " + at("rig.glb") + " --set mouthSmirk=1 -o " + at("smile.obj"));
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.err.find("mouthSmirk"), std::string::npos);
  EXPECT_EQ(wrong.err.find("fascia_"), std::string::npos) << wrong.err;
  const Outcome names = run("info --names");
  EXPECT_EQ(names.code, 0) << names.err;
  EXPECT_NE(names.out.find("AU12_r"), std::string::npos);
}

TEST_F(Play, OneThingInTwoSpellingsIsRefused) {
  std::ofstream(at("twice.csv")) << "time,jawOpen,blendShapes.JawOpen\n0,0,0\n1,1,1\n";
  std::ofstream(at("twice.json"))
      << R"({"fps": 30, "channels": {"jawOpen": [0, 1], "blendShapes.JawOpen": [0, 1]}})";
  for (const char* name : {"twice.csv", "twice.json"}) {
    const Outcome outcome = run("play " + at("rig.glb") + " --curves " + at(name) + " -o " + at("out.glb"));
    EXPECT_EQ(outcome.code, 1) << name;
    EXPECT_NE(outcome.err.find("is there twice"), std::string::npos) << outcome.err;
  }
}

TEST_F(Play, AnotherProgramsNameForTheSameIsLeftOut) {
  const json both = play("time,jawOpen,mouthOpen\n0,0,0\n0.2,0.5,0.5\n", "--fps 30");
  EXPECT_EQ(both["unmatched"], json::array());
  EXPECT_NE(said.find("'mouthOpen' means what another of its columns does"), std::string::npos) << said;
  fs::copy_file(at("out.glb"), at("both.glb"), fs::copy_options::overwrite_existing);
  play("time,jawOpen\n0,0\n0.2,0.5\n", "--fps 30");
  EXPECT_EQ(text_of(at("both.glb")), text_of(at("out.glb"))) << "it counts once";
}

TEST_F(Play, AStillTakeHasAKeyAtItsEndsAndFew) {
  const json report = play("time,jawOpen\n0,0.3\n10,0.3\n", "--fps 60");
  EXPECT_EQ(report["frames"], 601);
  EXPECT_LE(report["keys"].get<int>(), 4);
  EXPECT_LE(report["largest_error_mm"].get<double>(), 0.1);
}

TEST_F(Play, WarnsWhenTargetsAreTooFew) {
  const std::string take = "time,jawOpen,mouthPucker\n0,0,0\n0.3,1,0\n0.6,0,1\n";
  EXPECT_LE(play(take)["largest_error_mm"].get<double>(), 0.1);
  EXPECT_EQ(said.find("morph targets are up to"), std::string::npos) << said;
  const json report = play(take, "--targets 2");
  EXPECT_EQ(report["morph_targets"], 2);
  EXPECT_GT(report["largest_error_mm"].get<double>(), 0.1);
  EXPECT_NE(said.find("2 morph targets are up to"), std::string::npos) << said;
}

uint32_t word(const std::string& bytes, size_t at, bool big = false) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return big ? __builtin_bswap32(value) : value;
}

TEST_F(Play, CachesHoldEveryVertexOfTheInputInItsOrder) {
  const std::string take = "time,jawOpen\n0,0\n0.1,1\n";
  const json pc2 = play(take, "--fps 30", "take.pc2"), mdd = play(take, "--fps 30", "take.mdd");
  ASSERT_EQ(pc2["files"].size(), mdd["files"].size());
  // The head's first vertices, from the OBJ itself.
  std::ifstream obj(at("head.obj"));
  std::vector<std::array<float, 3>> vertices;
  for (std::string line; std::getline(obj, line);) {
    std::array<float, 3> v;
    if (std::sscanf(line.c_str(), "v %f %f %f", &v[0], &v[1], &v[2]) == 3) vertices.push_back(v);
  }
  for (size_t i = 0; i < pc2["files"].size(); ++i) {
    const std::string a = text_of(pc2["files"][i].get<std::string>()),
                      b = text_of(mdd["files"][i].get<std::string>());
    ASSERT_EQ(a.compare(0, 12, std::string("POINTCACHE2\0", 12)), 0);
    const uint32_t points = word(a, 16), frames = word(a, 28);
    EXPECT_EQ(word(a, 12), 1U);
    EXPECT_EQ(frames, 4U);
    ASSERT_EQ(a.size(), 32 + 12ULL * points * frames);
    EXPECT_EQ(word(b, 0, true), frames);
    EXPECT_EQ(word(b, 4, true), points);
    ASSERT_EQ(b.size(), 8 + 4ULL * frames + 12ULL * points * frames);
    EXPECT_NEAR(std::bit_cast<float>(word(b, 8 + 4 * 3, true)), 0.1F, 1e-6F);
    // At rest each point is a vertex of the OBJ, in the OBJ's order.
    size_t at_vertex = 0;
    for (size_t v = 0; v < points; ++v, ++at_vertex) {
      const auto is_there = [&](const std::array<float, 3>& vertex) {
        for (size_t axis = 0; axis < 3; ++axis) {
          const uint32_t bits = word(a, 32 + 12 * v + 4 * axis);
          if (bits != word(b, 8 + 4 * frames + 12 * v + 4 * axis, true)) return false;
          if (std::abs(std::bit_cast<float>(bits) - vertex[axis]) > 2e-4F) return false;
        }
        return true;
      };
      while (at_vertex < vertices.size() && !is_there(vertices[at_vertex]))
        ++at_vertex;
      ASSERT_LT(at_vertex, vertices.size()) << pc2["files"][i] << ": point " << v;
    }
  }
}

TEST_F(Play, AnInterruptedRunLeavesNoFile) {
  curves("time,jawOpen\n0,0\n600,1\n");
  const fs::path place = *folder / "interrupted";
  fs::create_directories(place);
  for (const char* name : {"x.glb", "x.pc2"}) {
    const std::string out = (place / name).string(), rig = at("rig.glb"), take = at("take.csv");
    const pid_t child = fork();
    if (child == 0) {
      execl(test::tool().c_str(), "fascia", "play", rig.c_str(), "--curves", take.c_str(), "--quiet", "-o",
            out.c_str(), static_cast<char*>(nullptr));
      _exit(99);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    kill(child, SIGINT);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 130);
    EXPECT_TRUE(fs::is_empty(place)) << name;
  }
}

/// Layers, weights and values that hold are sums: the same as one table of the sums, to the last bit.
TEST_F(Play, LayersWeightsAndHeldValuesAddUp) {
  std::ofstream(at("second.csv")) << "time,jawOpen,mouthSmileLeft\n0,0.25,0\n1,0.25,0.5\n2,0.25,0.5\n";
  const json sum =
      play("time,jawOpen,mouthSmileLeft\n0,0.125,0.25\n0.5,0.375,0.375\n1,0.125,0.5\n2,0.125,0.5\n",
           "--fps 8 --from 0.25", "sum.pc2");
  const std::string layers = " --layer " + at("second.csv") + "=0.5";
  const json added =
      play("time,jawOpen\n0,0\n0.5,1\n1,0\n",
           "--fps 8 --from 0.25 --weight 0.25 --set arkit:mouthSmileLeft=0.25" + layers, "added.pc2");
  ASSERT_EQ(added["files"].size(), sum["files"].size());
  EXPECT_EQ(added["frames"], 15) << "the longest layer tells";
  for (size_t i = 0; i < sum["files"].size(); ++i)
    EXPECT_TRUE(text_of(added["files"][i].get<std::string>()) == text_of(sum["files"][i].get<std::string>()))
        << i;
  EXPECT_NE(added["matched"].dump().find("mouthSmileLeft"), std::string::npos);

  for (const char* wrong : {"--layer nothing.csv", "--set nothing=1", "--weight 11"}) {
    const Outcome outcome = run("play " + at("rig.glb") + curves("time,jawOpen\n0,0\n1,1\n") + " " + wrong +
                                " -o " + at("out.glb"));
    EXPECT_EQ(outcome.code, std::string(wrong) == "--weight 11" ? 2 : 1) << outcome.err;
  }
  EXPECT_NE(run("play " + at("rig.glb") + curves("time,jawOpen\n0,0\n1,1\n") + " --layer " +
                at("second.csv") + "=20 -o " + at("out.glb"))
                .err.find("0 to 10"),
            std::string::npos);
}

/// A host that plays the channels, not the shapes, needs what holds too.
TEST_F(Play, WhatHoldsIsInTheAnimationOfTheChannels) {
  const auto pointers = [](const std::string& name) {
    const json file = gltf(name);
    size_t count = 0;
    for (const json& channel : file["animations"][0]["channels"])
      if (channel["target"]["path"] == "pointer") ++count;
    return count;
  };
  play("time,jawOpen\n0,0\n0.5,1\n", "--fps 8", "free.glb");
  play("time,jawOpen\n0,0\n0.5,1\n", "--fps 8 --set zygomaticus_minor_left=0.5", "held.glb");
  EXPECT_GT(pointers("free.glb"), 0U);
  EXPECT_EQ(pointers("held.glb"), pointers("free.glb") + 1);
}

}  // namespace
}  // namespace fascia::cli
