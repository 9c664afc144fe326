// The SMAS of whole heads whose landmarks were found, not given.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "builder/rigging/embedded_head.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/rigging/stages.h"
#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"
#include "tests/paths/paths.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

/// A head with its bones: what the SMAS is built from.
struct Head {
  rigging::FoundLandmarks found;
  skull::FitResult skull;
  smas::Inputs inputs;

  explicit Head(const fs::path& file) {
    static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
    found = rigging::find_landmarks(formats::read(file), {}, anatomy);
    skull = rigging::fit_skull(anatomy, found, 1.0);
    inputs = smas::inputs_from(anatomy);
    inputs.skin = &found.head.skin;
    inputs.cranium = &skull.cranium;
    inputs.mandible = &skull.mandible;
    for (const auto& [name, landmark] : found.landmarks)
      inputs.landmarks[name] = landmark.position;
  }
};

fs::path embedded_head() {
  const fs::path folder = fs::path(::testing::TempDir()) / "fascia_smas_heads";
  fs::create_directories(folder);
  rigging::write_embedded_head(folder / "head.obj", folder / "landmarks.json");
  return folder / "head.obj";
}

int euler(const TriangleMesh& mesh) {
  int edges = 0;
  for (const auto& neighbours : connectivity(mesh).neighbours)
    for (int n : neighbours)
      edges += n < 0 ? 2 : 1;
  return mesh.vertex_count() - edges / 2 + mesh.triangle_count();
}

void expect_sound(const Head& head, const smas::Result& smas) {
  EXPECT_GE(smas.quality.min_angle, 25.0);
  EXPECT_GE(smas.quality.mean_min_angle, 50.0);
  EXPECT_EQ(smas.folds, 0);
  EXPECT_EQ(smas.outside_layers, 0);
  EXPECT_LT(smas.fit_error, 0.001) << smas.fit_error;
  // A disc with four holes: two eyes, mouth, nose.
  EXPECT_EQ(smas.boundary.size(), 5u);
  EXPECT_EQ(euler(smas.mesh), 1 - 4);
  EXPECT_EQ(connectivity(smas.mesh).irregular_edges, 0);

  // Strictly between bone and skin at every vertex: the bones asked anew, the skin over it by the point that
  // it is bound to.
  const spatial::SurfaceQuery cranium(*head.inputs.cranium), mandible(*head.inputs.mandible);
  const std::vector<Vec3> normals = vertex_normals(*head.inputs.skin);
  for (size_t v = 0; v < smas.mesh.vertices.size(); ++v) {
    const Vec3& p = smas.mesh.vertices[v];
    ASSERT_TRUE(p.allFinite());
    EXPECT_GT(cranium.signed_distance(p), 0.0) << v;
    EXPECT_GT(mandible.signed_distance(p), 0.0) << v;
    const SurfacePoint& at = smas.skin_points[v];
    const Vec3 over = position(*head.inputs.skin, at) - p;
    Vec3 outward = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      outward += at.barycentric[k] * normals[head.inputs.skin->triangles[at.triangle][k]];
    EXPECT_GT(over.dot(outward), 0.0) << v;
    EXPECT_NEAR(over.norm(), smas.skin_distance[v], 1e-9) << v;
  }
  // Fold-free: no triangle lies back over its neighbour.
  const Connectivity links = connectivity(smas.mesh);
  for (int t = 0; t < smas.mesh.triangle_count(); ++t)
    for (int n : links.neighbours[t])
      if (n > t) {
        EXPECT_GT(triangle_normal(smas.mesh, t).dot(triangle_normal(smas.mesh, n)), -0.9) << t;
      }
  // Open at the lids, the lips and under the nose.
  for (const char* name : {"pupilla_left", "pupilla_right", "stomion", "columella"}) {
    const auto at = head.inputs.landmarks.find(name);
    ASSERT_NE(at, head.inputs.landmarks.end()) << name;
    double nearest = 1.0;
    for (const Vec3& p : smas.mesh.vertices)
      nearest = std::min(nearest, (p - at->second).norm());
    EXPECT_GT(nearest, 0.0015) << name;
  }
}

class MeasuredHead : public ::testing::TestWithParam<const char*> {};

TEST_P(MeasuredHead, HasASoundSmas) {
  const fs::path file = test::measured_data() / "data" / GetParam();
  if (!fs::exists(file)) GTEST_SKIP() << "the measured heads are not at " << file;
  const Head head(file);
  expect_sound(head, smas::build(head.inputs));
}

INSTANTIATE_TEST_SUITE_P(All, MeasuredHead,
                         ::testing::Values("ict/neutral.glb", "ict/person_0.glb", "ict/person_1.glb",
                                           "ict/person_2.glb", "ict/person_3.glb", "ict/person_4.glb",
                                           "ict/person_5.glb", "heads/makehuman_body.obj"));

TEST(EmbeddedHeadSmas, IsSoundInEitherFormAndAsFarAsAsked) {
  const Head head(embedded_head());
  const smas::Result usual = smas::build(head.inputs);
  expect_sound(head, usual);

  smas::Options hermite;
  hermite.form = smas::ImplicitForm::hermite;
  const smas::Result told_gradients = smas::build(head.inputs, hermite);
  expect_sound(head, told_gradients);
  const spatial::SurfaceQuery surface(usual.mesh);
  double apart = 0.0;
  for (const Vec3& p : told_gradients.mesh.vertices)
    apart += surface.closest(p).distance / told_gradients.mesh.vertex_count();
  EXPECT_LT(apart, 0.0005);

  smas::Options face_alone, scalp_and_neck;
  face_alone.reach.galea = 0.0, face_alone.reach.neck = 0.0;
  scalp_and_neck.reach.galea = 0.8, scalp_and_neck.reach.neck = 0.045;
  const smas::Result small = smas::build(head.inputs, face_alone),
                     large = smas::build(head.inputs, scalp_and_neck);
  expect_sound(head, small);
  expect_sound(head, large);
  const Bounds least = bounds(small.mesh.vertices), most = bounds(large.mesh.vertices);
  EXPECT_GT(most.upper[1], least.upper[1] + 0.015);
  EXPECT_LT(most.lower[1], least.lower[1] - 0.015);
}

}  // namespace
}  // namespace fascia::testing
