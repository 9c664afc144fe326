#include "builder/smas/smas.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "builder/smas/trim.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "tests/paths/paths.h"

namespace fascia::smas {
namespace {

const Vec3 kCentre(0.0, 0.03, 0.0);

// A sphere of `radius` about kCentre from a subdivided octahedron.
TriangleMesh sphere(double radius, int levels) {
  TriangleMesh mesh;
  mesh.vertices = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                   -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    TriangleMesh fine;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int i = fine.vertex_count();
      const Vec3 p = mesh.vertices[a], q = mesh.vertices[b], r = mesh.vertices[c];
      for (const Vec3& v : {p, q, r, Vec3(p + q), Vec3(q + r), Vec3(r + p)})
        fine.vertices.push_back(v.normalized());
      for (const Triangle& t : {Triangle{0, 3, 5}, Triangle{3, 1, 4}, Triangle{5, 4, 2}, Triangle{3, 4, 5}})
        fine.triangles.push_back({i + t[0], i + t[1], i + t[2]});
    }
    mesh = weld(fine, 1e-9, nullptr);
  }
  for (Vec3& v : mesh.vertices)
    v = kCentre + radius * v;
  return mesh;
}

const anatomy::GenericAnatomy& generic() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

Landmarks ict_landmarks() {
  std::ifstream file(test::data() / "ict_neutral_landmarks.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  Landmarks landmarks;
  for (const auto& [name, p] : json["landmarks"].items())
    landmarks[name] = Vec3(p[0], p[1], p[2]);
  return landmarks;
}

// The landmarks of the face carried onto the sphere of radius .1.
Landmarks round_face() {
  Landmarks landmarks = ict_landmarks();
  for (auto& [name, p] : landmarks)
    p = kCentre + 0.1 * (p - kCentre).normalized();
  return landmarks;
}

int euler(const TriangleMesh& mesh) {
  int edges = 0;
  for (const auto& neighbours : connectivity(mesh).neighbours)
    for (int n : neighbours)
      edges += n < 0 ? 2 : 1;
  return mesh.vertex_count() - edges / 2 + mesh.triangle_count();
}

class RoundHead : public testing::Test {
 protected:
  TriangleMesh skin = sphere(0.1, 6), bone = sphere(0.09, 5);
  Inputs inputs = inputs_from(generic());
  RoundHead() { inputs.skin = &skin, inputs.cranium = &bone, inputs.landmarks = round_face(); }
};

TEST_F(RoundHead, LiesAtTheDepthAskedFor) {
  inputs.depths = {{"glabella", 0.4, 0.1}};
  const Result result = build(inputs);
  ASSERT_GT(result.mesh.triangle_count(), 1000);
  for (const Vec3& p : result.mesh.vertices)
    EXPECT_NEAR((p - kCentre).norm(), 0.096, 0.0002);
  for (size_t v = 0; v < result.mesh.vertices.size(); ++v) {
    // Beside the openings the skin of the face ends a little before the SMAS.
    EXPECT_NEAR(result.skin_distance[v], 0.004, 0.002);
    EXPECT_NEAR(result.bone_distance[v], 0.006, 0.0003);
    EXPECT_NEAR((position(skin, result.skin_points[v]) - result.mesh.vertices[v]).norm(),
                result.skin_distance[v], 1e-9);
    EXPECT_GT(result.normals[v].dot((result.mesh.vertices[v] - kCentre).normalized()), 0.98);
  }
}

TEST_F(RoundHead, IsOpenAtLidsMouthAndNostrilsAndElseADisc) {
  const Result result = build(inputs);
  EXPECT_EQ(result.boundary.size(), 5u);
  EXPECT_EQ(euler(result.mesh), 1 - 4);
  EXPECT_EQ(connectivity(result.mesh).irregular_edges, 0);
  EXPECT_EQ(result.outside_layers, 0);
  EXPECT_EQ(result.folds, 0);
  EXPECT_GE(result.quality.min_angle, 25.0);
  EXPECT_GE(result.quality.mean_min_angle, 50.0);
  // No vertex within the fissures, nor behind the ears.
  for (const char* name : {"pupilla_left", "pupilla_right", "stomion"})
    for (const Vec3& p : result.mesh.vertices)
      EXPECT_GT((p - inputs.landmarks[name]).norm(), 0.0035) << name;
  for (const Vec3& p : result.mesh.vertices)
    EXPECT_GT(p[2], 0.0);
}

TEST_F(RoundHead, ReachIsAnOption) {
  Options narrow, wide;
  narrow.reach.galea = 0.0, narrow.reach.neck = 0.0;
  wide.reach.galea = 0.8, wide.reach.neck = 0.03;
  const Result small = build(inputs, narrow), large = build(inputs, wide);
  const auto top = [](const Result& r) { return bounds(r.mesh.vertices).upper[1]; };
  EXPECT_GT(top(large), top(small) + 0.005);
  EXPECT_GT(large.mesh.triangle_count(), small.mesh.triangle_count());
}

TEST_F(RoundHead, StaysBetweenLayersOneMillimetreApart) {
  // Bone so near that the free depth would lie within it.
  const TriangleMesh close = sphere(0.099, 5);
  Inputs tight = inputs;
  tight.cranium = &close;
  tight.depths = {{"glabella", 0.75, 0.1}};
  const Result result = build(tight);
  EXPECT_EQ(result.outside_layers, 0);
  for (size_t v = 0; v < result.mesh.vertices.size(); ++v) {
    EXPECT_GT(result.skin_distance[v], 0.0);
    EXPECT_GT(result.bone_distance[v], 0.0);
  }
}

TEST_F(RoundHead, ScalesWithTheFace) {
  TriangleMesh half = skin, half_bone = bone;
  Inputs child = inputs;
  child.skin = &half, child.cranium = &half_bone;
  for (TriangleMesh* mesh : {&half, &half_bone})
    for (Vec3& v : mesh->vertices)
      v *= 0.5;
  for (auto& [name, p] : child.landmarks)
    p *= 0.5;
  const Result adult = build(inputs), small = build(child);
  EXPECT_EQ(small.boundary.size(), 5u);
  EXPECT_NEAR(small.mesh.triangle_count(), adult.mesh.triangle_count(), 0.05 * adult.mesh.triangle_count());
}

TEST_F(RoundHead, SameInputSameBytes) {
  const Result first = build(inputs), second = build(inputs);
  ASSERT_EQ(first.mesh.triangles, second.mesh.triangles);
  EXPECT_EQ(std::memcmp(first.mesh.vertices.data(), second.mesh.vertices.data(),
                        first.mesh.vertices.size() * sizeof(Vec3)),
            0);
}

TEST_F(RoundHead, ReportsMissingInput) {
  Inputs none = inputs;
  none.skin = nullptr;
  EXPECT_THROW(build(none), Error);
  Inputs mouthless = inputs;
  mouthless.landmarks.erase("stomion");
  try {
    build(mouthless);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("stomion"), std::string::npos);
  }
  Inputs elsewhere = inputs;
  for (auto& [name, p] : elsewhere.landmarks)
    p += Vec3(5, 0, 0);
  EXPECT_THROW(build(elsewhere), Error);
  Inputs broken = inputs;
  broken.landmarks["gnathion"] = Vec3::Constant(std::nan(""));
  EXPECT_THROW(build(broken), Error);
}

TEST(LayerDepth, KeepsWithinBoneAndSkin) {
  const LayerDepth layers(generic().tissue.smas_depths, generic().mechanics.smas_shape, ict_landmarks(), 1.0);
  const Landmarks landmarks = ict_landmarks();
  const double none = std::numeric_limits<double>::infinity();
  for (const auto& [name, p] : landmarks)
    for (double to_bone : {0.0005, 0.003, 0.01, 0.04}) {
      const double depth = layers.depth(p, to_bone);
      EXPECT_GE(depth, 0.2 * to_bone) << name;
      EXPECT_LE(depth, 0.8 * to_bone) << name;
    }
  // Lids thinner than nose and lips, these thinner than the cheek.
  const auto free_depth = [&](const char* name) { return layers.depth(landmarks.at(name), none); };
  EXPECT_LT(free_depth("palpebrale_superius_left"), 0.0018);
  EXPECT_LT(free_depth("alare_left"), free_depth("labiale_superius"));
  EXPECT_LT(free_depth("labiale_superius"), free_depth("buccale_left"));
}

TEST(ReachField, DistinguishesTheLiningOfAnEyeSocketFromLidsAndNose) {
  const Landmarks landmarks = ict_landmarks();
  const ReachField field(landmarks, generic().mechanics.smas_shape, true, 0.0096);
  for (const char* side : {"_left", "_right"}) {
    const auto at = [&](const char* name) { return landmarks.at(std::string(name) + side); };
    const Vec3 globe = 0.5 * (at("exocanthion") + at("endocanthion")) - Vec3(0, 0, 0.010);
    // The wall of a socket 20 mm around the globe's centre, and the back of lids 14 mm before it.
    for (const Vec3& direction :
         {Vec3(0, 0, -1), Vec3(0.6, 0.3, -0.7), Vec3(-0.5, 0.5, -0.7), Vec3(0, -0.7, -0.7)})
      EXPECT_TRUE(field.is_socket(globe + 0.020 * direction.normalized(), -direction.normalized())) << side;
    for (const Vec3& direction : {Vec3(0, 0.6, 0.8), Vec3(0, -0.6, 0.8)}) {
      EXPECT_TRUE(field.is_socket(globe + 0.014 * direction, -direction)) << side;
      EXPECT_FALSE(field.is_socket(globe + 0.015 * direction, direction)) << side;
    }
    // The side of the nose looks outward and forward, past the eye; brow and cheek look forward.
    const double outward = std::string(side) == "_left" ? 1.0 : -1.0;
    EXPECT_FALSE(field.is_socket(at("endocanthion") + Vec3(-outward * 0.006, 0, 0.004),
                                 Vec3(outward * 0.7, 0, 0.7).normalized()))
        << side;
    for (const char* name :
         {"superciliare", "malare", "exocanthion", "palpebrale_superius", "palpebrale_inferius"})
      EXPECT_FALSE(field.is_socket(at(name), Vec3(0, 0, 1))) << name << side;
  }
}

TEST(Trim, CutsAlongTheZeroLine) {
  // Two triangles of the unit square, cut at x = .6 of them.
  TriangleMesh mesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, {{0, 1, 2}, {0, 2, 3}}};
  std::vector<Vec3> normals(4, Vec3::UnitZ());
  std::vector<double> sizes(4, 1.0), field = {0.6, -0.4, -0.4, 0.6};
  trim(0.35, &mesh, &normals, &sizes, &field);
  double area = 0.0;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    area += triangle_area(mesh, t);
  EXPECT_NEAR(area, 0.6, 1e-12);
  for (const Vec3& p : mesh.vertices)
    EXPECT_LE(p[0], 0.6 + 1e-12);
  EXPECT_EQ(normals.size(), mesh.vertices.size());
  EXPECT_EQ(field.size(), mesh.vertices.size());
}

}  // namespace
}  // namespace fascia::smas
