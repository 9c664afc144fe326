#include "view/face/moving_anatomy.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "view/face/face_scene.h"
#include "view/face/heat_map.h"
#include "view/renderer.h"

namespace fascia::view {
namespace {

/// A plate of skin, SMAS and deep nodes one above the other, on a cranium above and a mandible below y = 0.
struct Plate {
  rig::Rig rig;
  std::vector<Vec3> skin;
  Lattice now;
};

Plate plate() {
  Plate plate;
  rig::TissueLevel level;
  for (int layer = 0; layer < 3; ++layer)
    for (int i = -4; i <= 4; ++i)
      for (int k = -4; k <= 4; ++k) {
        const Vec3 p(0.005 * k, 0.005 * i, -0.004 * layer);
        level.rest.push_back(p.cast<float>());
        if (layer == 0) plate.skin.push_back(p);
      }
  level.columns = static_cast<uint32_t>(plate.skin.size());
  plate.now.columns = level.columns;
  for (const rig::Vec3f& p : level.rest)
    plate.now.nodes.push_back(p.cast<double>());
  plate.rig.tissue.levels = {level};
  plate.rig.smas.surface.positions = {{0.001F, -0.0107F, -0.004F}, {0.0F, 0.2F, -0.004F}};
  plate.rig.skull.cranium.positions = {{0, 0.01F, -0.01F}};
  plate.rig.skull.mandible.positions = {{0, -0.01F, -0.01F}};
  rig::Ligament upper, lower;
  upper.bone = {0, 0.009F, -0.01F};
  upper.skin = {0, 0.009F, 0};
  lower.bone = {0, -0.009F, -0.01F};
  lower.skin = {0, -0.009F, 0};
  plate.rig.smas.ligaments = {upper, lower};
  rig::Landmark landmark;
  landmark.skin = lower.skin;
  landmark.bone = lower.bone;
  plate.rig.skull.landmarks = {landmark};
  return plate;
}

TEST(MovingAnatomy, IsWhereItWasWhenNothingMoves) {
  const Plate at = plate();
  const MovingAnatomy moving(at.rig, at.skin);
  const auto smas = moving.smas(at.now);
  for (size_t v = 0; v < smas.size(); ++v)
    EXPECT_LT((smas[v] - at.rig.smas.surface.positions[v].cast<double>()).norm(), 1e-9);
  const auto bands = moving.ligaments(at.skin, Mat4::Identity());
  ASSERT_EQ(bands.size(), 2U);
  EXPECT_LT((bands[1][1] - at.rig.smas.ligaments[1].skin.cast<double>()).norm(), 1e-9);
  EXPECT_LT((moving.smas({})[0] - at.rig.smas.surface.positions[0].cast<double>()).norm(), 1e-9);
}

TEST(MovingAnatomy, FollowsTheTissueAndTheBoneItIsOn) {
  Plate at = plate();
  const MovingAnatomy moving(at.rig, at.skin);
  const Vec3 down(0, -0.01, 0.002);
  for (size_t c = 0; c < at.now.columns; ++c)
    at.now.nodes[at.now.columns + c] += down;
  const auto smas = moving.smas(at.now);
  EXPECT_LT((smas[0] - at.rig.smas.surface.positions[0].cast<double>() - down).norm(), 1e-8);
  // What lies far from all tissue stays.
  EXPECT_LT((smas[1] - at.rig.smas.surface.positions[1].cast<double>()).norm(), 1e-9);

  std::vector<Vec3> skin = at.skin;
  for (Vec3& p : skin)
    p += Vec3(0.003, 0, 0);
  Mat4 jaw = Mat4::Identity();
  jaw(1, 3) = -0.02;
  const auto bands = moving.ligaments(skin, jaw);
  EXPECT_LT((bands[0][0] - Vec3(0, 0.009, -0.01)).norm(), 1e-8) << "on the cranium";
  EXPECT_LT((bands[1][0] - Vec3(0, -0.029, -0.01)).norm(), 1e-8) << "on the mandible";
  EXPECT_LT((bands[0][1] - Vec3(0.003, 0.009, 0)).norm(), 1e-8);
  const auto landmarks = moving.landmarks(skin, jaw);
  EXPECT_LT((landmarks[0][1] - Vec3(0.003, -0.009, 0)).norm(), 1e-8);
}

/// A scene of one triangle of skin, one of gums; its own landmark on the skin.
TEST(FaceScene, LandmarksFollowTheSkinAndGumsDoNotShowThroughGlass) {
  rig::Rig rig;
  rig::Landmark landmark;
  landmark.skin = {0, 0, 0};
  rig.skull.landmarks = {landmark};
  FacePart skin{
      0, 0, "skin", {{0, 1, 2}}, {Vec3(-0.005, -0.005, 0), Vec3(0.005, -0.005, 0), Vec3(0, 0.008, 0)}, {}};
  FacePart gums = skin;
  gums.primitive = 1;
  gums.part = "gums_upper";
  const FaceScene scene(rig, {skin, gums}, Appearance());
  std::vector<float> now;
  for (const Vec3& p : skin.rest)
    for (int k = 0; k < 3; ++k)
      now.push_back(static_cast<float>(p[k] + (k == 1 ? -0.004 : 0.0)));
  FaceState state;
  state.positions = {now, now};
  FaceView view;
  view.layers = {"skin", "landmarks"};
  DrawList list = scene.list(state, view);
  ASSERT_EQ(list.surfaces.size(), 3U) << "skin, gums, balls";
  EXPECT_NEAR(bounds(list.surfaces[2].positions).centre()[1], -0.004, 1e-6);
  view.layers = {"skin", "skull"};
  list = scene.list(state, view);
  ASSERT_EQ(list.surfaces.size(), 1U);
  EXPECT_EQ(list.surfaces[0].shading, Shading::xray);
}

TEST(HeatMap, TheLegendStaysInsideASmallPicture) {
  const Colour ground = {10, 20, 30};
  for (const int width : {300, 140}) {
    Image image(width, 300, ground);
    add_legend(image, HeatScale{"areal strain, %", -30.0, 30.0, true});
    int touched = 0;
    for (int y = 0; y < image.height; ++y) {
      const size_t at =
          3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(width) - 1);
      touched += image.pixels[at] != ground[0] || image.pixels[at + 1] != ground[1];
    }
    EXPECT_EQ(touched, 0) << width;
  }
}

/// A key light from one side: skin gets darker around a ball without a band of red.
TEST(Shading, SkinIsNoRedderWhereTheLightEnds) {
  const int size = 96;
  DrawSurface ball;
  const int rows = 32, columns = 64;
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c) {
      const double a = EIGEN_PI * r / rows, b = 2 * EIGEN_PI * c / columns;
      ball.positions.push_back(0.07 *
                               Vec3(std::sin(a) * std::sin(b), -std::cos(a), std::sin(a) * std::cos(b)));
    }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int at = r * (columns + 1) + c, above = at + columns + 1;
      ball.triangles.push_back({at, at + 1, above + 1});
      ball.triangles.push_back({at, above + 1, above});
    }
  ball.shading = Shading::skin;
  ball.colour = Vec3(0.8, 0.8, 0.8);
  DrawList list;
  list.surfaces = {ball};
  Camera camera;
  camera.distance = 0.5;
  Look look;
  look.light = "dramatic";
  look.has_occlusion = false;
  const Image image = Renderer(size, size).draw_with(list, camera, look);
  // The light itself is warm: what it lights fully is the measure.
  const auto redness = [&](int x, int y) {
    const uint8_t* p = &image.pixels[3 * static_cast<size_t>(y * size + x)];
    return p[1] > 25 ? static_cast<double>(p[0]) / p[1] : 0.0;
  };
  double reddest = 0.0, brightest = 0.0, measure = 1.0;
  for (int x = 0; x < size; ++x)
    for (int y = 0; y < size; ++y) {
      if (std::hypot(x - 48.0, y - 48.0) > 20.0) continue;
      reddest = std::max(reddest, redness(x, y));
      const double green = image.pixels[3 * static_cast<size_t>(y * size + x) + 1];
      if (green <= brightest) continue;
      brightest = green;
      measure = redness(x, y);
    }
  EXPECT_LT(reddest, 2.3 * measure);
}

}  // namespace
}  // namespace fascia::view
