#include "builder/skull/skull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "builder/skull/teeth.h"
#include "geometry/alignment.h"
#include "geometry/error.h"
#include "tests/skull/round_head.h"

namespace fascia::skull {
namespace {

using testing::bone_share;
using testing::carried;
using testing::globe;
using testing::lean;
using testing::Map;
using testing::mapped;
using testing::round_head;
using testing::skin_radii;

FitOptions exact() {
  FitOptions options;
  options.smoothing = 0;
  options.skin_normal_share = 0;
  options.clearance_share = 0;
  options.clearance_floor = 0;
  options.normal_passes = 200;
  options.normal_tolerance = 1e-14;
  return options;
}

TEST(SkullFit, AffineHeadIsRecovered) {
  const Generic generic = round_head();
  Mat3 A;
  A << 1.1, 0.05, 0, -0.02, 0.95, 0.1, 0.03, 0, 1.2;
  const Map map = [&](const Vec3& p) { return Vec3(A * p + Vec3(0.3, 1.5, -0.2)); };
  FitOptions options = exact();
  for (const GenericLandmark& landmark : generic.landmarks)
    options.depth_scale[landmark.name] = (A * (landmark.skin - landmark.bone)).norm() / landmark.depth;
  const FitResult result = fit(generic, mapped(globe(skin_radii), map), carried(generic, map), options);
  for (int v = 0; v < generic.cranium.vertex_count(); ++v)
    EXPECT_LT((result.cranium.vertices[v] - map(generic.cranium.vertices[v])).norm(), 1e-9);
  EXPECT_LT(result.landmark_max, 1e-9);
  EXPECT_EQ(result.bone_outside_skin, 0);
  EXPECT_LT((result.warp(generic.landmarks[3].skin) - map(generic.landmarks[3].skin)).norm(), 1e-9);
}

TEST(SkullFit, LandmarksAreMetWithoutSmoothingAndLessWith) {
  const Generic generic = round_head();
  const TriangleMesh skin = mapped(globe(skin_radii), lean);
  FitOptions options = exact();
  EXPECT_LT(fit(generic, skin, carried(generic, lean), options).landmark_max, 1e-9);
  double last = 0;
  for (double smoothing : {100.0, 1000.0, 10000.0}) {
    options.smoothing = smoothing;
    const double rms = fit(generic, skin, carried(generic, lean), options).landmark_rms;
    EXPECT_GT(rms, last);
    last = rms;
  }
}

TEST(SkullFit, SymmetricHeadGetsASymmetricSkull) {
  Generic generic = round_head();
  generic.condyle_left = Vec3(0.05, 0, 0.01);
  generic.condyle_right = Vec3(-0.05, 0, 0.01);
  const FitResult result = fit(generic, mapped(globe(skin_radii), lean), carried(generic, lean));
  const auto mirrored = [](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); };
  constexpr int columns = 48;
  for (int i = 1; i < 24; ++i)
    for (int j = 0; j < columns; ++j) {
      const Vec3& p = result.cranium.vertices[1 + (i - 1) * columns + j];
      const Vec3& q = result.cranium.vertices[1 + (i - 1) * columns + (columns - j) % columns];
      EXPECT_LT((p - mirrored(q)).norm(), 1e-6);
    }
  EXPECT_LT((result.jaw.condyle_left - mirrored(result.jaw.condyle_right)).norm(), 1e-6);
  EXPECT_LT((result.jaw.hinge - Vec3::UnitX()).norm(), 1e-6);
}

TEST(SkullFit, LengthsOfTheJawsMotionScaleWithTheHead) {
  Generic generic = round_head();
  generic.condyle_left = Vec3(0.05, 0, 0.01);
  generic.condyle_right = Vec3(-0.05, 0, 0.01);
  generic.jaw = {0.4, 0.008, 0.006, 0.007, 0.003, 0.15, 0.002};
  const Map small = [](const Vec3& p) { return Vec3(0.75 * p); };
  FitOptions options;
  options.tissue_scale = 0.75;
  const FitResult result = fit(generic, mapped(globe(skin_radii), small), carried(generic, small), options);
  const anatomy::mechanics::JawMotion& motion = result.jaw.motion;
  EXPECT_EQ(motion.open_angle, 0.4);
  EXPECT_EQ(motion.lateral_angle, 0.15);
  EXPECT_NEAR(motion.open_forward, 0.0060, 1e-4);
  EXPECT_NEAR(motion.open_down, 0.0045, 1e-4);
  EXPECT_NEAR(motion.protrusion_forward, 0.00525, 1e-4);
  EXPECT_NEAR(motion.protrusion_down, 0.00225, 1e-4);
  EXPECT_NEAR(motion.lateral_glide, 0.0015, 1e-4);
}

TEST(SkullFit, BoneStaysUnderTheSkinBetweenLandmarks) {
  // Dents between the landmarks, deeper than the tissue is thick.
  const Generic generic = round_head();
  const Map dented = [](const Vec3& p) {
    const double dent = 0.02 * std::exp(-(p - Vec3(0.03, 0.075, 0.06)).squaredNorm() / (2 * 0.015 * 0.015));
    return Vec3(p * (1 - dent / p.norm()));
  };
  const TriangleMesh skin = mapped(globe(skin_radii, 48, 96), dented);
  const FitResult result = fit(generic, skin, carried(generic, dented));
  EXPECT_EQ(result.bone_outside_skin, 0);
  EXPECT_EQ(result.bone_within_clearance, 0);
  const spatial::SurfaceQuery query(skin);
  double nearest = -1;
  for (const Vec3& v : result.cranium.vertices)
    nearest = std::max(nearest, query.signed_distance(v));
  EXPECT_LE(nearest, -0.002);
  // Only the surroundings of the dent gave way.
  const FitResult plain =
      fit(generic, globe(skin_radii, 48, 96), carried(generic, [](const Vec3& p) { return p; }));
  for (int v = 0; v < generic.cranium.vertex_count(); ++v) {
    if (generic.cranium.vertices[v].z() > -0.03) continue;
    EXPECT_LT((result.cranium.vertices[v] - plain.cranium.vertices[v]).norm(), 0.002);
  }
}

TEST(SkullFit, TissueScaleSinksTheBone) {
  const Generic generic = round_head();
  const TriangleMesh skin = globe(skin_radii);
  const Map same = [](const Vec3& p) { return p; };
  double last = 1;
  for (double scale : {0.5, 1.0, 2.0}) {
    FitOptions options;
    options.tissue_scale = scale;
    const FitResult result = fit(generic, skin, carried(generic, same), options);
    for (const FittedLandmark& landmark : result.landmarks)
      EXPECT_NEAR(landmark.table_depth, scale * (1 - bone_share) * landmark.skin.norm(), 1e-12);
    const double reach = result.cranium.vertices[0].y();
    EXPECT_LT(reach, last);
    last = reach;
  }
}

TEST(SkullFit, TeethThatTheHeadHasAreMet) {
  Generic generic = round_head();
  generic.mandible =
      mapped(globe(Vec3(0.02, 0.01, 0.02)), [](const Vec3& p) { return Vec3(p + Vec3(0, -0.05, 0.03)); });
  const auto arch = [](double y) {
    return mapped(globe(Vec3(0.025, 0.004, 0.02), 10, 24),
                  [y](const Vec3& p) { return Vec3(p + Vec3(0, y, 0.045)); });
  };
  generic.teeth_upper = arch(-0.026);
  generic.teeth_lower = arch(-0.036);
  const Map same = [](const Vec3& p) { return p; };
  const Map moved = [](const Vec3& p) { return Vec3(p + Vec3(0, 0.003, -0.004)); };
  const TriangleMesh upper = mapped(generic.teeth_upper, moved), lower = mapped(generic.teeth_lower, moved);
  FitOptions options;
  const FitResult without = fit(generic, globe(skin_radii), carried(generic, same), options);
  options.teeth_upper = &upper;
  options.teeth_lower = &lower;
  const FitResult with = fit(generic, globe(skin_radii), carried(generic, same), options);
  double worst_with = 0, best_without = 1;
  for (int v = 0; v < upper.vertex_count(); ++v) {
    worst_with = std::max(worst_with, (with.teeth_upper.vertices[v] - upper.vertices[v]).norm());
    best_without = std::min(best_without, (without.teeth_upper.vertices[v] - upper.vertices[v]).norm());
  }
  EXPECT_LT(worst_with, 2e-4);
  EXPECT_GT(best_without, 3e-3);
  // Without evidence both rows move as one body: their shape and their contact are the generic's.
  const Mat4 body = similarity(generic.teeth_upper.vertices, without.teeth_upper.vertices);
  for (int v = 0; v < generic.teeth_lower.vertex_count(); ++v)
    EXPECT_LT(
        (transform_point(body, generic.teeth_lower.vertices[v]) - without.teeth_lower.vertices[v]).norm(),
        1e-9);
}

TEST(SkullFit, ReportsInvalidInput) {
  const Generic generic = round_head();
  const TriangleMesh skin = globe(skin_radii);
  const Map same = [](const Vec3& p) { return p; };
  auto landmarks = carried(generic, same);
  landmarks["third_eye"] = {Vec3(0, 0.05, 0.09), 1};
  EXPECT_EQ(fit(generic, skin, landmarks).warnings.size(), 1u);
  FitOptions options;
  options.tissue_scale = 0;
  EXPECT_THROW(fit(generic, skin, landmarks, options), Error);
  std::map<std::string, TargetLandmark> few(landmarks.begin(), std::next(landmarks.begin(), 3));
  EXPECT_THROW(fit(generic, skin, few), Error);
  std::map<std::string, TargetLandmark> midline;
  for (const auto& [name, landmark] : landmarks)
    if (landmark.skin.x() == 0) midline[name] = landmark;
  EXPECT_THROW(fit(generic, skin, midline), Error) << "all on the midplane";
  landmarks["point0"].confidence = 0;
  EXPECT_THROW(fit(generic, skin, landmarks), Error);
  landmarks["point0"] = {Vec3(std::nan(""), 0, 0), 1};
  EXPECT_THROW(fit(generic, skin, landmarks), Error);
}

TEST(Exterior, LiningsAreLeftOutAndPointsBehindTheRimAreInside) {
  // A ball with a pocket: the sphere's front cap pushed deep inside.
  TriangleMesh ball = globe(Vec3::Constant(0.1), 48, 96);
  for (Vec3& v : ball.vertices) {
    const double off_axis = std::hypot(v.x(), v.y());
    if (v.z() > 0 && off_axis < 0.012) v.z() -= 0.08 * (1 - std::pow(off_axis / 0.012, 8));
  }
  const Exterior outer = exterior(ball);
  EXPECT_LT(outer.surface.mesh().triangle_count(), ball.triangle_count());
  EXPECT_GT(outer.surface.mesh().triangle_count(), ball.triangle_count() * 9 / 10);
  for (int t : outer.triangle_of)
    EXPECT_GT(position(ball, {t, Vec3::Constant(1.0 / 3)}).norm(), 0.07);
  EXPECT_LT(outer.closest(Vec3(0, 0, 0.05)).signed_distance, 0)
      << "in the pocket: between the rims' two sides";
  EXPECT_GT(outer.closest(Vec3(0.05, 0, 0.12)).signed_distance, 0);
}

TEST(Exterior, ABagOfTrianglesIsJudgedAsTheWeldedMesh) {
  const TriangleMesh ball = globe(Vec3::Constant(0.1));
  TriangleMesh bag;
  for (const Triangle& t : ball.triangles) {
    const int base = bag.vertex_count();
    // Written apart, and rounded apart by a micrometre.
    for (int k = 0; k < 3; ++k)
      bag.vertices.push_back(ball.vertices[t[k]] + 1e-6 * Vec3((base + k) % 2, (base / 3) % 2, k % 2));
    bag.triangles.push_back({base, base + 1, base + 2});
  }
  const Exterior whole = exterior(ball), apart = exterior(bag);
  EXPECT_EQ(whole.triangle_of, apart.triangle_of);
  for (size_t t = 0; t < apart.open_sides.size(); ++t)
    for (bool open : apart.open_sides[t])
      EXPECT_FALSE(open) << "a closed ball has no rim";
  for (const Vec3& p : {Vec3(0.02, 0.03, 0.04), Vec3(0.08, 0.08, 0), Vec3(0, -0.099, 0)})
    EXPECT_NEAR(whole.closest(p).signed_distance, apart.closest(p).signed_distance, 5e-6);
}

}  // namespace
}  // namespace fascia::skull
