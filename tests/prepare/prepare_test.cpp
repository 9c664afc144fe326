#include "builder/prepare/prepare.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "builder/prepare/parts.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::prepare {
namespace {

/// A sphere as a latitude grid with a doubled seam, as texture coordinates make it.
formats::SceneMesh seamed_sphere(const std::string& name, const Vec3& centre, double radius) {
  formats::SceneMesh mesh;
  mesh.name = name;
  const int rings = 12, sectors = 24;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s <= sectors; ++s) {
      const double theta = EIGEN_PI * r / rings, phi = 2 * EIGEN_PI * (s % sectors) / sectors;
      mesh.positions.push_back(centre + radius * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)));
    }
  const auto at = [&](int r, int s) { return r * (sectors + 1) + s; };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  return mesh;
}

std::map<std::string, Vec3> reference() {
  return {{"nasion", Vec3(0, 0.04, 0.10)},
          {"gnathion", Vec3(0, -0.07, 0.10)},
          {"exocanthion_left", Vec3(0.045, 0.035, 0.08)},
          {"exocanthion_right", Vec3(-0.045, 0.035, 0.08)}};
}

/// A "head": a sphere of 11 cm radius with an eye, in the units and axes of `to_file`.
formats::Scene scene_in(const Mat4& to_file) {
  formats::Scene scene;
  scene.kind = formats::FileKind::obj;
  scene.path = "sphere.obj";
  scene.meshes = {seamed_sphere("head", Vec3(0, 0, 0), 0.11), seamed_sphere("l-eye", Vec3(0.031, 0.035, 0.09), 0.012)};
  for (auto& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p = transform_point(to_file, p);
  return scene;
}

formats::LandmarkFile landmarks_in(const Mat4& to_file, double ratio, const std::string& units) {
  formats::LandmarkFile file;
  file.units = units;
  for (const auto& [name, p] : reference()) {
    const Vec3 on_sphere = 0.11 * p.normalized();
    file.points[name] = ratio * transform_point(to_file, on_sphere);
  }
  return file;
}

TEST(Prepare, FindsUnitsAndAxesFromLandmarks) {
  Mat3 z_up;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // rig (x, y, z) -> file (x, -z, y)
  for (const auto& [metres, name] : std::map<double, std::string>{{1.0, "m"}, {0.01, "cm"}, {0.001, "mm"}}) {
    Mat4 to_file = Mat4::Identity();
    to_file.topLeftCorner<3, 3>() = z_up / metres;
    const PreparedHead head = prepare(scene_in(to_file), landmarks_in(to_file, 1.0, ""), reference(), {});
    EXPECT_EQ(head.units, name);
    EXPECT_NEAR((head.input_to_metres * to_file - Mat4::Identity()).norm(), 0.0, 1e-12);
    EXPECT_NEAR(head.landmarks.at("exocanthion_left")[0], 0.11 * reference()["exocanthion_left"].normalized()[0], 2e-3);
  }
}

TEST(Prepare, TakesLandmarksInOtherUnitsThanTheHead) {
  const Mat4 to_file = Mat4::Identity();
  const PreparedHead head = prepare(scene_in(to_file), landmarks_in(to_file, 1000.0, "mm"), reference(), {});
  EXPECT_NEAR(head.landmarks.at("nasion").norm(), 0.11, 2e-3);
}

TEST(Prepare, WeldsSeamsAndKeepsTheInputAsItCame) {
  const Mat4 to_file = Mat4::Identity();
  const formats::Scene scene = scene_in(to_file);
  const PreparedHead head = prepare(scene, landmarks_in(to_file, 1.0, ""), reference(), {});
  EXPECT_LT(head.skin.vertex_count(), static_cast<int>(scene.meshes[0].positions.size()));
  EXPECT_TRUE(boundary_loops(head.skin, connectivity(head.skin)).empty());
  ASSERT_EQ(head.meshes.size(), 2u);
  EXPECT_EQ(head.meshes[0].positions.size(), scene.meshes[0].positions.size());
  for (size_t v = 0; v < head.meshes[0].positions.size(); ++v) {
    const int at = head.meshes[0].skin_vertices[v];
    ASSERT_GE(at, 0);
    EXPECT_LT((head.skin.vertices[static_cast<size_t>(at)] - head.meshes[0].positions[v]).norm(), 1e-6);
  }
}

TEST(Prepare, FindsTheEyeballByItsShape) {
  const Mat4 to_file = Mat4::Identity();
  formats::Scene scene = scene_in(to_file);
  scene.meshes[1].name = "Object_7";  // no help from names
  auto file = landmarks_in(to_file, 1.0, "");
  auto known = reference();
  file.points["endocanthion_left"] = known["endocanthion_left"] = 0.11 * Vec3(0.018, 0.035, 0.1).normalized();
  const PreparedHead head = prepare(scene, file, known, {});
  ASSERT_TRUE(head.eye_left.has_value());
  EXPECT_NEAR(head.eye_left->radius, 0.012, 1e-4);
  EXPECT_NEAR((head.eye_left->centre - Vec3(0.031, 0.035, 0.09)).norm(), 0.0, 1e-4);
  EXPECT_EQ(head.meshes[1].parts[0], Part::eye_left);
  EXPECT_FALSE(head.eye_right.has_value());
}

TEST(Prepare, TouchingLipsStayTwo) {
  // Two closed tubes that share the position of a vertex are not one surface.
  formats::Scene scene;
  scene.path = "lips.obj";
  scene.meshes = {seamed_sphere("upper", Vec3(0, 0.1, 0), 0.1), seamed_sphere("lower", Vec3(0, -0.1, 0), 0.1)};
  const WeldedScene welded = weld_scene(scene, Mat4::Identity());
  // The poles are on the open edges of collapsed triangles and may merge; the surfaces' own rings may not.
  scene.meshes[0].positions[30] = scene.meshes[1].positions[40];
  const WeldedScene touching = weld_scene(scene, Mat4::Identity());
  EXPECT_NE(touching.vertex_map[0][30], touching.vertex_map[1][40]);
}

TEST(Prepare, SaysWhatIsWrong) {
  const Mat4 to_file = Mat4::Identity();
  const formats::Scene scene = scene_in(to_file);
  auto file = landmarks_in(to_file, 1.0, "");
  file.points["gnathion"] = Vec3(0, -0.3, 0.1);
  EXPECT_THROW(prepare(scene, file, reference(), {}), Error);
  formats::LandmarkFile two;
  two.points = {{"nasion", Vec3(0, 0.04, 0.10)}, {"gnathion", Vec3(0, -0.07, 0.10)}};
  EXPECT_THROW(prepare(scene, two, reference(), {}), Error);
  PrepareOptions options;
  options.skin = "no_such";
  EXPECT_THROW(prepare(scene, landmarks_in(to_file, 1.0, ""), reference(), options), Error);
  options = {};
  options.units = "ell";
  EXPECT_THROW(prepare(scene, landmarks_in(to_file, 1.0, ""), reference(), options), Error);
}

TEST(FitSphere, RecoversASphereExactly) {
  const auto mesh = seamed_sphere("s", Vec3(1, 2, 3), 0.5);
  double rms = 1;
  const Eyeball sphere = fit_sphere(mesh.positions, &rms);
  EXPECT_NEAR((sphere.centre - Vec3(1, 2, 3)).norm(), 0, 1e-12);
  EXPECT_NEAR(sphere.radius, 0.5, 1e-12);
  EXPECT_LT(rms, 1e-12);
}

}  // namespace
}  // namespace fascia::prepare
