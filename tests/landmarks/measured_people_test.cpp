// Landmarks and regions on people and a body whose landmarks are known. The whole table is bench/landmarks.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "builder/rigging/find_landmarks.h"
#include "builder/spatial/surface_query.h"
#include "tests/landmarks/measured_heads.h"
#include "tests/paths/paths.h"

namespace fascia::testing {
namespace {

const anatomy::GenericAnatomy& generic_anatomy() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

class MeasuredPeople : public ::testing::Test {
 protected:
  void SetUp() override {
    if (measured_data().empty()) GTEST_SKIP() << "needs the measured data in " << test::measured_data();
  }

  static void expect_found(const MeasuredHead& head, bool has_ict_definitions = true) {
    const rigging::FoundLandmarks found = rigging::find_landmarks(head.scene, {}, generic_anatomy());
    const Mat4 to_file = found.head.input_to_metres.inverse();
    double sum = 0.0, most = 0.0;
    std::string worst;
    for (const auto& [name, truth] : head.truth) {
      Vec3 position = found.landmarks.at(name).position;
      if (has_ict_definitions)
        position += offset_of_definition(name, *generic_anatomy().landmark(name)->skin);
      const double error = head.millimetres * (transform_point(to_file, position) - truth).norm();
      sum += error;
      if (error > most) worst = name;
      most = std::max(most, error);
    }
    EXPECT_LE(sum / static_cast<double>(head.truth.size()), 2.5) << head.name;
    EXPECT_LE(most, 8.0) << head.name << ", " << worst;
    EXPECT_GE(head.truth.size(), 11u);
  }
};

TEST_F(MeasuredPeople, AsTheyCome) {
  for (const char* name : {"neutral", "person_0", "person_4"})
    expect_found(ict_head(name));
}

TEST_F(MeasuredPeople, TurnedAndInOtherUnits) {
  const Mat3 turned =
      (Eigen::AngleAxisd(0.6, Vec3::UnitY()) * Eigen::AngleAxisd(0.45, Vec3::UnitX())).toRotationMatrix();
  expect_found(in_units(moved(ict_head("person_1"), turned, Vec3(1, 2, 3)), 1000));
}

TEST_F(MeasuredPeople, DecimatedTo3000Triangles) {
  expect_found(decimated(ict_head("person_5"), 3000));
}

TEST_F(MeasuredPeople, SubdividedTo400000Triangles) {
  const MeasuredHead head = subdivided(ict_head("person_0"), 2);
  size_t triangles = 0;
  for (const auto& mesh : head.scene.meshes)
    triangles += mesh.triangles.size();
  ASSERT_GT(triangles, 400000u);
  expect_found(head);
}

TEST_F(MeasuredPeople, WithAMillimetreOfNoise) {
  expect_found(noisy(ict_head("person_0"), 1.0, 3));
}

TEST_F(MeasuredPeople, WithoutEyesAndMouthLiningAndWithHoles) {
  expect_found(without_lining(ict_head("person_2")));
  expect_found(with_holes(without_lining(ict_head("person_1")), 9.0, 10, 5));
}

TEST_F(MeasuredPeople, AFaceAloneInAnyPose) {
  const Mat3 turned =
      (Eigen::AngleAxisd(2.2, Vec3::UnitY()) * Eigen::AngleAxisd(-0.7, Vec3::UnitX())).toRotationMatrix();
  expect_found(in_units(moved(face_alone(ict_head("person_2"), 95.0), turned, Vec3(1, 0, 2)), 1000));
  expect_found(face_alone(ict_head("person_4"), 85.0));
  // Here a small face fits a patch of the cheek fairly well.
  const Mat3 away = Eigen::AngleAxisd(2.8, Vec3(0.2, 1, 0.1).normalized()).toRotationMatrix();
  expect_found(in_units(moved(face_alone(ict_head("person_1"), 95.0), away), 1000));
}

TEST_F(MeasuredPeople, CutAboveTheBrows) {
  const Mat3 turned =
      (Eigen::AngleAxisd(-1.0, Vec3::UnitY()) * Eigen::AngleAxisd(1.4, Vec3::UnitX())).toRotationMatrix();
  expect_found(in_units(moved(cut_above_brows(ict_head("person_0")), turned), 100));
}

TEST_F(MeasuredPeople, WhatAFaceAloneLacksHasLittleConfidence) {
  const rigging::FoundLandmarks found =
      rigging::find_landmarks(face_alone(ict_head("person_2"), 85.0).scene, {}, generic_anatomy());
  EXPECT_LT(found.landmarks.at("tragion_left").confidence, 0.5);
  EXPECT_GT(found.landmarks.at("exocanthion_left").confidence, 0.5);
  // Beside the mesh where the ear would be, not drawn to the mesh's edge.
  EXPECT_GT(found.landmarks.at("tragion_left").position[0],
            found.landmarks.at("exocanthion_left").position[0] + 0.015);
}

TEST_F(MeasuredPeople, TheHeadOfAWholeBody) {
  expect_found(makehuman(), false);
}

/// Whether regions `a` and `b` are the two lips, or the two lids of one eye, or skin of the face and lining.
bool may_never_meet(const std::string& a, const std::string& b) {
  static const std::set<std::pair<std::string, std::string>> opposite = {
      {"lip_lower", "lip_upper"},
      {"lid_lower_left", "lid_upper_left"},
      {"lid_lower_right", "lid_upper_right"},
      {"cheek", "mouth_lining"},
      {"mouth_lining", "perioral"},
      {"chin", "mouth_lining"}};
  return opposite.count({std::min(a, b), std::max(a, b)}) > 0;
}

TEST_F(MeasuredPeople, LipsLidsAndLiningKeepTheirPlacesVertexByVertex) {
  // Where upper and lower meet round a corner is a matter of definition for a few millimetres.
  const auto is_at_corner = [](const MeasuredHead& head, const Vec3& p) {
    for (const char* corner : {"exocanthion_left", "exocanthion_right", "endocanthion_left",
                               "endocanthion_right", "cheilion_left", "cheilion_right"})
      if (head.millimetres * (head.truth.at(corner) - p).norm() < 6.0) return true;
    return false;
  };
  const auto regions_of = [](const MeasuredHead& head) {
    const rigging::FoundLandmarks found =
        rigging::find_landmarks(head.scene, {}, generic_anatomy(), {}, true);
    // By vertex of the `head` mesh, which is the same one in every person.
    std::vector<std::string> names;
    for (size_t m = 0; m < head.scene.meshes.size(); ++m) {
      if (head.scene.meshes[m].name != "head") continue;
      for (int v : found.head.meshes[m].skin_vertices) {
        const int region = v < 0 ? -1 : found.regions->of_vertex[static_cast<size_t>(v)];
        names.push_back(region < 0 ? "" : found.regions->names[static_cast<size_t>(region)]);
      }
    }
    return names;
  };
  const std::vector<std::string> mean = regions_of(ict_head("neutral"));
  size_t lip_vertices = 0;
  for (const std::string& name : mean)
    lip_vertices += name == "lip_upper" || name == "lip_lower";
  ASSERT_GT(lip_vertices, 300u);
  for (const char* person : {"person_0", "person_1", "person_2", "person_3", "person_4", "person_5"}) {
    const MeasuredHead head = ict_head(person);
    const std::vector<std::string> here = regions_of(head);
    const auto skin = std::find_if(head.scene.meshes.begin(), head.scene.meshes.end(),
                                   [](const auto& mesh) { return mesh.name == "head"; });
    ASSERT_EQ(here.size(), mean.size());
    std::map<std::string, int> mixed;
    for (size_t v = 0; v < here.size(); ++v)
      if (may_never_meet(mean[v], here[v]) && !is_at_corner(head, skin->positions[v]))
        ++mixed[mean[v] + " taken for " + here[v]];
    // Of some 9,400 vertices a face; on the margins themselves one or two sit between the regions on the mean
    // head already.
    for (const auto& [what, count] : mixed)
      EXPECT_LE(count, 3) << person << ": " << count << " vertices, " << what;
  }
}

/// A coarse head with sockets in place of eyes, whose lids are a row of vertices: behind their edge the skin
/// goes back and up, and faces as a lid does again at the socket's end.
TEST_F(MeasuredPeople, LidsBeforeAnEmptySocketAreThoseOneSees) {
  const std::filesystem::path file = test::measured_data() / "data/wild/african_head.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs " << file;
  const rigging::FoundLandmarks found = rigging::find_landmarks(formats::read(file), {}, generic_anatomy());
  const spatial::SurfaceQuery skin(found.head.skin);
  for (const char* name : {"palpebrale_superius_left", "palpebrale_superius_right",
                           "palpebrale_inferius_left", "palpebrale_inferius_right"}) {
    const Vec3 p = found.landmarks.at(name).position;
    const auto hit = skin.first_hit(p + Vec3(0, 0, 0.1), -Vec3::UnitZ(), 0.2);
    ASSERT_TRUE(hit.has_value()) << name;
    EXPECT_LT(hit->position.z() - p.z(), 0.003) << name << " is hidden from the front";
  }
}

TEST_F(MeasuredPeople, EyesTeethAndTongueOfTheBodyByShapeAndPlace) {
  MeasuredHead body = makehuman();
  for (size_t m = 0; m < body.scene.meshes.size(); ++m)
    body.scene.meshes[m].name = "object_" + std::to_string(m);
  const rigging::FoundLandmarks found = rigging::find_landmarks(body.scene, {}, generic_anatomy());
  std::set<prepare::Part> parts;
  for (const prepare::PreparedMesh& mesh : found.head.meshes)
    parts.insert(mesh.parts.begin(), mesh.parts.end());
  using prepare::Part;
  for (Part part :
       {Part::skin, Part::eye_left, Part::eye_right, Part::teeth_upper, Part::teeth_lower, Part::tongue})
    EXPECT_TRUE(parts.count(part)) << prepare::part_name(part);
}

}  // namespace
}  // namespace fascia::testing
