#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "geometry/error.h"
#include "tests/paths/paths.h"
#include "view/image.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;

view::Image read_png(const fs::path& file) {
  int width = 0, height = 0, channels = 0;
  uint8_t* pixels = stbi_load(file.c_str(), &width, &height, &channels, 3);
  if (!pixels) throw Error("no picture in " + file.string());
  view::Image image(width, height, {0, 0, 0});
  std::copy_n(pixels, image.pixels.size(), image.pixels.begin());
  stbi_image_free(pixels);
  return image;
}

/// A tenth of the size each way, by means: fonts and drivers differ in details.
view::Image small(const view::Image& image) {
  const int step = 10;
  view::Image result(image.width / step, image.height / step, {0, 0, 0});
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int v = 0; v < step; ++v)
          for (int u = 0; u < step; ++u)
            sum += image.pixels[static_cast<size_t>(((y * step + v) * image.width + x * step + u) * 3 + c)];
        result.pixels[static_cast<size_t>((y * result.width + x) * 3 + c)] =
            static_cast<uint8_t>(sum / (step * step));
      }
  return result;
}

/// Mean difference of two pictures of one size, of 255.
double difference(const view::Image& a, const view::Image& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  if (a.pixels.size() != b.pixels.size() || a.pixels.empty()) return 255.0;
  double sum = 0.0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    sum += std::abs(static_cast<int>(a.pixels[i]) - static_cast<int>(b.pixels[i]));
  return sum / static_cast<double>(a.pixels.size());
}

/// Of 255, in the mean: less than a smile makes (0.8). The same machine gives none, fonts and drivers differ.
constexpr double tolerance = 0.7;

class Window : public testing::Test {
 protected:
  Window() : folder_(fs::temp_directory_path() / ("fascia_window_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Window() override { fs::remove_all(folder_); }

  /// The tool's exit code; what it said is in log.txt.
  int view(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() +
                                "' && '" XVFB_RUN "' -a -s '-screen 0 1600x1000x24' '" +
                                test::tool().string() + "' view " + arguments + " > log.txt 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string log() const {
    std::ifstream stream(folder_ / "log.txt");
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  view::Image picture(const std::string& name) const { return small(read_png(folder_ / name)); }
  void script(const std::string& text) const { std::ofstream(folder_ / "script.txt") << text; }

  fs::path folder_;
};

TEST_F(Window, ATourThroughTheApplication) {
  std::ofstream(folder_ / "smile.csv")
      << "time,arkit:mouthSmileLeft,arkit:mouthSmileRight\n0,0,0\n0.5,1,0.5\n1,0,0\n";
  ASSERT_EQ(view("--script '" FASCIA_TOUR "'"), 0) << log();

  const view::Image neutral = picture("neutral.png");
  EXPECT_EQ(neutral.width, 128);
  EXPECT_EQ(neutral.height, 80);
  // The same state looks the same, another one does not.
  EXPECT_LT(difference(neutral, picture("undone.png")), 0.5);
  EXPECT_GT(difference(neutral, picture("posed.png")), 0.8);
  EXPECT_GT(difference(neutral, picture("start.png")), 10.0);
  EXPECT_GT(difference(neutral, picture("pulled.png")), 3.0);
  EXPECT_GT(difference(neutral, picture("light.png")), 40.0);

  // As they were when somebody looked at them.
  for (const char* name : {"start", "neutral", "posed", "landmark", "muscle", "sketch", "pulled", "light"}) {
    const fs::path kept = test::snapshots() / "app" / (std::string(name) + ".png");
    const view::Image now = picture(std::string(name) + ".png");
    if (std::getenv("FASCIA_RENEW_SNAPSHOTS")) {
      fs::create_directories(kept.parent_path());
      view::write_png(kept, now);
    }
    ASSERT_TRUE(fs::exists(kept)) << "FASCIA_RENEW_SNAPSHOTS=1 makes " << kept;
    EXPECT_LT(difference(now, read_png(kept)), tolerance) << name;
  }

  for (const char* name : {"take.glb", "posed.obj", "edits.json", "rig.glb"})
    EXPECT_GT(fs::file_size(folder_ / name), 2U) << name;
}

/// Nothing is out of reach: what finds no place scrolls, or stands in a list of its own.
TEST_F(Window, ASmallWindowKeepsEveryButton) {
  const std::string steps = R"(click "Try the embedded head"
wait idle
click Live
expect panel live
click Export
expect panel export
click More
wait 3
click "Shake head"
click View
wait 3
click View
wait 3
click Left
wait 3
click Muscles
wait 3
click "Search muscles"
type "major superior left"
wait 3
click zygomaticus_major_superior_left
)";
  script("size 640 440\n" + steps);
  EXPECT_EQ(view("--script script.txt"), 0) << log();
  script("size 1280 880\n" + steps);
  EXPECT_EQ(view("--scale 2 --script script.txt"), 0) << log();
}

TEST_F(Window, AScriptThatCannotBeDoneNamesItsLine) {
  script("wait 2\nclick \"No such button\"\n");
  EXPECT_EQ(view("--script script.txt"), 1);
  EXPECT_NE(log().find("script.txt:2: there is no 'No such button'"), std::string::npos) << log();
  script("wait 2\nexpect rig yes\n");
  EXPECT_EQ(view("--script script.txt"), 1);
  EXPECT_NE(log().find("script.txt:2: rig is 'no'"), std::string::npos) << log();
}

TEST_F(Window, WithoutADisplayReportsARemedy) {
  const std::string command = "cd '" + folder_.string() + "' && env -u DISPLAY -u WAYLAND_DISPLAY '" +
                              test::tool().string() + "' view > log.txt 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(log().find("xvfb-run"), std::string::npos) << log();
}

TEST_F(Window, HandlesRandomInput) {
  EXPECT_EQ(view("--monkey 7 --seconds 5"), 0) << log();
}

}  // namespace
}  // namespace fascia
