#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// What each room may include, by the first folder of the path (docs/architecture.md).
const std::map<std::string, std::set<std::string>> rooms = {
    {"geometry", {}},
    {"gltf", {"geometry"}},
    {"formats", {"geometry", "gltf"}},
    {"anatomy", {"geometry", "formats"}},
    {"rig", {"geometry", "gltf"}},
    {"sim", {}},
    {"builder", {"geometry", "formats", "anatomy", "rig", "sim", "gltf"}},
    {"fit", {"geometry", "gltf", "rig", "sim", "builder/spatial"}},
    {"runtime", {"rig/model", "rig/read", "gltf/read", "sim", "geometry", "fit/live"}},
    {"check", {"geometry", "anatomy", "rig/model", "rig/read", "builder/spatial"}},
    {"batch", {"geometry", "formats"}},
    {"snapshot", {"geometry", "formats", "rig/model", "rig/read"}},
    {"view", {"geometry", "gltf", "formats", "rig"}},
    {"app", {"geometry", "formats", "anatomy", "rig", "builder", "view"}},
    {"cli",
     {"app", "geometry", "gltf", "formats", "anatomy", "rig", "sim", "builder", "batch", "check", "fit",
      "runtime", "snapshot", "view"}},
    {"samples", {}},
    // Beside the product: it may not include any of these.
    {"tools", {"geometry", "formats", "anatomy", "rig", "builder", "view", "sim", "fit", "bench"}},
    {"bench",
     {"geometry", "gltf", "formats", "anatomy", "rig", "sim", "builder", "check", "fit", "runtime", "view",
      "cli", "tests"}},
    {"tests",
     {"geometry", "gltf", "formats", "anatomy", "rig", "sim", "builder", "check", "fit", "runtime", "view",
      "cli", "tools", "bench", "app", "batch", "snapshot"}},
};

bool is_source(const fs::path& path) {
  static const std::set<std::string> kinds = {".h", ".hpp", ".cpp", ".c"};
  return kinds.count(path.extension().string()) > 0;
}

/// The quoted includes of a file, as written.
std::vector<std::string> quoted_includes(const fs::path& path) {
  std::vector<std::string> found;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const size_t at = line.find("#include \"");
    if (at == std::string::npos || line.find_first_not_of(" \t") != at) continue;
    const size_t start = at + 10;
    found.push_back(line.substr(start, line.find('"', start) - start));
  }
  return found;
}

bool allowed(const std::string& room, const std::string& include) {
  if (include.rfind(room + "/", 0) == 0) return true;
  if (include.find('/') == std::string::npos) return true;  // a neighbour in the same folder
  for (const std::string& other : rooms.at(room))
    if (include.rfind(other + "/", 0) == 0) return true;
  // Only project rooms are judged: other paths are libraries or a room's own layout.
  for (const auto& [name, uses] : rooms)
    if (include.rfind(name + "/", 0) == 0) return false;
  return true;
}

TEST(House, RoomsIncludeOnlyWhatTheyMay) {
  int files = 0;
  for (const auto& [room, uses] : rooms) {
    const fs::path folder = fs::path(FASCIA_SOURCE) / room;
    ASSERT_TRUE(fs::exists(folder)) << room;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      ++files;
      for (const std::string& include : quoted_includes(entry.path()))
        EXPECT_TRUE(allowed(room, include)) << entry.path() << " may not include " << include;
    }
  }
  EXPECT_GT(files, 60);
}

TEST(House, IncludeRulesRejectViolations) {
  EXPECT_FALSE(allowed("geometry", "formats/scene.h"));
  EXPECT_FALSE(allowed("sim", "rig/model/rig.h"));
  EXPECT_FALSE(allowed("runtime", "rig/write/write.h"));
  EXPECT_FALSE(allowed("samples", "geometry/mesh.h"));
  EXPECT_FALSE(allowed("cli", "tests/paths/paths.h"));
  EXPECT_FALSE(allowed("tools", "cli/posing.h"));
  EXPECT_FALSE(allowed("bench", "tools/anatomy/head/head.h"));
  EXPECT_TRUE(allowed("runtime", "rig/read/read.h"));
}

/// Files are opened in formats/ alone, which contains and replaces them as it should. What must be elsewhere:
const std::map<std::string, std::string> openers = {
    {"app/engine/tool_job.cpp", "the standard input of a child process"},
    {"batch/process.cpp", "what a child process reads and writes"},
    {"view/video.cpp", "the pipe to ffmpeg"},
};

bool opens_files(std::string line) {
  line.resize(std::min(line.size(), line.find("//")));
  for (const char* word : {"ifstream", "ofstream", "fopen(", "stbi_write_png(", "stbi_write_jpg(", "O_CREAT",
                           "O_RDONLY", "O_WRONLY", "popen("})
    if (line.find(word) != std::string::npos) return true;
  return false;
}

TEST(House, FilesAreOpenedInOneRoom) {
  std::set<std::string> found;
  for (const char* room : {"geometry", "gltf", "anatomy", "rig", "sim", "builder", "fit", "runtime", "check",
                           "batch", "snapshot", "view", "app", "cli"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(FASCIA_SOURCE) / room)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      const std::string name = entry.path().lexically_relative(FASCIA_SOURCE).generic_string();
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);)
        if (opens_files(line)) {
          found.insert(name);
          EXPECT_TRUE(openers.count(name)) << name << " opens a file itself: " << line;
        }
    }
  for (const auto& [name, why] : openers)
    EXPECT_TRUE(found.count(name)) << name << " may open files (" << why << ") and does not";
}

TEST(House, EigenStaysOutOfTheRuntimesHeaders) {
  int headers = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(FASCIA_SOURCE) / "runtime/include/fascia")) {
    std::ifstream file(entry.path());
    ASSERT_TRUE(file.good());
    ++headers;
    for (std::string line; std::getline(file, line);)
      EXPECT_EQ(line.find("Eigen"), std::string::npos) << entry.path();
  }
  EXPECT_GE(headers, 5);
}

}  // namespace
