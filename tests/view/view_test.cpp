#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "geometry/error.h"
#include "view/image.h"
#include "view/renderer.h"
#include "view/video.h"

namespace fascia::view {
namespace {

Colour pixel(const Image& image, int x, int y) {
  const size_t at = 3 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x));
  return {image.pixels[at], image.pixels[at + 1], image.pixels[at + 2]};
}

/// A square in the plane z = 0, seen from +Z.
DrawSurface square(double z, const Vec3& colour, double opacity) {
  DrawSurface surface;
  surface.positions = {Vec3(-1, -1, z), Vec3(1, -1, z), Vec3(1, 1, z), Vec3(-1, 1, z)};
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  surface.colour = colour;
  surface.opacity = opacity;
  surface.shine = 0;
  return surface;
}

Camera straight() {
  Camera camera;
  camera.distance = 12;
  return camera;
}

TEST(Renderer, DrawsTheNearerSurface) {
  const Renderer renderer(64, 64);
  DrawList list;
  list.surfaces = {square(0, Vec3(0.1, 0.8, 0.1), 1), square(-1, Vec3(0.8, 0.1, 0.1), 1)};
  const Image image = renderer.draw(list, straight(), {1, 2, 3});
  const Colour middle = pixel(image, 32, 32);
  EXPECT_GT(middle[1], 2 * middle[0]);
  EXPECT_EQ(pixel(image, 1, 1), (Colour{1, 2, 3}));
}

TEST(Renderer, LeftOfTheSubjectIsRightInTheFrontView) {
  const Renderer renderer(64, 64);
  DrawList list;
  list.surfaces = {square(0, Vec3(0.8, 0.8, 0.8), 1)};
  for (Vec3& p : list.surfaces[0].positions)
    p[0] = p[0] * 0.4 + 0.6;
  const Image image = renderer.draw(list, straight(), {0, 0, 0});
  EXPECT_GT(pixel(image, 40, 32)[0], 50);
  EXPECT_EQ(pixel(image, 24, 32)[0], 0);
}

TEST(Renderer, GlassLetsTheInsideShowThrough) {
  const Renderer renderer(64, 64);
  DrawList list;
  list.surfaces = {square(0.5, Vec3(0.1, 0.1, 0.9), 0.5), square(0, Vec3(0.9, 0.1, 0.1), 1)};
  const Colour middle = pixel(renderer.draw(list, straight(), {0, 0, 0}), 32, 32);
  EXPECT_GT(middle[0], 60);
  EXPECT_GT(middle[2], 60);
}

TEST(Renderer, RefusesUnknownViewsAndSizes) {
  EXPECT_THROW(named_camera("inside", Bounds{Vec3(0, 0, 0), Vec3(1, 1, 1)}), Error);
  EXPECT_THROW(Renderer(0, 10), Error);
}

TEST(Image, LabelsAndSheetsStayInside) {
  Image image(40, 20, {0, 0, 0});
  write_label(image, "smile", -10, 4, 2, {255, 255, 255});
  int lit = 0;
  for (uint8_t value : image.pixels)
    lit += value == 255;
  EXPECT_GT(lit, 30);
  const Image sheet = contact_sheet({{image, "a"}, {image, "b"}, {image, "c"}}, 2);
  EXPECT_GT(sheet.width, 80);
  EXPECT_GT(sheet.height, 80);
  const auto path = std::filesystem::temp_directory_path() / "fascia_view_test.png";
  write_png(path, sheet);
  EXPECT_GT(std::filesystem::file_size(path), 100u);
  std::filesystem::remove(path);
}

class PictureFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("fascia_pictures_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  auto count() const { return std::distance(std::filesystem::directory_iterator(folder_), {}); }

  std::filesystem::path folder_;
};

TEST_F(PictureFiles, FollowLinksAndMakeNoFolders) {
  const Image image(8, 8, {1, 2, 3});
  EXPECT_THROW(write_png(folder_ / "nowhere" / "x.png", image), Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "nowhere"));
  write_png(folder_ / "real.png", image);
  std::filesystem::create_symlink("real.png", folder_ / "link.png");
  const auto before = std::filesystem::file_size(folder_ / "real.png");
  write_png(folder_ / "link.png", Image(64, 64, {1, 2, 3}));
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "link.png"));
  EXPECT_NE(std::filesystem::file_size(folder_ / "real.png"), before);
  EXPECT_EQ(count(), 2);
}

TEST_F(PictureFiles, AFullDiskLeavesTheOldPicture) {
  write_png(folder_ / "x.png", Image(8, 8, {1, 2, 3}));
  const auto before = std::filesystem::file_size(folder_ / "x.png");
  Image noise(200, 200, {0, 0, 0});
  for (size_t i = 0; i < noise.pixels.size(); ++i)
    noise.pixels[i] = static_cast<uint8_t>(i * i >> 3 ^ i * 31);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const struct rlimit limit = {1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_png(folder_ / "x.png", noise);
      _exit(1);
    } catch (const Error&) {
      _exit(0);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "x.png"), before);
  EXPECT_EQ(count(), 1);
}

TEST_F(PictureFiles, AFilmFollowsALinkAndKeepsWhatItCannotReplace) {
  if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  std::filesystem::create_symlink("real.gif", folder_ / "link.gif");
  std::filesystem::create_directories(folder_ / "taken.gif" / "inner");
  for (const char* name : {"link.gif", "taken.gif"}) {
    Video film(folder_ / name, 32, 32, 10.0);
    for (int k = 0; k < 3; ++k)
      film.add(Image(32, 32, {static_cast<uint8_t>(90 * k), 2, 3}));
    if (std::string(name) == "link.gif")
      film.finish();
    else
      EXPECT_THROW(film.finish(), Error);
  }
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "link.gif"));
  EXPECT_GT(std::filesystem::file_size(folder_ / "real.gif"), 20u);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "taken.gif" / "inner"));
  EXPECT_EQ(count(), 3);
}

}  // namespace
}  // namespace fascia::view
