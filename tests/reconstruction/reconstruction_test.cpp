#include "builder/reconstruction/reconstruction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "builder/spatial/surface_query.h"
#include "geometry/error.h"

namespace fascia::reconstruction {
namespace {

const anatomy::GenericAnatomy& generic() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

TriangleMesh joined(const std::vector<anatomy::MeshObject>& objects) {
  TriangleMesh all;
  for (const anatomy::MeshObject& object : objects) {
    const int first = all.vertex_count();
    all.vertices.insert(all.vertices.end(), object.mesh.vertices.begin(), object.mesh.vertices.end());
    for (const Triangle& t : object.mesh.triangles)
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

/// A skull of another shape than the generic one: longer, narrower, with a stronger chin.
Vec3 another_person(const Vec3& p) {
  const double chin = std::clamp((-p.y() + 0.0) / 0.08, 0.0, 1.0);
  return {0.95 * p.x(), 1.05 * p.y(), 1.01 * p.z() + 0.004 * chin * chin};
}

double mean_skin_distance(const Result& result, const std::vector<Vec3>& truth) {
  TriangleMesh skin = generic().head_object("skin")->mesh;
  skin.vertices = result.place(result.mean, skin.vertices);
  const spatial::SurfaceQuery surface(skin);
  double sum = 0.0;
  for (const Vec3& p : truth)
    sum += surface.closest(p).distance / static_cast<double>(truth.size());
  return sum;
}

std::vector<Vec3> skin_landmarks_over_bone() {
  std::vector<Vec3> out;
  for (const anatomy::Landmark& landmark : generic().landmarks)
    if (landmark.skin && landmark.bone) out.push_back(*landmark.skin);
  return out;
}

TEST(Reconstruction, OwnSkullGivesOwnHead) {
  const Result result = reconstruct(generic(), joined(generic().skull));
  EXPECT_EQ(result.metres, 1.0);
  EXPECT_LT(result.bone_residual, 0.0003);
  EXPECT_GT(result.covered_share, 0.97);
  EXPECT_LT(mean_skin_distance(result, skin_landmarks_over_bone()), 0.0013)
      << "the table's depths differ a little from the generic head's own";
}

TEST(Reconstruction, FollowsAnotherSkull) {
  TriangleMesh skull = joined(generic().skull);
  std::vector<Vec3> truth = skin_landmarks_over_bone();
  for (Vec3& p : skull.vertices)
    p = another_person(p);
  for (Vec3& p : truth)
    p = another_person(p);
  const Result result = reconstruct(generic(), skull);
  EXPECT_LT(mean_skin_distance(result, truth), 0.0018);
}

TEST(Reconstruction, IsTheSameInAnyPoseAndUnit) {
  TriangleMesh skull = joined(generic().skull);
  for (Vec3& p : skull.vertices)
    p = another_person(p);
  const Result first = reconstruct(generic(), skull);
  const Mat3 turn = (Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()) *
                     Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()))
                        .toRotationMatrix();
  TriangleMesh moved = skull;
  for (Vec3& p : moved.vertices)
    p = 1000.0 * (turn * p) + Vec3(40, -300, 12);
  const Result second = reconstruct(generic(), moved);
  EXPECT_EQ(second.metres, 0.001);
  const std::vector<Vec3>& skin = generic().head_object("skin")->mesh.vertices;
  const std::vector<Vec3> a = first.place(first.mean, skin), b = second.place(second.mean, skin);
  double mean = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    mean += (1000.0 * (turn * a[i]) + Vec3(40, -300, 12) - b[i]).norm() / static_cast<double>(a.size());
  EXPECT_LT(mean, 1.0) << "millimetres";
}

TEST(Reconstruction, PutsTheTablesDepthOverEachLandmark) {
  const Result result = reconstruct(generic(), joined(generic().skull));
  const anatomy::TissueDepthTable& table = generic().depth_tables.front();
  int compared = 0;
  for (const SkinOverBone& landmark : result.landmarks) {
    const anatomy::Landmark* known = generic().landmark(landmark.name);
    const anatomy::TissueDepth* depth = table.find(known->depth);
    if (!depth) continue;
    ++compared;
    EXPECT_DOUBLE_EQ(landmark.depth, depth->mean) << landmark.name;
    EXPECT_NEAR((landmark.skin - landmark.bone).norm(), depth->mean, 1e-9) << landmark.name;
  }
  EXPECT_GE(compared, 30);
}

TEST(Reconstruction, BandIsOneDeviationWide) {
  const Result result = reconstruct(generic(), joined(generic().skull));
  for (const char* name : {"pogonion", "zygion_left", "glabella"}) {
    const Vec3 skin = *generic().landmark(name)->skin;
    const double width = (result.placement(result.thick(skin)) - result.placement(result.thin(skin))).norm();
    const auto& landmark = *std::find_if(result.landmarks.begin(), result.landmarks.end(),
                                         [&](const SkinOverBone& l) { return l.name == name; });
    EXPECT_NEAR(width, 2.0 * landmark.deviation, 0.7 * landmark.deviation) << name;
  }
}

TEST(Reconstruction, GivenLandmarksAreHeld) {
  Options options;
  for (const char* name :
       {"nasion", "pogonion", "zygion_left", "zygion_right", "gonion_left", "gonion_right"})
    options.bone[name] = *generic().landmark(name)->bone;
  options.bone["pogonion"] += Vec3(0.0, 0.0, 0.002);
  const Result result = reconstruct(generic(), joined(generic().skull), options);
  for (const SkinOverBone& landmark : result.landmarks)
    if (landmark.name == "pogonion") {
      EXPECT_TRUE(landmark.given);
      EXPECT_NEAR((landmark.bone - options.bone["pogonion"]).norm(), 0.0, 1e-9);
    }
}

TEST(Reconstruction, RejectsShapesThatAreNoSkull) {
  EXPECT_THROW(reconstruct(generic(), joined(generic().head)), Error);
  TriangleMesh cube;
  for (int i = 0; i < 8; ++i)
    cube.vertices.push_back(0.1 * Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1));
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_THROW(reconstruct(generic(), cube), Error);
  EXPECT_THROW(reconstruct(generic(), TriangleMesh{}), Error);
  Options options;
  options.table = "no_such_table";
  EXPECT_THROW(reconstruct(generic(), joined(generic().skull), options), Error);
}

TEST(Reconstruction, ChoosesTheTableOfTheNearestPeople) {
  std::vector<std::string> warnings;
  EXPECT_EQ(nearest_table(generic(), {}, warnings), "hona_stephan_2024");
  EXPECT_EQ(nearest_table(generic(), {"female", "adult", "native american"}, warnings), "rhine_1983");
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(nearest_table(generic(), {"male", "", ""}, warnings), "hona_stephan_2024");
  EXPECT_EQ(warnings.size(), 1u) << "no table tells men apart, and that is said";
}

}  // namespace
}  // namespace fascia::reconstruction
