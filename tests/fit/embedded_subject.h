#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cli/embedded_head.h"
#include "fit/subject.h"
#include "formats/scene.h"
#include "tests/cli/tool.h"

namespace fascia::fit {

/// The embedded head's rig at low detail in a folder of its own, as a file and as a subject; made once for
/// the cases of a program.
class EmbeddedSubject : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new std::filesystem::path(std::filesystem::temp_directory_path() /
                                       ("fascia_fit_test_" + std::to_string(getpid())));
    std::filesystem::remove_all(*folder);
    std::filesystem::create_directories(*folder);
    cli::write_embedded_head(*folder / "head.obj", *folder / "landmarks.json");
    const cli::Outcome built = run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
                                   " --detail low -o " + at("rig.glb") + " --quiet");
    ASSERT_EQ(built.code, 0) << built.err;
    subject = new Subject(rig::read(formats::read_bytes(at("rig.glb"))), "low");
  }
  static void TearDownTestSuite() {
    delete subject;
    std::filesystem::remove_all(*folder);
    delete folder;
  }
  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static cli::Outcome run(const std::string& arguments) { return cli::run_tool(*folder, arguments); }

  /// Every channel at rest but for those in `set`. A name that is no channel fails the test.
  static std::vector<float> values_of(const std::map<std::string, float>& set) {
    std::vector<float> values;
    size_t known = 0;
    for (const rig::Channel& channel : subject->channels()) {
      const auto entry = set.find(channel.name);
      values.push_back(entry == set.end() ? channel.rest : entry->second);
      known += entry != set.end();
    }
    for (const auto& [name, value] : set)
      EXPECT_TRUE(known == set.size() || has_channel(name)) << "the rig has no channel " << name;
    return values;
  }
  static bool has_channel(const std::string& name) {
    for (const rig::Channel& channel : subject->channels())
      if (channel.name == name) return true;
    return false;
  }

  inline static std::filesystem::path* folder = nullptr;
  inline static Subject* subject = nullptr;
};

}  // namespace fascia::fit
