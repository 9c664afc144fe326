#pragma once

#include <gtest/gtest.h>

#include <unistd.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "builder/rigging/embedded_head.h"
#include "tests/cli/tool.h"
#include "tests/rig/tiny_rig.h"

namespace fascia::testing {

/// A folder with a small rig, its curves and head, and commands on it.
class Workplace : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("fascia_faults_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    rig::Rig whole = test::tiny_rig();
    for (const char* name : {"jaw_forward", "jaw_lateral"})  // which fits ask for
      whole.actuation.channels.push_back({name, "jaw", -1.0F, 1.0F, 0.0F, -1, "1"});
    const std::vector<uint8_t> rig = rig::write(test::tiny_head(), whole);
    std::ofstream(folder / "rig.glb", std::ios::binary)
        .write(reinterpret_cast<const char*>(rig.data()), static_cast<std::streamsize>(rig.size()));
    std::ofstream(folder / "curves.csv") << "time,zygomaticus_major_left\n0,0\n0.2,1\n";
    write_target();
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::string at(const std::string& name) const { return (folder / name).string(); }

  /// A mesh to fit.
  void write_target() const {
    const std::string words =
        "pose " + at("rig.glb") + " --set zygomaticus_major_left=0.7 --quiet -o " + at("smile.ply");
    ASSERT_EQ(std::system((test::tool().string() + " " + words).c_str()), 0);
  }

  /// What a command writes: its words but for the output, and the output's name.
  struct Job {
    std::string words, output;
    bool takes_seconds = false;
  };
  std::vector<Job> jobs() const {
    return {{"pose " + at("rig.glb") + " --set zygomaticus_major_left=0.5 -o ", "pose.glb"},
            {"pose " + at("rig.glb") + " --set jaw_open=0.5 -o ", "pose.ply"},
            {"export " + at("rig.glb") + " --part muscles -o ", "muscles.obj"},
            {"play " + at("rig.glb") + " --curves " + at("curves.csv") + " --fps 20 -o ", "play.glb"},
            {"play " + at("rig.glb") + " --curves " + at("curves.csv") + " --fps 20 -o ", "play.pc2"},
            {"bake " + at("rig.glb") + " --shapes arkit -o ", "bake.glb"},
            {"snapshot record " + at("rig.glb") + " -o ", "snapshot.json"},
            {"fit " + at("rig.glb") + " --target " + at("smile.ply") + " -o ", "found.json"}};
  }

  /// What draws, of the small rig and of one that can be checked: a picture's libraries do not bear it that
  /// memory is refused.
  std::vector<Job> picture_jobs() const {
    const Job build = build_job();
    EXPECT_EQ(std::system((test::tool().string() + " " + build.words + at("whole.glb") + " --quiet").c_str()),
              0);
    EXPECT_EQ(std::system((test::tool().string() + " snapshot record " + at("rig.glb") + " -o " +
                           at("then.json") + " --quiet")
                              .c_str()),
              0);
    std::ofstream(at("then.xml")) << "what was there before";
    return {{"render " + at("rig.glb") + " --size 64 -o ", "picture.png"},
            {"snapshot check " + at("rig.glb") + " --against " + at("then.json") + " --junit " +
                 at("then.xml") + " --report ",
             "then.html"},
            {"check " + at("whole.glb") + " --sheet ", "sheet.png", true}};
  }
  /// Writes a head, for a build of it, which takes seconds.
  Job build_job() const {
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    return {"build " + at("head.obj") + " --landmarks " + at("landmarks.json") + " --detail low -o ",
            "built.glb", true};
  }
  /// Writes scans of the small rig, for a calibration to them.
  Job calibrate_job() const {
    std::filesystem::create_directories(at("scans"));
    const std::string words = "pose " + at("rig.glb") + " --set arkit:mouthSmileLeft=0.6 --quiet -o ";
    EXPECT_EQ(std::system((test::tool().string() + " " + words + at("scans/mouthSmileLeft.obj")).c_str()), 0);
    return {"calibrate " + at("rig.glb") + " --scans " + at("scans") + " --adjust gains -o ", "own.glb"};
  }
  /// Writes a skull, for a head on it.
  Job face_job() const {
    std::filesystem::copy_file(FASCIA_ANATOMY_DATA "/skull.obj", at("skull.obj"),
                               std::filesystem::copy_options::overwrite_existing);
    return {"face " + at("skull.obj") + " -o ", "face.glb", true};
  }

  /// Names in the folder.
  std::set<std::string> names() const {
    std::set<std::string> list;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      list.insert(entry.path().filename().string());
    return list;
  }

  std::filesystem::path folder;
};

}  // namespace fascia::testing
