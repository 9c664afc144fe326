#include <gtest/gtest.h>

#include <filesystem>

#include "geometry/error.h"
#include "view/image.h"
#include "view/renderer.h"

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

}  // namespace
}  // namespace fascia::view
