// Against a real person's bone, and on many people's skin, when the measured data are there.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "builder/skull/fitter.h"
#include "builder/skull/from_anatomy.h"
#include "builder/spatial/surface_query.h"
#include "geometry/alignment.h"
#include "tests/paths/paths.h"
#include "tests/skull/ct_head.h"
#include "tests/skull/ict_heads.h"

namespace fascia::skull {
namespace {

const std::filesystem::path measured = test::measured_data(), fixtures = test::data();
using Targets = std::map<std::string, TargetLandmark>;

Targets placed(const Landmarks& points, const anatomy::GenericAnatomy* required_in = nullptr) {
  Targets out;
  for (const auto& [name, p] : points)
    if (!required_in || (required_in->landmark(name) && required_in->landmark(name)->required))
      out[name] = {p, 1};
  return out;
}

/// Farthest that `to` is from the best similarity of `from`, m.
double bent(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Mat4 body = similarity(from, to);
  double worst = 0;
  for (size_t i = 0; i < from.size(); ++i)
    worst = std::max(worst, (transform_point(body, from[i]) - to[i]).norm());
  return worst;
}

/// Farthest that a mesh is from its own mirror image, m.
double one_sided(const TriangleMesh& mesh) {
  const spatial::SurfaceQuery surface(mesh);
  double worst = 0;
  for (const Vec3& v : mesh.vertices)
    worst = std::max(worst, surface.closest(Vec3(-v.x(), v.y(), v.z())).distance);
  return worst;
}

TEST(CtHead, BoneLiesWhereTheScanShowsIt) {
  if (!testing::has_ct_head(measured)) GTEST_SKIP() << "the CT head is not at " << measured / "data/ct";
  const auto anatomy = anatomy::load_generic();
  const Generic generic = from_anatomy(anatomy);
  const testing::CtHead head = testing::read_ct_head(measured, fixtures / "ct_head_landmarks.json", anatomy);
  const std::vector<testing::DepthSample> samples = testing::depth_samples(head);
  ASSERT_GT(samples.size(), 1000u);
  const Exterior skin = exterior(head.skin);

  const FitResult whole = fit(generic, skin, head.targets);
  const auto errors = testing::depth_errors(samples, whole);
  EXPECT_EQ(errors.size(), 9u) << "eight regions and all";
  EXPECT_LE(errors.at("all").mean, 0.0035);
  EXPECT_LE(errors.at("all").missed, errors.at("all").samples / 4);
  for (const auto& [region, error] : errors)
    EXPECT_LE(error.mean, 0.0055) << region;
  EXPECT_EQ(whole.bone_outside_skin, 0);
  EXPECT_GT(whole.uncovered_share, 0.05) << "the scan has no forehead";

  // The required landmarks alone will do; more help.
  const Targets required = placed(head.given, &anatomy), all = placed(head.given);
  EXPECT_LT(required.size(), all.size());
  const double few = testing::depth_errors(samples, fit(generic, skin, required)).at("all").mean;
  const double many = testing::depth_errors(samples, fit(generic, skin, all)).at("all").mean;
  EXPECT_LE(few, 0.0035);
  EXPECT_LE(many, few + 0.0001);
  // And what curves say between the landmarks.
  FitOptions bare;
  bare.curve_spacing = 0;
  EXPECT_LT(many, testing::depth_errors(samples, fit(generic, skin, all, bare)).at("all").mean);
}

TEST(IctHeads, PeopleGetWholeSkullsUnderTheirSkin) {
  const auto anatomy = anatomy::load_generic();
  const Generic generic = from_anatomy(anatomy);
  for (const char* name : {"neutral", "person_0", "person_3"}) {
    if (!testing::has_ict_head(measured, name))
      GTEST_SKIP() << "the ICT heads are not at " << measured / "data/ict";
    const testing::IctHead head =
        testing::read_ict_head(measured, name, fixtures / "ict_neutral_landmarks.json", anatomy);
    const FitResult result = fit(generic, head.head.skin, head.targets);
    EXPECT_EQ(result.bone_outside_skin, 0) << name;
    EXPECT_EQ(result.bone_within_clearance, 0) << name;
    EXPECT_EQ(result.uncovered_share, 0) << name;
    EXPECT_EQ(result.cranium.triangle_count(), generic.cranium.triangle_count()) << name;
    EXPECT_LT(result.landmark_rms, 0.003) << name;
    EXPECT_TRUE(result.warnings.empty()) << name << ": " << result.warnings.front();
    // Jaws as on the generic: each row of teeth keeps its shape, each condyle its place in its socket.
    EXPECT_LT(bent(generic.teeth_upper.vertices, result.teeth_upper.vertices), 1e-5) << name;
    EXPECT_LT(bent(generic.teeth_lower.vertices, result.teeth_lower.vertices), 1e-5) << name;
    for (const Vec3& condyle : {generic.condyle_left, generic.condyle_right}) {
      std::vector<Vec3> from, to;
      for (const auto& [before, after] :
           {std::pair(&generic.cranium, &result.cranium), std::pair(&generic.mandible, &result.mandible)})
        for (size_t v = 0; v < before->vertices.size(); ++v)
          if ((before->vertices[v] - condyle).norm() < 0.011) {
            from.push_back(before->vertices[v]);
            to.push_back(after->vertices[v]);
          }
      ASSERT_GT(from.size(), 10u);
      EXPECT_LT(bent(from, to), 1.5e-3) << name;
    }
  }
}

TEST(GenericHead, GetsItsOwnSkullSymmetric) {
  const auto anatomy = anatomy::load_generic();
  const Generic generic = from_anatomy(anatomy);
  EXPECT_GE(generic.curves.size(), 10u) << "rims, piriform, border, arches and temporal lines of both sides";
  Targets targets;
  for (const GenericLandmark& landmark : generic.landmarks)
    targets[landmark.name] = {landmark.skin, 1};
  const FitResult result = fit(generic, generic.skin, targets);
  EXPECT_EQ(result.bone_outside_skin, 0);
  EXPECT_LT(result.landmark_rms, 0.002);
  EXPECT_EQ(result.uncovered_share, 0);
  EXPECT_LT(one_sided(result.mandible), one_sided(generic.mandible) + 5e-5);
}

}  // namespace
}  // namespace fascia::skull
