#include "builder/prepare/prepare.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/prepare/eyeballs.h"
#include "builder/prepare/part_names.h"
#include "builder/prepare/parts.h"
#include "builder/prepare/tooth_rows.h"
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
      mesh.positions.push_back(centre + radius * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                                      -std::sin(theta) * std::sin(phi)));
    }
  const auto at = [&](int r, int s) { return r * (sectors + 1) + s; };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  return mesh;
}

/// Landmarks on the sphere that stands for a head.
Landmarks reference() {
  Landmarks points = {{"nasion", Vec3(0, 0.04, 0.10)},
                      {"gnathion", Vec3(0, -0.07, 0.10)},
                      {"exocanthion_left", Vec3(0.045, 0.035, 0.08)},
                      {"exocanthion_right", Vec3(-0.045, 0.035, 0.08)}};
  for (auto& [name, p] : points)
    p = 0.11 * p.normalized();
  return points;
}

/// A "head": a sphere of 11 cm radius with an eye, in the units and axes of `to_file`.
formats::Scene scene_in(const Mat4& to_file) {
  formats::Scene scene;
  scene.kind = formats::FileKind::obj;
  scene.path = "sphere.obj";
  scene.meshes = {seamed_sphere("head", Vec3(0, 0, 0), 0.11),
                  seamed_sphere("l-eye", Vec3(0.031, 0.035, 0.09), 0.012)};
  for (auto& mesh : scene.meshes)
    for (Vec3& p : mesh.positions)
      p = transform_point(to_file, p);
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
    EXPECT_NEAR(head.landmarks.at("exocanthion_left")[0],
                0.11 * reference()["exocanthion_left"].normalized()[0], 2e-3);
  }
}

TEST(Prepare, ATiltedHeadIsSetUprightAndOneAlongTheAxesKeepsThem) {
  for (const double tilt : {0.03, 0.15, 0.4}) {
    Mat4 to_file = Mat4::Identity();
    to_file.topLeftCorner<3, 3>() =
        100.0 * Eigen::AngleAxisd(tilt, Vec3(0.3, 1.0, -0.2).normalized()).toRotationMatrix();
    const PreparedHead head = prepare(scene_in(to_file), landmarks_in(to_file, 1.0, ""), reference(), {});
    const Mat4 rest = head.input_to_metres * to_file;
    if (tilt < 0.1)
      EXPECT_NEAR((head.input_to_metres.topLeftCorner<3, 3>() - 0.01 * Mat3::Identity()).norm(), 0.0, 1e-12);
    else
      EXPECT_NEAR((rest - Mat4::Identity()).norm(), 0.0, 1e-9) << tilt;
  }
}

TEST(Prepare, ALandmarkFarOffTheSkinIsRefusedWhereItWasGivenAndTakenWhereItIsRough) {
  const formats::Scene scene = scene_in(Mat4::Identity());
  formats::LandmarkFile file = landmarks_in(Mat4::Identity(), 1.0, "m");
  file.points["pronasale"] = Vec3(0, 0, 0.16);
  EXPECT_THROW(prepare(scene, file, reference(), {}), Error);
  PrepareOptions options;
  options.rough_landmarks = {"pronasale"};
  const PreparedHead head = prepare(scene, file, reference(), options);
  EXPECT_NEAR(head.landmarks.at("pronasale").norm(), 0.11, 2e-3);
  for (const std::string& warning : head.warnings)
    EXPECT_EQ(warning.find("pronasale"), std::string::npos) << warning;
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
  scene.meshes = {seamed_sphere("upper", Vec3(0, 0.1, 0), 0.1),
                  seamed_sphere("lower", Vec3(0, -0.1, 0), 0.1)};
  const WeldedScene welded = weld_scene(scene, Mat4::Identity());
  // The poles are on the open edges of collapsed triangles and may merge; the surfaces' own rings may not.
  scene.meshes[0].positions[30] = scene.meshes[1].positions[40];
  const WeldedScene touching = weld_scene(scene, Mat4::Identity());
  EXPECT_NE(touching.vertex_map[0][30], touching.vertex_map[1][40]);
}

TEST(Prepare, ReportsASecondHead) {
  formats::Scene scene = scene_in(Mat4::Identity());
  const auto says = [&](const char* what = "another head ('twin')") {
    for (const std::string& warning :
         prepare(scene, landmarks_in(Mat4::Identity(), 1.0, ""), reference(), {}).warnings)
      if (warning.find(what) != std::string::npos) return true;
    return false;
  };
  EXPECT_FALSE(says());
  scene.meshes.push_back(seamed_sphere("twin", Vec3(0.4, 0, 0), 0.1));
  EXPECT_TRUE(says());
  scene.meshes.back() = seamed_sphere("twin", Vec3(0.4, 0, 0), 0.05);  // smaller by half: something else
  EXPECT_FALSE(says());
  scene.meshes.back() = seamed_sphere("twin", Vec3(0, 0.01, 0), 0.12);  // about the head, as hair is
  EXPECT_FALSE(says());
  EXPECT_FALSE(says("the skin twice"));
  scene.meshes.back() = seamed_sphere("twin", Vec3(0.001, 0, 0), 0.11);
  EXPECT_TRUE(says("the skin twice: 'twin' lies on 'head'") || says("the skin twice: 'head' lies on 'twin'"));
}

TEST(Prepare, RefusesLandmarksWhoseSidesAreExchanged) {
  Landmarks face = reference();
  face["cheilion_left"] = 0.11 * Vec3(0.03, -0.04, 0.10).normalized();
  face["cheilion_right"] = 0.11 * Vec3(-0.03, -0.04, 0.10).normalized();
  face["tragion_left"] = 0.11 * Vec3(1, 0.2, 0).normalized();
  face["tragion_right"] = 0.11 * Vec3(-1, 0.2, 0).normalized();
  formats::LandmarkFile given;
  given.units = "m";
  given.points = face;
  EXPECT_NO_THROW(prepare(scene_in(Mat4::Identity()), given, face, {}));
  for (const char* name : {"exocanthion", "cheilion", "tragion"})
    std::swap(given.points[std::string(name) + "_left"], given.points[std::string(name) + "_right"]);
  try {
    prepare(scene_in(Mat4::Identity()), given, face, {});
    FAIL() << "nothing was said";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("call left what is right"), std::string::npos) << error.what();
  }
}

/// How many of a head's warnings contain `text`.
size_t warnings_with(const PreparedHead& head, const std::string& text) {
  return static_cast<size_t>(
      std::count_if(head.warnings.begin(), head.warnings.end(),
                    [&](const std::string& w) { return w.find(text) != std::string::npos; }));
}

TEST(Prepare, SuggestsTheNearestLandmarkName) {
  formats::LandmarkFile given = landmarks_in(Mat4::Identity(), 1.0, "");
  given.points["nasionn"] = Vec3(0, 0, 0);
  try {
    prepare(scene_in(Mat4::Identity()), given, reference(), {});
    FAIL() << "nothing was said";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'nasion'"), std::string::npos) << error.what();
  }
}

TEST(Prepare, UnitsThatDoNotFitTheHeadAreSaidOrRefused) {
  const formats::Scene scene = scene_in(Mat4::Identity());  // in metres
  const formats::LandmarkFile given = landmarks_in(Mat4::Identity(), 1.0, "");
  PrepareOptions options;
  for (const auto& [units, warnings] : {std::pair{"m", 0U}, {"0.7", 0U}, {"3", 1U}, {"0.2", 1U}}) {
    options.units = units;
    const PreparedHead head = prepare(scene, given, reference(), options);
    EXPECT_EQ(warnings_with(head, "correct --units"), warnings) << units;
  }
  for (const char* units : {"mm", "cm", "100"}) {
    options.units = units;
    EXPECT_THROW(prepare(scene, given, reference(), options), Error) << units;
  }
}

TEST(Prepare, ReportsInvalidInput) {
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

TEST(PartNames, AreReadByTheirWords) {
  const auto part = [](const char* name) { return part_by_name(name).part; };
  EXPECT_EQ(part("Eyelashes_L"), Part::lashes);
  EXPECT_EQ(part("maleEyebrow001"), Part::brows);
  EXPECT_EQ(part("CC_Base_EyeOcclusion"), Part::eye_surround);
  EXPECT_EQ(part("upper-teeth"), Part::teeth_upper);
  EXPECT_EQ(part("gums_tongue"), Part::mouth_interior);
  EXPECT_EQ(part("gums_lower"), Part::gums_upper);  // which jaw is said beside
  EXPECT_EQ(part_by_name("gums_lower").jaw, NamedPart::Jaw::lower);
  EXPECT_EQ(part("Hair_Brown"), Part::hair);
  EXPECT_EQ(part("SunGlasses 02"), Part::glasses);
  EXPECT_EQ(part("T_Shirt"), Part::clothes);
  for (const char* nothing :
       {"brown_leather", "student", "accident", "splash", "chair", "flash", "gumboot", "head", ""})
    EXPECT_FALSE(part(nothing)) << nothing;
  EXPECT_TRUE(part_by_name("l-eye").says_eye);
  EXPECT_FALSE(part_by_name("eye_blend").says_eye);
}

/// Landmarks of an ordinary face, rig frame.
Landmarks face_landmarks() {
  return {{"exocanthion_left", Vec3(0.045, 0.035, 0.08)},
          {"exocanthion_right", Vec3(-0.045, 0.035, 0.08)},
          {"endocanthion_left", Vec3(0.017, 0.034, 0.09)},
          {"endocanthion_right", Vec3(-0.017, 0.034, 0.09)},
          {"cheilion_left", Vec3(0.025, -0.035, 0.095)},
          {"cheilion_right", Vec3(-0.025, -0.035, 0.095)},
          {"stomion", Vec3(0, -0.035, 0.11)},
          {"glabella", Vec3(0, 0.055, 0.105)},
          {"nasion", Vec3(0, 0.04, 0.10)},
          {"menton", Vec3(0, -0.085, 0.09)},
          {"tragion_left", Vec3(0.072, 0.02, 0.0)},
          {"tragion_right", Vec3(-0.072, 0.02, 0.0)}};
}

/// What a stretched ball of this name, middle and half sizes is taken for beside a head.
Part taken_for(const std::string& name, const Vec3& centre, const Vec3& half_size) {
  formats::Scene scene;
  scene.kind = formats::FileKind::obj;
  scene.path = "parts.obj";
  scene.meshes = {seamed_sphere("head", Vec3::Zero(), 0.11), seamed_sphere(name, Vec3::Zero(), 1.0)};
  for (Vec3& p : scene.meshes[1].positions)
    p = centre + half_size.cwiseProduct(p);
  const WeldedScene welded = weld_scene(scene, Mat4::Identity());
  const Parts parts = recognise_parts(scene, welded, face_landmarks(), {});
  for (size_t t = 0; t < welded.component.size(); ++t)
    if (welded.triangle_mesh[t] == 1) return parts.component_parts[static_cast<size_t>(welded.component[t])];
  return Part::skin;
}

TEST(Parts, ShapeAndPlaceGoBeforeNames) {
  const Vec3 in_socket(0.031, 0.034, 0.072), ball = Vec3::Constant(0.012);
  EXPECT_EQ(taken_for("Object_1", in_socket, ball), Part::eye_left);
  EXPECT_EQ(taken_for("teeth", in_socket, ball), Part::eye_left);
  // Names choose among what place allows.
  const Vec3 in_mouth(0, -0.02, 0.07), row(0.025, 0.008, 0.02);
  EXPECT_EQ(taken_for("hair", in_mouth, row), Part::teeth_upper);
  EXPECT_EQ(taken_for("gums", in_mouth, row), Part::gums_upper);
  EXPECT_EQ(taken_for("gums", in_mouth - Vec3(0, 0.03, 0), row), Part::gums_lower);
  EXPECT_EQ(taken_for("teeth", Vec3(0, -0.4, 0), Vec3(0.2, 0.15, 0.1)), Part::clothes);
}

TEST(Parts, GlassesClothesAndHairByShapeAndPlace) {
  EXPECT_EQ(taken_for("a", Vec3(0, 0.035, 0.055), Vec3(0.072, 0.02, 0.06)), Part::glasses);
  EXPECT_EQ(taken_for("a", Vec3(0, 0.1, 0), Vec3(0.09, 0.06, 0.1)), Part::hair);
  EXPECT_EQ(taken_for("a", Vec3(0, -0.35, 0), Vec3(0.2, 0.2, 0.12)), Part::clothes);
}

TEST(Eyeballs, LookThroughTheirCornea) {
  formats::SceneMesh eye = seamed_sphere("e", Vec3::Zero(), 0.012);
  const Vec3 gaze = Vec3(0.2, -0.1, 1).normalized();
  for (Vec3& p : eye.positions)
    p *= 1.0 + 0.1 * std::exp(-std::pow(std::acos(std::clamp(p.normalized().dot(gaze), -1.0, 1.0)) / 0.3, 2));
  const Eyeball ball = fit_sphere(eye.positions, nullptr);
  EXPECT_GT(gaze_axis(ball, eye.positions, eye.triangles).dot(gaze), std::cos(0.1));
}

TEST(Eyeballs, LookThroughTheirPole) {
  formats::SceneMesh eye = seamed_sphere("e", Vec3::Zero(), 0.012);
  const Mat3 turn = (Eigen::AngleAxisd(0.3, Vec3::UnitY()) * Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitX()))
                        .toRotationMatrix();
  TriangleMesh mesh;
  std::vector<int> map;
  mesh.vertices = eye.positions;
  mesh.triangles = eye.triangles;
  for (Vec3& p : mesh.vertices)
    p = turn * p;
  mesh = weld(mesh, 1e-9, &map);
  EXPECT_GT(gaze_axis({Vec3::Zero(), 0.012}, mesh.vertices, mesh.triangles).dot(turn * Vec3::UnitY()), 0.999);
  EXPECT_EQ(gaze_axis({Vec3::Zero(), 0.012}, {}, {}), Vec3::UnitZ());
}

/// Bounds about `centre`, `size` across; metres.
Bounds box(const Vec3& centre, const Vec3& size) {
  return {centre - 0.5 * size, centre + 0.5 * size};
}

/// Single teeth in two rows that curve about the arch and slope and tilt by so much a metre.
std::vector<Bounds> single_teeth(double slope, double tilt, double curve, double overbite) {
  std::vector<Bounds> teeth;
  for (const bool lower : {false, true})
    for (int k = -6; k <= 6; ++k) {
      const double angle = 0.24 * k, radius = lower ? 0.022 : 0.024;
      const Vec3 at(radius * std::sin(angle), 0.0, 1.4 * radius * std::cos(angle));
      const double height = slope * at.z() + tilt * at.x() + curve * at.z() * at.z();
      teeth.push_back(box(at + Vec3(0, height + (lower ? -1 : 1) * (0.0045 - 0.5 * overbite), 0),
                          Vec3(0.0062, 0.009 + 0.001 * (k % 2), 0.007)));
    }
  return teeth;
}

TEST(ToothRows, SingleTeethOfSlopingTiltedAndCurvedRows) {
  for (const double slope : {-0.3, 0.0, 0.3})
    for (const double tilt : {-0.12, 0.0, 0.12})
      for (const double curve : {-6.0, 0.0, 6.0})
        for (const double overbite : {-0.012, 0.0, 0.003}) {
          const std::vector<Bounds> teeth = single_teeth(slope, tilt, curve, overbite);
          const auto lower = lower_row(teeth);
          ASSERT_TRUE(lower.has_value());
          for (size_t i = 0; i < teeth.size(); ++i)
            EXPECT_EQ((*lower)[i], i >= teeth.size() / 2)
                << i << " " << slope << " " << tilt << " " << curve << " " << overbite;
        }
}

TEST(ToothRows, WholeJawsWithTheirGums) {
  const std::vector<Bounds> jaws = {box(Vec3(0, 0.008, 0), Vec3(0.05, 0.010, 0.04)),
                                    box(Vec3(0, 0.012, 0), Vec3(0.054, 0.014, 0.042)),
                                    box(Vec3(0, -0.001, -0.002), Vec3(0.048, 0.010, 0.038)),
                                    box(Vec3(0, -0.006, -0.002), Vec3(0.052, 0.012, 0.04))};
  EXPECT_EQ(lower_row(jaws), (std::vector<bool>{false, false, true, true}));
}

TEST(ToothRows, OneRowAloneIsNotParted) {
  std::vector<Bounds> teeth = single_teeth(0.3, 0.1, 5.0, 0.0);
  teeth.resize(teeth.size() / 2);
  EXPECT_FALSE(lower_row(teeth).has_value());
  EXPECT_FALSE(lower_row({}).has_value());
}

TEST(Eyeballs, ScaleWithTheFissureAndAreNotHollow) {
  const auto cap = [](double radius, double back) {  // the front of a ball; `back` -1 makes it hollow
    std::vector<Vec3> points;
    for (int i = 0; i < 12; ++i)
      for (int k = 1; k < 6; ++k) {
        const double a = 2 * M_PI * i / 12, b = 0.25 * k;
        points.push_back(radius *
                         Vec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), back * std::cos(b)));
      }
    return points;
  };
  EXPECT_TRUE(round_part(cap(0.012, 1.0), Vec3(0, 0, 0.010), 0.030));
  EXPECT_FALSE(round_part(cap(0.040, 1.0), Vec3(0, 0, 0.034), 0.030));
  EXPECT_TRUE(round_part(cap(0.040, 1.0), Vec3(0, 0, 0.034), 0.070)) << "a third of a toon's face";
  EXPECT_FALSE(round_part(cap(0.012, -1.0), Vec3(0, 0, -0.010), 0.030)) << "a hollow turns about its front";
  const Bounds plate = box(Vec3(0.03, 0.01, 0.05), Vec3(0.04, 0.03, 0.004));
  const Eyeball globe = globe_behind(plate, 0.045);
  EXPECT_LT(globe.centre.z() + 0.8 * globe.radius, plate.lower.z());
  EXPECT_NEAR(globe.centre.z() + globe.radius, plate.upper.z(), 1e-12);
  EXPECT_GT(2.0 * globe.radius, plate.size().x());
}

}  // namespace
}  // namespace fascia::prepare
