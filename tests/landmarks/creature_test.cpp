// Heads that resemble people's in nothing but two eyes, their symmetry and a nose or muzzle; and things that
// have two balls or holes but no face.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "builder/landmarks/find_head.h"
#include "builder/rigging/find_landmarks.h"
#include "geometry/error.h"

namespace fascia::testing {
namespace {

const anatomy::GenericAnatomy& creature_anatomy() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

/// A closed surface about `centre`, `extent(d)` away from it in each direction d, in `rings` rings.
TriangleMesh blob(const Vec3& centre, const std::function<double(const Vec3&)>& extent, int rings = 32) {
  TriangleMesh mesh;
  const int sectors = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      const double theta = EIGEN_PI * r / rings, phi = 2 * EIGEN_PI * s / sectors;
      const Vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
      mesh.vertices.push_back(centre + extent(d) * d);
    }
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      const int next = (s + 1) % sectors;
      if (r > 0) mesh.triangles.push_back({r * sectors + s, (r + 1) * sectors + s, r * sectors + next});
      if (r + 1 < rings)
        mesh.triangles.push_back({r * sectors + next, (r + 1) * sectors + s, (r + 1) * sectors + next});
    }
  return mesh;
}

TriangleMesh ball_at(const Vec3& centre, double radius) {
  return blob(
      centre, [=](const Vec3&) { return radius; }, 10);
}

/// A bump in direction `at`, `wide` radians wide.
double bump(const Vec3& d, const Vec3& at, double wide) {
  return std::exp(-std::pow(std::acos(std::clamp(d.dot(at.normalized()), -1.0, 1.0)) / wide, 2));
}

struct Creature {
  double muzzle = 0.07, width = 0.1, height = 0.09, eyes = 0.022, apart = 0.045, ears = 0.05;
  bool has_eyeballs = true;  ///< else holes
};

const Vec3 left_eye_of(const Creature& creature) {
  return {creature.apart, 0.03, 0.072};
}

/// An ellipsoid with eyes, a muzzle below them and ears; metres, +Y up, facing +Z.
std::vector<TriangleMesh> creature_head(const Creature& creature) {
  const Vec3 left = left_eye_of(creature), right(-left.x(), left.y(), left.z());
  TriangleMesh skin = blob(Vec3::Zero(), [&](const Vec3& d) {
    const double round = 1.0 / Vec3(d.x() / creature.width, d.y() / creature.height, d.z() / 0.09).norm();
    return round + creature.muzzle * bump(d, Vec3(0, -0.55, 0.85), 0.33) +
           creature.ears * (bump(d, Vec3(0.8, 0.6, 0), 0.2) + bump(d, Vec3(-0.8, 0.6, 0), 0.2));
  });
  if (creature.has_eyeballs) return {skin, ball_at(left, creature.eyes), ball_at(right, creature.eyes)};
  std::erase_if(skin.triangles, [&](const Triangle& t) {
    const Vec3& p = skin.vertices[static_cast<size_t>(t[0])];
    return std::min((p - left).norm(), (p - right).norm()) < creature.eyes + 0.006;
  });
  return {skin};
}

formats::Scene scene_of(const std::vector<TriangleMesh>& meshes, const Mat3& turn = Mat3::Identity(),
                        double scale = 1.0) {
  formats::Scene scene;
  scene.kind = formats::FileKind::obj;
  scene.path = "thing.obj";
  for (const TriangleMesh& part : meshes) {
    formats::SceneMesh mesh;
    mesh.name = "part_" + std::to_string(scene.meshes.size());
    mesh.positions = part.vertices;
    for (Vec3& p : mesh.positions)
      p = scale * (turn * p);
    mesh.triangles = part.triangles;
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

Mat3 turned_by(double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()).toRotationMatrix();
}

/// Expects the creature's eyes and axes where they are, with a warning.
void expect_eyes(const Creature& creature, const Mat3& turn, double scale) {
  const rigging::FoundLandmarks found =
      rigging::find_landmarks(scene_of(creature_head(creature), turn, scale), {}, creature_anatomy());
  EXPECT_TRUE(found.is_doubtful);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings.front().find("two eyes"), std::string::npos) << found.warnings.front();
  const Mat4 to_file = found.head.input_to_metres.inverse();
  const auto place = [&](const std::string& name) {
    return Vec3(turn.transpose() * transform_point(to_file, found.landmarks.at(name).position) / scale);
  };
  const Vec3 left = left_eye_of(creature);
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "_left" : "_right";
    const Vec3 middle = 0.5 * (place("exocanthion" + name) + place("endocanthion" + name));
    EXPECT_NEAR(middle.x(), side * left.x(), 0.4 * creature.eyes) << name;
    EXPECT_NEAR(middle.y(), left.y(), 0.85 * creature.eyes) << name;
  }
  EXPECT_GT(place("exocanthion_left").x(), place("endocanthion_left").x());
  EXPECT_LT(place("menton").y(), 0.0);
  EXPECT_NEAR(place("pronasale").x(), 0.0, 0.004);
  EXPECT_GT(place("pronasale").z(), 0.09);
  EXPECT_LT(place("pronasale").y(), left.y());
}

TEST(CreatureHead, IsFoundByItsEyesSymmetryAndMuzzle) {
  for (const Creature& creature : {Creature{}, Creature{.muzzle = 0.04, .width = 0.12, .eyes = 0.03},
                                   Creature{.muzzle = 0.09, .height = 0.11, .ears = 0.0},
                                   Creature{.eyes = 0.018, .apart = 0.035, .has_eyeballs = false}}) {
    SCOPED_TRACE("muzzle " + std::to_string(creature.muzzle) + ", eyes " + std::to_string(creature.eyes));
    expect_eyes(creature, Mat3::Identity(), 1.0);
  }
}

TEST(CreatureHead, IsFoundInAnyPoseAndUnit) {
  expect_eyes({}, turned_by(130, Vec3(1, 2, 3)), 7.0);
}

bool is_refused(const std::vector<TriangleMesh>& meshes) {
  try {
    const rigging::FoundLandmarks found = rigging::find_landmarks(scene_of(meshes), {}, creature_anatomy());
    ADD_FAILURE() << "likeness " << found.likeness;
  } catch (const Error& error) {
    return std::string(error.what()).find("no face was found") != std::string::npos;
  }
  return false;
}

TEST(CreatureHead, TwoBallsMakeNoFace) {
  // Eyes on a ball, without a nose.
  EXPECT_TRUE(is_refused(creature_head({.muzzle = 0.0, .width = 0.09, .ears = 0.0})));
  // The knobs of a wireless.
  const TriangleMesh box = blob(Vec3::Zero(), [](const Vec3& d) { return 0.1 / d.cwiseAbs().maxCoeff(); });
  EXPECT_TRUE(
      is_refused({box, ball_at(Vec3(0.04, 0.02, 0.1), 0.015), ball_at(Vec3(-0.04, 0.02, 0.1), 0.015)}));
  // A dumb-bell.
  const TriangleMesh bar = blob(
      Vec3::Zero(), [](const Vec3& d) { return 1.0 / Vec3(d.x() / 0.1, d.y() / 0.01, d.z() / 0.01).norm(); });
  EXPECT_TRUE(is_refused({bar, ball_at(Vec3(0.1, 0, 0), 0.03), ball_at(Vec3(-0.1, 0, 0), 0.03)}));
}

}  // namespace
}  // namespace fascia::testing
