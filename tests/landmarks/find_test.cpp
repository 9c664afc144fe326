// Finding a head and its landmarks, on the embedded head and on shapes that are no head.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "builder/landmarks/find.h"
#include "builder/landmarks/lid_opening.h"
#include "builder/landmarks/lip_opening.h"
#include "builder/landmarks/nose_profile.h"
#include "builder/landmarks/spheres.h"
#include "builder/rigging/find_landmarks.h"
#include "geometry/error.h"

namespace fascia::landmarks {
namespace {

const anatomy::GenericAnatomy& generic_anatomy() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

const GenericFace& face() {
  static const GenericFace generic = generic_face(generic_anatomy());
  return generic;
}

/// A closed surface given by its distance from the origin in each direction.
template <class Distance>
TriangleMesh star_shape(Distance distance) {
  TriangleMesh mesh;
  const int rings = 60, sectors = 120;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      const double theta = EIGEN_PI * r / rings, phi = 2 * EIGEN_PI * s / sectors;
      const Vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
      mesh.vertices.push_back(distance(d) * d);
    }
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      const int next = (s + 1) % sectors;
      mesh.triangles.push_back({r * sectors + s, (r + 1) * sectors + s, (r + 1) * sectors + next});
      mesh.triangles.push_back({r * sectors + s, (r + 1) * sectors + next, r * sectors + next});
    }
  return mesh;
}

/// The embedded head as a file would bring it.
formats::Scene embedded_scene(const Mat3& rotation, double units_per_metre, const Vec3& shift,
                              bool is_inside_out = false) {
  formats::Scene scene;
  scene.kind = formats::FileKind::obj;
  scene.path = "embedded.obj";
  for (const anatomy::MeshObject& object : generic_anatomy().head) {
    formats::SceneMesh mesh;
    mesh.name = "part_" + std::to_string(scene.meshes.size());  // no help from names
    for (const Vec3& p : object.mesh.vertices)
      mesh.positions.push_back(units_per_metre * (rotation * p + shift));
    mesh.triangles = object.mesh.triangles;
    if (is_inside_out)
      for (Triangle& t : mesh.triangles)
        std::swap(t[0], t[1]);
    scene.meshes.push_back(mesh);
  }
  return scene;
}

Mat3 turn(double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()).toRotationMatrix();
}

/// Largest distance in millimetres between the found landmarks of the face and the known ones.
double largest_error_mm(const rigging::FoundLandmarks& found, const Mat3& rotation, double units_per_metre,
                        const Vec3& shift) {
  const Mat4 to_file = found.head.input_to_metres.inverse();
  double largest = 0.0;
  for (const char* name : {"pronasale", "subnasale", "stomion", "cheilion_left", "cheilion_right",
                           "exocanthion_left", "exocanthion_right", "endocanthion_left", "endocanthion_right",
                           "labiale_superius", "menton", "glabella", "alare_left"}) {
    const Vec3 known = rotation * *generic_anatomy().landmark(name)->skin + shift;
    const Vec3 here = transform_point(to_file, found.landmarks.at(name).position) / units_per_metre;
    largest = std::max(largest, 1e3 * (here - known).norm());
  }
  return largest;
}

TEST(FitBall, RecoversASphere) {
  const Ball ball = fit_ball(star_shape([](const Vec3&) { return 0.25; }).vertices);
  EXPECT_NEAR(ball.radius, 0.25, 1e-12);
  EXPECT_LT(ball.centre.norm(), 1e-12);
  EXPECT_EQ(fit_ball({Vec3::Zero()}).radius, 0.0);
}

TEST(RoundLumps, FindTheBallOnTheStick) {
  TriangleMesh mesh = star_shape([](const Vec3&) { return 0.1; });
  TriangleMesh stick =
      star_shape([](const Vec3& d) { return 0.05 / std::max(0.06, std::hypot(d[0], d[2])); });
  const int base = mesh.vertex_count();
  for (const Vec3& p : stick.vertices)
    mesh.vertices.push_back(p - Vec3(0, 0.9, 0));
  for (const Triangle& t : stick.triangles)
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  const Samples samples = sample_evenly(mesh, 6000);
  const std::vector<Ball> lumps = round_lumps(samples, 4);
  ASSERT_FALSE(lumps.empty());
  EXPECT_LT(lumps.front().centre.norm(), 0.02);
  EXPECT_NEAR(lumps.front().radius, 0.1, 0.01);
}

TEST(GenericFace, IsSymmetricAndDenseWhereFacesDiffer) {
  const GenericFace& generic = face();
  ASSERT_GT(generic.points.size(), 400u);
  for (size_t i = 0; i < generic.points.size(); ++i) {
    const Vec3& p = generic.points.points[i];
    const Vec3& q = generic.points.points[static_cast<size_t>(generic.mirror[i])];
    EXPECT_LT((Vec3(-p[0], p[1], p[2]) - q).norm(), 1e-9);
  }
  EXPECT_EQ(generic.region_of_triangle.size(), generic.skin.triangles.size());
  for (int region : generic.region_of_triangle)
    EXPECT_GE(region, 0);
}

TEST(RefinePlacement, ComesBackFromNearby) {
  const Neighbours target(open_samples(sample_evenly(face().skin, 6000), spatial::SurfaceQuery(face().skin)));
  Placement off;
  off.rotation = turn(12, Vec3(1, 2, -1));
  off.scale = 1.08;
  off.shift = Vec3(0.01, -0.006, 0.004);
  const Placement back = refine_placement(face(), target, off, 40, 2);
  EXPECT_NEAR(back.scale, 1.0, 0.01);
  EXPECT_LT((back(Vec3(0, 0, 0.1)) - Vec3(0, 0, 0.1)).norm(), 0.0015);
}

TEST(LidOpening, IsSeenWhereTheLidsAreOpenAndNowhereElse) {
  const auto point = [](const char* name) { return *generic_anatomy().landmark(name)->skin; };
  const EyeRegion eye = {point("exocanthion_left"), point("endocanthion_left"), Vec3::UnitZ(), Vec3::UnitY(),
                         face().eye_left};
  const spatial::SurfaceQuery skin(face().skin);
  const auto open = lid_opening(skin, eye);
  ASSERT_TRUE(open.has_value());
  EXPECT_LT((open->outer - eye.outer).norm(), 0.004);
  EXPECT_LT((open->inner - eye.inner).norm(), 0.004);
  EXPECT_LT((open->upper - point("palpebrale_superius_left")).norm(), 0.004);
  EXPECT_LT((open->lower - point("palpebrale_inferius_left")).norm(), 0.004);
  EyeRegion cheek = eye;
  for (Vec3* p : {&cheek.outer, &cheek.inner, &cheek.ball.centre})
    (*p)[1] -= 0.03;
  EXPECT_FALSE(lid_opening(skin, cheek).has_value());
}

TEST(LipOpening, EndsAtTheCornersForAnySearchWidth) {
  const Vec3 left = *generic_anatomy().landmark("cheilion_left")->skin,
             right = *generic_anatomy().landmark("cheilion_right")->skin, middle = 0.5 * (left + right);
  const spatial::SurfaceQuery skin(face().skin);
  const SkinLinks links(face().skin);
  const auto seen = [&](double growth, const Vec3& shift) {
    return lip_opening(skin, links,
                       {middle + growth * (left - middle) + shift, middle + growth * (right - middle) + shift,
                        Vec3::UnitZ()});
  };
  for (const double growth : {0.8, 1.0, 1.6}) {
    const auto open = seen(growth, Vec3::Zero());
    ASSERT_TRUE(open.has_value()) << growth;
    // A way around the corner of less than three tenths of the width looked for is no opening yet.
    const double unseen = 0.15 * growth * (left - right).norm();
    EXPECT_NEAR(open->left.x(), left.x() - unseen, 0.004) << growth;
    EXPECT_NEAR(open->right.x(), right.x() + unseen, 0.004) << growth;
    EXPECT_NEAR(open->left.y(), left.y(), 0.004) << growth;
  }
  EXPECT_FALSE(seen(1.0, Vec3(0.0, -0.03, 0.0)).has_value()) << "the chin";
  EXPECT_FALSE(seen(1.0, Vec3(0.0, 0.09, 0.0)).has_value()) << "the forehead";
}

/// A sheet, 10 cm by 14, that comes forward by `nose` metres 2 cm above its middle and by `lips` 2 cm below.
spatial::SurfaceQuery sheet(double nose, double lips) {
  constexpr int n = 60;
  const auto bump = [](double y, double at, double width) {
    return std::exp(-0.5 * std::pow((y - at) / width, 2));
  };
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 0.1 * i / n - 0.05, y = 0.14 * j / n - 0.07;
      mesh.vertices.emplace_back(x, y, nose * bump(y, 0.02, 0.005) + lips * bump(y, -0.02, 0.009));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return spatial::SurfaceQuery(std::move(mesh));
}

TEST(NoseProfile, IsTheFirstRiseThoughTheLipsStandFartherForward) {
  const Midline midline = {Vec3(0, 0.05, 0), Vec3(0, -0.06, 0), Vec3::UnitZ(), 1.0};
  const auto nose = nose_profile(sheet(0.008, 0.014), midline);
  ASSERT_TRUE(nose);
  EXPECT_NEAR(nose->tip.y(), 0.02, 0.002);
  ASSERT_TRUE(nose->base);
  EXPECT_NEAR(nose->base->y(), 0.006, 0.003);
  EXPECT_FALSE(nose_profile(sheet(0.0, 0.0), midline));
  EXPECT_FALSE(nose_profile(sheet(0.002, 0.0), midline)) << "less than a nose";
}

TEST(FindLandmarks, OnTheEmbeddedHeadInAnyPoseAndUnit) {
  struct Case {
    Mat3 rotation;
    double units_per_metre;
    const char* units;
    bool is_inside_out;
  };
  const std::vector<Case> cases = {{Mat3::Identity(), 1.0, "m", false},
                                   {turn(180, Vec3::UnitZ()), 1000.0, "mm", false},  // upside down
                                   {turn(180, Vec3::UnitY()), 100.0, "cm", false},   // back to the viewer
                                   {turn(130, Vec3(1, 2, 3)), 100.0, "cm", true}};
  const Vec3 shift(0.3, -1.2, 0.7);
  for (const Case& c : cases) {
    const rigging::FoundLandmarks found =
        rigging::find_landmarks(embedded_scene(c.rotation, c.units_per_metre, shift, c.is_inside_out), {},
                                generic_anatomy(), {}, true);
    EXPECT_EQ(found.head.units, c.units);
    EXPECT_EQ(found.is_inside_out, c.is_inside_out);
    EXPECT_LT(largest_error_mm(found, c.rotation, c.units_per_metre, shift), 2.0);
    // The face looks along +Z with the subject's left at +X, whatever the file's axes.
    EXPECT_GT(found.landmarks.at("exocanthion_left").position[0],
              found.landmarks.at("exocanthion_right").position[0] + 0.05);
    EXPECT_GT(found.landmarks.at("glabella").position[1], found.landmarks.at("menton").position[1] + 0.08);
    for (const auto& [name, landmark] : found.landmarks) {
      EXPECT_GE(landmark.confidence, 0.0) << name;
      EXPECT_LE(landmark.confidence, 1.0) << name;
    }
    for (const char* name : {"pronasale", "cheilion_left", "exocanthion_right"})
      EXPECT_GT(found.landmarks.at(name).confidence, 0.5) << name;
    ASSERT_TRUE(found.head.eye_left && found.head.eye_right);
    ASSERT_TRUE(found.regions);
    EXPECT_EQ(found.regions->of_vertex.size(), found.head.skin.vertices.size());
  }
}

TEST(FindLandmarks, KeepsGivenOnesAndBendsTheRestTowardThem) {
  const formats::Scene scene = embedded_scene(Mat3::Identity(), 1.0, Vec3::Zero());
  const rigging::FoundLandmarks free = rigging::find_landmarks(scene, {}, generic_anatomy());
  formats::LandmarkFile given;
  const Vec3 moved = free.landmarks.at("cheilion_left").position + Vec3(0.006, 0.0, -0.002);
  given.points["cheilion_left"] = moved;
  const rigging::FoundLandmarks steered = rigging::find_landmarks(scene, given, generic_anatomy());
  EXPECT_TRUE(steered.landmarks.at("cheilion_left").is_given);
  EXPECT_EQ(steered.landmarks.at("cheilion_left").confidence, 1.0);
  EXPECT_LT((steered.landmarks.at("cheilion_left").position - moved).norm(), 0.002);
  const double drawn = steered.landmarks.at("labiale_superius_laterale_left").position[0] -
                       free.landmarks.at("labiale_superius_laterale_left").position[0];
  EXPECT_GT(drawn, 0.0005);
  EXPECT_LT(
      (steered.landmarks.at("exocanthion_right").position - free.landmarks.at("exocanthion_right").position)
          .norm(),
      0.002);
}

TEST(FindHead, LooksOnlyWhereTheCrownMayBe) {
  const auto crown = [](const std::optional<Vec3>& up) -> Vec3 {
    return find_head(face(), face().skin, "head.obj", {{}, up}).placement().rotation.col(1);
  };
  EXPECT_GT(crown(Vec3::UnitY()).dot(Vec3::UnitY()), 0.98);
  // Told wrongly it must not be found the right way up.
  try {
    EXPECT_GT(crown(-Vec3::UnitY())[1], -1.0);
    EXPECT_LT(crown(-Vec3::UnitY())[1], 0.0);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("no face was found"), std::string::npos);
  }
}

TEST(FindHead, RejectsShapesThatAreNoFace) {
  const auto refused = [](const TriangleMesh& mesh) {
    try {
      find_head(face(), mesh, "thing.obj");
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("no face was found"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("--landmarks"), std::string::npos);
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refused(star_shape([](const Vec3&) { return 0.1; })));
  EXPECT_TRUE(refused(star_shape([](const Vec3& d) { return 0.1 / d.cwiseAbs().maxCoeff(); })));
  EXPECT_TRUE(refused(star_shape([](const Vec3& d) {
    return 0.1 + 0.012 * std::sin(5 * d[0] + 1) + 0.01 * std::sin(4 * d[1] - 3 * d[2]);
  })));
  // A ball with a beak: one bump is not a face.
  EXPECT_TRUE(refused(star_shape([](const Vec3& d) {
    return 0.1 + 0.03 * std::exp(-std::pow(std::acos(std::min(1.0, d[2])) / 0.2, 2));
  })));
  // The back of the head alone.
  TriangleMesh back = face().skin;
  std::erase_if(back.triangles,
                [&](const Triangle& t) { return back.vertices[static_cast<size_t>(t[0])][2] > 0.0; });
  EXPECT_TRUE(refused(back));
}

TEST(FindHead, RejectsDegenerateMeshes) {
  TriangleMesh flat;
  flat.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  flat.triangles = {{0, 1, 2}};
  EXPECT_THROW(find_head(face(), flat, "flat.obj"), Error);
  flat.triangles = {{0, 0, 0}, {1, 1, 2}};
  EXPECT_THROW(find_head(face(), flat, "point.obj"), Error);
}

}  // namespace
}  // namespace fascia::landmarks
