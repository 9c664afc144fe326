#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "anatomy/anatomy.h"
#include "geometry/error.h"

namespace fascia::anatomy {
namespace {

namespace fs = std::filesystem;

/// A copy of the built-in data in a directory of its own, to be spoilt.
class Copy {
 public:
  Copy()
      : path_(fs::temp_directory_path() /
              ("fascia_anatomy_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(path_);
    for (const std::string& name : embedded_files()) {
      fs::create_directories((path_ / name).parent_path());
      std::ofstream(path_ / name, std::ios::binary) << embedded_file(name);
    }
  }
  ~Copy() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

  /// Replaces the first `from` in file `name`.
  void edit(const std::string& name, const std::string& from, const std::string& to) const {
    std::ostringstream bytes;
    bytes << std::ifstream(path_ / name, std::ios::binary).rdbuf();
    std::string text = bytes.str();
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    std::ofstream(path_ / name, std::ios::binary) << text.replace(at, from.size(), to);
  }

 private:
  fs::path path_;
};

/// The message of the error that loading `directory` throws; empty when it does not.
std::string message(const fs::path& directory) {
  try {
    load_generic(directory);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(LoadAnatomy, DirectoryHoldsWhatIsBuiltIn) {
  const Copy copy;
  const GenericAnatomy embedded = load_generic();
  const GenericAnatomy read = load_generic(copy.path());
  ASSERT_EQ(embedded.landmarks.size(), read.landmarks.size());
  for (size_t i = 0; i < read.landmarks.size(); ++i) {
    EXPECT_EQ(embedded.landmarks[i].name, read.landmarks[i].name);
    EXPECT_EQ(embedded.landmarks[i].skin, read.landmarks[i].skin);
  }
  EXPECT_EQ(embedded.muscles.size(), read.muscles.size());
  EXPECT_EQ(embedded.actuators.size(), read.actuators.size());
}

TEST(LoadAnatomy, MissingPlacesAreNamed) {
  EXPECT_NE(message("/nowhere/at/all").find("/nowhere/at/all"), std::string::npos);
  EXPECT_THROW(embedded_file("no_such.json"), Error);
}

TEST(LoadAnatomy, NotJson) {
  const Copy copy;
  std::ofstream(copy.path() / "tissue.json") << "{\"layers\": [";
  EXPECT_NE(message(copy.path()).find("tissue.json"), std::string::npos);
}

/// Each way of being wrong: the message must name the file and the entry.
struct Spoilt {
  const char* file;
  const char* from;
  const char* to;
  const char* entry;
};

class SpoiltAnatomy : public testing::TestWithParam<Spoilt> {};

TEST_P(SpoiltAnatomy, IsRefusedByName) {
  const Spoilt& spoilt = GetParam();
  const Copy copy;
  copy.edit(spoilt.file, spoilt.from, spoilt.to);
  const std::string text = message(copy.path());
  EXPECT_NE(text.find(spoilt.file), std::string::npos) << text;
  EXPECT_NE(text.find(spoilt.entry), std::string::npos) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Ways, SpoiltAnatomy,
    testing::Values(
        Spoilt{"landmarks.json", "\"name\": \"vertex\"", "\"name\": \"opisthocranion\"", "opisthocranion"},
        Spoilt{"landmarks.json", "\"depth\": \"g\"", "\"depth\": \"glabellar\"", "glabella"},
        Spoilt{"landmarks.json", "\"side\": \"left\"", "\"side\": \"sinister\"", "mid_supraorbital_left"},
        Spoilt{"tissue_depths.json", "\"mean_mm\": 6", "\"mean_mm\": -6", "depths[0]"},
        Spoilt{"muscles.json", "\"kind\": \"sheet\"", "\"kind\": \"cloth\"", "frontalis_medial"},
        Spoilt{"muscles.json", "\"on\": \"galea\"", "\"on\": \"ceiling\"", "frontalis_medial"},
        Spoilt{"muscles.json", "\"peak_shortening\": 0.25", "\"peak_shortening\": 0", "frontalis_medial"},
        Spoilt{"muscles.json", "\"name\": \"procerus\"", "\"name\": \"procer\"", "procerus"},
        Spoilt{"actuators.json", "\"minimum\": 0, \"maximum\": 1", "\"minimum\": 2, \"maximum\": 1",
               "jaw_open"},
        Spoilt{"tissue.json", "\"strength\": 1.0", "\"strength\": \"firm\"", "glabella"},
        Spoilt{"tissue.json", "\"elsewhere\"", "\"layers\": [], \"elsewhere\"", "layers"},
        Spoilt{"mechanics.json", "\"value\": 14000", "\"value\": 140000", "skin, young_modulus"},
        Spoilt{"mechanics.json", "\"value\": 1.7, \"unit\": \"mm\"", "\"value\": 0.0017, \"unit\": \"m\"",
               "skin, thickness"},
        Spoilt{"mechanics.json", "\"softness_fade\"", "\"softness_fades\"", "softness_fade"},
        Spoilt{"mechanics.json", "\"lips\": {", "\"lisp\": {", "lips"},
        Spoilt{"mechanics.json", "\"landmark\": \"sellion\"", "\"landmark\": \"selion\"", "nose_bridge"}));

TEST(LoadAnatomy, ADirectoryMayHoldJustTheCorrectedFiles) {
  const Copy copy;
  copy.edit("mechanics.json", "\"value\": 14000", "\"value\": 16000");
  for (const std::string& name : embedded_files())
    if (name != "mechanics.json") fs::remove(copy.path() / name);
  EXPECT_EQ(load_generic(copy.path()).mechanics.skin.young_modulus, 16000.0);
  EXPECT_EQ(load_generic(copy.path()).muscles.size(), load_generic().muscles.size());
  EXPECT_EQ(corrected_files(copy.path()), std::vector<std::string>{"mechanics.json"});
}

TEST(LoadAnatomy, UnknownFilesAreRejected) {
  const Copy copy;
  fs::rename(copy.path() / "mechanics.json", copy.path() / "mechanic.json");
  EXPECT_NE(message(copy.path()).find("mechanic.json"), std::string::npos);
  for (const std::string& name : embedded_files())
    fs::remove(copy.path() / name);
  fs::remove(copy.path() / "mechanic.json");
  EXPECT_NE(message(copy.path()).find("holds no file"), std::string::npos);
}

TEST(LoadAnatomy, AFileThatIsOnlyCompiledInMayNotDiffer) {
  for (const char* name : {"aliases.json", "correctives.json", "landmark_sets.json", "head_parts.obj",
                           "head_skin.jpg", "head_skin_normal.jpg", "head_skin_roughness.jpg"}) {
    const Copy copy;
    EXPECT_EQ(message(copy.path()), "");
    std::ofstream(copy.path() / name, std::ios::binary | std::ios::app) << "\n";
    EXPECT_NE(message(copy.path()).find(name), std::string::npos) << name;
    EXPECT_NE(message(copy.path()).find("compiled into the program"), std::string::npos) << name;
  }
}

TEST(LoadAnatomy, UnknownChannelInATable) {
  const Copy copy;
  copy.edit("expressions/arkit.json", "\"jaw_open\"", "\"jaw_opened\"");
  const std::string text = message(copy.path());
  EXPECT_NE(text.find("jaw_opened"), std::string::npos) << text;
  EXPECT_NE(text.find("arkit:jawForward"), std::string::npos) << text;
}

}  // namespace
}  // namespace fascia::anatomy
