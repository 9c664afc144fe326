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
  const Copy copy;
  fs::remove(copy.path() / "muscles.json");
  EXPECT_NE(message(copy.path()).find("muscles.json"), std::string::npos);
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
        Spoilt{"tissue.json", "\"thickness_mm\": 1.7", "\"thickness_mm\": \"thin\"", "skin"}));

TEST(LoadAnatomy, UnknownChannelInATable) {
  const Copy copy;
  copy.edit("expressions/arkit.json", "\"jaw_open\"", "\"jaw_opened\"");
  const std::string text = message(copy.path());
  EXPECT_NE(text.find("jaw_opened"), std::string::npos) << text;
  EXPECT_NE(text.find("arkit:jawOpen"), std::string::npos) << text;
}

}  // namespace
}  // namespace fascia::anatomy
