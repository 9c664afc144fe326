#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/error.h"
#include "view/environment.h"
#include "view/face/face_scene.h"
#include "view/renderer.h"
#include "view/smooth_normals.h"
#include "view/text.h"

namespace fascia::view {
namespace {

constexpr int size = 64;

/// One renderer for all tests here: to start one takes a moment.
const Renderer& renderer() {
  static const Renderer one(size, size);
  return one;
}

double brightness(const Image& image, int x, int y) {
  const uint8_t* p =
      &image.pixels[3 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x))];
  return p[0] + p[1] + p[2];
}

DrawSurface square(double z, double half, Shading shading = Shading::plain) {
  DrawSurface surface;
  surface.positions = {Vec3(-half, -half, z), Vec3(half, -half, z), Vec3(half, half, z),
                       Vec3(-half, half, z)};
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  surface.uvs = {Vec2(0, 1), Vec2(1, 1), Vec2(1, 0), Vec2(0, 0)};
  surface.shading = shading;
  return surface;
}

/// A sphere about the origin, its poles on Y.
DrawSurface sphere(double radius, Shading shading) {
  DrawSurface surface;
  const int rows = 24, columns = 48;
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c) {
      const double a = EIGEN_PI * r / rows, b = 2 * EIGEN_PI * c / columns;
      surface.positions.push_back(radius *
                                  Vec3(std::sin(a) * std::sin(b), -std::cos(a), std::sin(a) * std::cos(b)));
    }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int at = r * (columns + 1) + c, above = at + columns + 1;
      surface.triangles.push_back({at, at + 1, above + 1});
      surface.triangles.push_back({at, above + 1, above});
    }
  surface.shading = shading;
  return surface;
}

Camera near_camera() {
  Camera camera;
  camera.distance = 0.5;
  return camera;
}

TEST(Scene, TheSameListGivesTheSamePixels) {
  DrawList list;
  list.surfaces = {sphere(0.07, Shading::skin), sphere(0.075, Shading::xray)};
  Look look;
  look.has_backdrop = true;
  EXPECT_EQ(renderer().draw_with(list, near_camera(), look).pixels,
            renderer().draw_with(list, near_camera(), look).pixels);
}

TEST(Scene, EveryKindOfSurfaceIsDrawnInEveryLight) {
  for (const Shading shading :
       {Shading::plain, Shading::skin, Shading::mucosa, Shading::tooth, Shading::eye, Shading::hair,
        Shading::bone, Shading::muscle, Shading::xray, Shading::data}) {
    DrawList list;
    list.surfaces = {sphere(0.07, shading)};
    const Image image = renderer().draw(list, near_camera(), {0, 0, 0});
    EXPECT_GT(brightness(image, size / 2, size / 2), 20) << static_cast<int>(shading);
  }
  for (const char* light : {"studio", "soft", "dramatic", "outdoor", "flat"}) {
    Look look;
    look.light = light;
    DrawList list;
    list.surfaces = {sphere(0.07, Shading::skin)};
    const Image image = renderer().draw_with(list, near_camera(), look);
    EXPECT_GT(brightness(image, size / 2, size / 2), 60) << light;
  }
  EXPECT_THROW(environment("candle"), Error);
}

TEST(Scene, ShadowsFallBehindWhatStandsInTheLight) {
  // A wall, and before it a small square up on the side of the studio's key light.
  DrawList list;
  list.surfaces = {square(0, 0.1), square(0.04, 0.02)};
  for (Vec3& p : list.surfaces[1].positions)
    p += 0.04 * Vec3(std::sin(-38 * EIGEN_PI / 180) / std::cos(38 * EIGEN_PI / 180) * 1.0, 0.9, 0.0);
  Look look;
  look.has_occlusion = false;
  const Image with = renderer().draw_with(list, near_camera(), look);
  look.has_shadows = false;
  const Image without = renderer().draw_with(list, near_camera(), look);
  double darkest = 1e9;
  for (int y = 20; y < 44; ++y)
    for (int x = 20; x < 44; ++x)
      darkest = std::min(darkest, brightness(with, x, y) / brightness(without, x, y));
  EXPECT_LT(darkest, 0.8);
}

/// The surface in flat light without shadows, with ambient occlusion and without.
std::pair<Image, Image> with_and_without_occlusion(const DrawSurface& surface) {
  DrawList list;
  list.surfaces = {surface};
  Look look;
  look.light = "flat";
  look.has_shadows = false;
  Image with = renderer().draw_with(list, near_camera(), look);
  look.has_occlusion = false;
  return {std::move(with), renderer().draw_with(list, near_camera(), look)};
}

TEST(Scene, OcclusionDarkensAFold) {
  // Two walls that meet in a sharp valley.
  DrawSurface fold;
  fold.positions = {Vec3(-0.05, -0.1, 0.08), Vec3(0, -0.1, 0), Vec3(0, 0.1, 0),
                    Vec3(-0.05, 0.1, 0.08),  Vec3(0, -0.1, 0), Vec3(0.05, -0.1, 0.08),
                    Vec3(0.05, 0.1, 0.08),   Vec3(0, 0.1, 0)};
  fold.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const auto [with, without] = with_and_without_occlusion(fold);
  EXPECT_LT(brightness(with, size / 2, size / 2), 0.95 * brightness(without, size / 2, size / 2));
}

TEST(Scene, APlaneIsAsOpenAtThePicturesEdgeAsInItsMiddle) {
  DrawSurface wall = square(0, 1.0);
  for (Vec3& p : wall.positions)
    p = Eigen::AngleAxisd(EIGEN_PI / 4, Vec3::UnitY()) * p;
  const auto [with, without] = with_and_without_occlusion(wall);
  for (const int x : {0, 2, size / 2, size - 3, size - 1})
    EXPECT_GT(brightness(with, x, size / 2), 0.95 * brightness(without, x, size / 2)) << x;
}

TEST(Scene, AMouthMirrorsNoRoomThatItsLipsHide) {
  // A wet floor that mirrors the room above the onlooker, and a lip that comes between.
  DrawSurface tongue = square(0, 0.03, Shading::mucosa);
  for (Vec3& p : tongue.positions)
    p = Eigen::AngleAxisd(-EIGEN_PI / 5, Vec3::UnitX()) * p;
  tongue.colour = Vec3(0.02, 0.02, 0.02);
  DrawSurface lip = square(0.03, 0.1);
  for (Vec3& p : lip.positions)
    p[1] += 0.115;
  Look look;
  look.has_shadows = look.has_occlusion = false;
  DrawList list;
  list.surfaces = {tongue};
  const double open = brightness(renderer().draw_with(list, near_camera(), look), size / 2, size / 2);
  list.surfaces.push_back(lip);
  const double hidden = brightness(renderer().draw_with(list, near_camera(), look), size / 2, size / 2);
  EXPECT_LT(hidden, 0.8 * open);
}

TEST(Scene, AWallThatReachesBehindTheCameraFillsThePicture) {
  DrawSurface wall = square(0, 2.0);
  for (Vec3& p : wall.positions)
    p = Eigen::AngleAxisd(1.2, Vec3::UnitX()) * p;
  wall.colour = Vec3(1, 1, 1);
  DrawList list;
  list.surfaces = {wall};
  for (const int samples : {2, 8}) {
    Look look;
    look.background = {0, 0, 0};
    look.samples = samples;
    const Image image = renderer().draw_with(list, near_camera(), look);
    for (const int x : {0, size - 1})
      EXPECT_GT(brightness(image, x, size - 1), 100) << samples;
  }
}

TEST(Scene, TwoSamplesSmoothEdgesAsEightDo) {
  DrawList list;
  list.surfaces = {sphere(0.07, Shading::plain)};
  Look look;
  look.background = {0, 0, 0};
  const auto drawn = [&](int samples) {
    look.samples = samples;
    return renderer().draw_with(list, near_camera(), look);
  };
  const auto distance = [](const Image& a, const Image& b) {
    double sum = 0.0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
      sum += std::abs(a.pixels[i] - b.pixels[i]);
    return sum / static_cast<double>(a.pixels.size());
  };
  const Image eight = drawn(8);
  EXPECT_LT(distance(drawn(2), eight), 0.7 * distance(drawn(1), eight));
  EXPECT_LT(distance(drawn(4), eight), 0.7 * distance(drawn(1), eight));
}

/// What surrounds the surfaces is drawn by itself: no line shows where the two meet.
TEST(Scene, NoFrameShowsAroundTheSurfaces) {
  DrawList list;
  list.surfaces = {sphere(0.03, Shading::plain)};
  Look look;
  look.background = {200, 200, 200};
  const auto drawn = [&](int samples) {
    look.samples = samples;
    return renderer().draw_with(list, near_camera(), look);
  };
  for (const int samples : {1, 2, 4, 8}) {
    const Image image = drawn(samples);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        if (std::hypot(x - 0.5 * size, y - 0.5 * size) > 0.3 * size) {
          ASSERT_NEAR(brightness(image, x, y), brightness(image, 0, 0), 6.0)
              << samples << " " << x << " " << y;
        }
  }
}

/// Pictures in motion: no passes of light, fewer pixels, but the same thing in the same place.
TEST(Scene, APlainPictureOfFewerPixelsShowsTheSame) {
  DrawList list;
  list.surfaces = {sphere(0.05, Shading::plain)};
  Look look;
  look.samples = 1;
  look.has_shadows = look.has_occlusion = look.has_mirrors = false;
  look.background = {0, 0, 0};
  const Image whole = renderer().draw_with(list, near_camera(), look);
  look.resolution = 0.5;
  const Image half = renderer().draw_with(list, near_camera(), look);
  double apart = 0.0;
  for (size_t i = 0; i < whole.pixels.size(); ++i)
    apart += std::abs(whole.pixels[i] - half.pixels[i]);
  EXPECT_GT(apart, 0.0);
  EXPECT_LT(apart / static_cast<double>(whole.pixels.size()), 6.0);
  // Unshadowed, as if the shadows were there and nothing stood in the light.
  look.resolution = 1.0;
  look.has_shadows = true;
  const Image lit = renderer().draw_with(list, near_camera(), look);
  EXPECT_NEAR(brightness(lit, size / 2, size / 2), brightness(whole, size / 2, size / 2), 12.0);
}

TEST(Scene, HairsFinerThanAPixelAreLeftOutBelowFourSamples) {
  DrawList none, list;
  list.surfaces = {square(0, 0.1)};
  list.surfaces[0].is_fine = true;
  Look look;
  for (const int samples : {1, 2, 4, 8}) {
    look.samples = samples;
    const bool is_left_out = renderer().draw_with(list, near_camera(), look).pixels ==
                             renderer().draw_with(none, near_camera(), look).pixels;
    EXPECT_EQ(is_left_out, samples < 4) << samples;
  }
}

/// Lashes that are hairs are drawn without a texture; cards, which would be opaque, are not.
TEST(Scene, HairsAreDrawnAndBareCardsAreNot) {
  rig::Rig rig;
  const auto lashes = [](double width) {
    FacePart part{0, 0, "lashes", {{0, 1, 2}}, {Vec3(0, 0, 0), Vec3(width, 0, 0), Vec3(0, 0.008, 0)}, {}};
    return part;
  };
  for (const auto& [width, count] : {std::pair{0.0002, 1U}, {0.006, 0U}}) {
    FaceScene scene(rig, {lashes(width)}, Appearance());
    const auto w = static_cast<float>(width);
    const std::vector<float> places = {0, 0, 0, w, 0, 0, 0, 0.008F, 0};
    FaceState state;
    state.positions = {places};
    EXPECT_EQ(scene.list(state, {}).surfaces.size(), count) << width;
  }
}

TEST(Scene, MapsColourAndCutHoles) {
  auto map = std::make_shared<Texture>();
  map->width = map->height = 2;
  map->pixels = {255, 0, 0,   255, 0,   255, 0,   255,
                 0,   0, 255, 255, 255, 255, 255, 0};  // clear at the lower right
  DrawList list;
  list.surfaces = {square(0, 0.1, Shading::data)};
  list.surfaces[0].colour = Vec3::Ones();
  list.surfaces[0].colour_map = map;
  list.surfaces[0].alpha_cutoff = 0.5;
  Camera camera = near_camera();
  camera.distance = 0.6;
  const Image image = renderer().draw(list, camera, {0, 0, 0});
  const auto channel = [&](int x, int y, int k) {
    return image.pixels[static_cast<size_t>(3 * (y * size + x) + k)];
  };
  EXPECT_GT(channel(18, 18, 0), 2 * channel(18, 18, 1));  // upper left red
  EXPECT_GT(channel(46, 18, 1), 2 * channel(46, 18, 0));  // upper right green
  EXPECT_GT(channel(18, 46, 2), 2 * channel(18, 46, 0));  // lower left blue
  EXPECT_EQ(brightness(image, 46, 46), 0.0);
}

TEST(Scene, ACutLeavesOutAHalf) {
  DrawList list;
  list.surfaces = {square(0, 0.1)};
  list.surfaces[0].cut = Eigen::Vector4d(1, 0, 0, 0);
  const Image image = renderer().draw(list, near_camera(), {0, 0, 0});
  EXPECT_GT(brightness(image, 20, 32), 50);
  EXPECT_EQ(brightness(image, 44, 32), 0);
}

TEST(Scene, ListsThatDoNotFitAreRefused) {
  DrawList list;
  list.surfaces = {square(0, 0.1)};
  list.surfaces[0].uvs.pop_back();
  EXPECT_THROW(renderer().draw(list, near_camera()), Error);
  list.surfaces = {square(0, 0.1)};
  list.surfaces[0].triangles.push_back({0, 1, 9});
  EXPECT_THROW(renderer().draw(list, near_camera()), Error);
}

TEST(SmoothNormals, AreThoseOfASphereAcrossItsSeam) {
  const DrawSurface ball = sphere(1.0, Shading::plain);
  const std::vector<Vec3> normals = smooth_normals(ball.positions, ball.triangles, seams_of(ball.positions));
  for (size_t v = 0; v < normals.size(); ++v)
    EXPECT_GT(normals[v].dot(ball.positions[v]), 0.99) << v;
}

TEST(SmoothNormals, SeamsKeepTogetherWhatAPosePullsApartByRounding) {
  DrawSurface ball = sphere(1.0, Shading::plain);
  const std::vector<int> seams = seams_of(ball.positions);
  for (size_t v = 0; v < ball.positions.size(); ++v)
    ball.positions[v] *= 1.0 + 1e-9 * static_cast<double>(v % 3);
  const std::vector<Vec3> normals = smooth_normals(ball.positions, ball.triangles, seams);
  for (size_t v = 0; v < normals.size(); ++v)
    EXPECT_EQ(normals[v], normals[static_cast<size_t>(seams[v])]);
}

TEST(Environment, AnEvenRoomLightsEverySideAlike) {
  Environment room = environment("flat");
  room.ceiling = room.wall = room.floor = Vec3::Constant(0.5);
  room.boxes.clear();
  const auto sh = irradiance(room);
  EXPECT_NEAR(sh[0][0], 0.5, 2e-3);
  for (size_t k = 1; k < 9; ++k)
    EXPECT_NEAR(sh[k].norm(), 0.0, 3e-3) << k;
  for (const float value : reflection_face(room, 2, 4, 0.5))
    EXPECT_NEAR(value, 0.5, 1e-5);
}

TEST(Text, IsSmoothAndAsWideAsItSays) {
  Image image(200, 30, {0, 0, 0});
  write_text(image, "Lächeln, 12 °", 5, 6, 12, {255, 255, 255});
  int grey = 0, last = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 200; ++x) {
      const double b = brightness(image, x, y);
      grey += b > 60 && b < 700;
      if (b > 60) last = std::max(last, x);
    }
  EXPECT_GT(grey, 40);
  EXPECT_NEAR(last, 5 + text_width("Lächeln, 12 °", 12), 4);
  EXPECT_LT(text_width("ii", 12), text_width("mm", 12));
  write_text(image, "\xff\xfe broken", -40, -5, 12, {255, 255, 255});  // no UTF-8, outside: no crash
}

TEST(Texture, RefusesWhatIsNoPicture) {
  EXPECT_EQ(decode_texture({}, true, 64), nullptr);
  const std::vector<uint8_t> junk(100, 0x89);
  EXPECT_EQ(decode_texture(junk, true, 64), nullptr);
  const Image image(10, 6, {200, 10, 20});
  const auto texture = decode_texture(encode_png(image), true, 4);
  ASSERT_TRUE(texture);
  EXPECT_LE(std::max(texture->width, texture->height), 4);
  EXPECT_EQ(texture->pixels[0], 200);
}

}  // namespace
}  // namespace fascia::view
