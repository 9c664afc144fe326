#include "formats/write.h"

#include <gtest/gtest.h>

#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::formats {
namespace {

Drawing two_fibres() {
  Drawing drawing;
  drawing.lines.push_back(
      {"zygomaticus_major_left", {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}}, Vec3(1, 0, 0)});
  drawing.lines.push_back({"mentalis_left", {{Vec3(0, 1, 0), Vec3(1, 1, 0)}}, Vec3(1, 0, 0)});
  return drawing;
}

std::string text_of(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

TEST(Write, FibresAreLinesInObjAndEdgesInPly) {
  const auto folder = std::filesystem::temp_directory_path() / "fascia_write_test";
  std::filesystem::create_directories(folder);
  write(folder / "fibres.obj", two_fibres());
  const std::string obj = text_of(folder / "fibres.obj");
  EXPECT_NE(obj.find("g zygomaticus_major_left"), std::string::npos);
  EXPECT_NE(obj.find("\nl 1 2 3\n"), std::string::npos);
  EXPECT_NE(obj.find("\nl 4 5\n"), std::string::npos);
  write(folder / "fibres.ply", two_fibres());
  const std::string ply = text_of(folder / "fibres.ply");
  EXPECT_NE(ply.find("element edge 3"), std::string::npos);
  EXPECT_NE(ply.find("property int muscle"), std::string::npos);
  EXPECT_NE(ply.find("3 4 1\n"), std::string::npos);
  EXPECT_THROW(write(folder / "fibres.stl", two_fibres()), Error);
  EXPECT_THROW(write(folder / "fibres.xyz", two_fibres()), Error);
  std::filesystem::remove_all(folder);
}

TEST(Write, LeavesNothingHalfDone) {
  const auto folder = std::filesystem::temp_directory_path() / "fascia_write_half";
  std::filesystem::create_directories(folder / "taken.obj");  // a folder in the way
  EXPECT_THROW(write_text(folder / "taken.obj", "x"), Error);
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder))
    ++files;
  EXPECT_EQ(files, 1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace fascia::formats
