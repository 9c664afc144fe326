// Semilandmarks, normals, moved landmarks and partial heads, on heads in closed form.
#include "builder/skull/fitter.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "builder/skull/curve_points.h"
#include "geometry/error.h"
#include "tests/skull/round_head.h"

namespace fascia::skull {
namespace {

using testing::carried;
using testing::globe;
using testing::lean;
using testing::mapped;
using testing::mean_distance;
using testing::round_head;
using testing::round_head_with_curves;
using testing::same;
using testing::skin_radii;

// A round cheek between the landmarks.
Vec3 cheek(const Vec3& p) {
  Vec3 bump = Vec3::Zero();
  for (double side : {-1.0, 1.0})
    bump += 0.012 * std::exp(-(p - Vec3(side * 0.045, -0.005, 0.07)).squaredNorm() / (2 * 0.015 * 0.015)) *
            Vec3(side * 0.5, 0, 0.87);
  return p + bump;
}

TEST(Curves, SemilandmarksAreSpacedAlongTheBone) {
  const Generic generic = round_head_with_curves();
  const std::vector<CurvePoint> points = curve_points(generic, 0.012);
  ASSERT_GT(points.size(), 20u);
  for (const CurvePoint& point : points) {
    EXPECT_NEAR(point.bone.cwiseQuotient(skin_radii).norm(), testing::bone_share, 0.03);
    EXPECT_GT(point.outward.dot(point.bone.normalized()), 0.9);
    EXPECT_GT(point.depth, 0.004);
    EXPECT_LT(point.depth, 0.012);
  }
  EXPECT_TRUE(curve_points(generic, 0).empty());
  EXPECT_GT(curve_points(generic, 0.006).size(), points.size() * 3 / 2);
}

TEST(Curves, ImproveTheFitBetweenLandmarks) {
  const Generic generic = round_head_with_curves();
  const TriangleMesh skin = mapped(globe(skin_radii, 48, 96), cheek);
  const TriangleMesh truth = mapped(generic.cranium, cheek);
  FitOptions options;
  options.clearance_share = 0;
  const FitResult with = fit(generic, skin, carried(generic, cheek), options);
  options.curve_spacing = 0;
  const FitResult without = fit(generic, skin, carried(generic, cheek), options);
  EXPECT_EQ(with.curve_points_used, with.curve_points);
  EXPECT_EQ(without.curve_points, 0);
  double error_with = 0, error_without = 0;
  for (int v = 0; v < generic.cranium.vertex_count(); ++v) {
    const double swollen = (truth.vertices[v] - generic.cranium.vertices[v]).norm();
    if (swollen < 0.004) continue;
    error_with += (with.cranium.vertices[v] - truth.vertices[v]).norm();
    error_without += (without.cranium.vertices[v] - truth.vertices[v]).norm();
  }
  EXPECT_LT(error_with, 0.6 * error_without);
}

TEST(Curves, SymmetricStaysSymmetric) {
  const Generic generic = round_head_with_curves();
  const FitResult result = fit(generic, mapped(globe(skin_radii), lean), carried(generic, lean));
  EXPECT_GT(result.curve_points_used, 10);
  constexpr int columns = 48;
  for (int i = 1; i < 24; ++i)
    for (int j = 0; j < columns; ++j) {
      const Vec3& p = result.cranium.vertices[1 + (i - 1) * columns + j];
      const Vec3& q = result.cranium.vertices[1 + (i - 1) * columns + (columns - j) % columns];
      EXPECT_LT((p - Vec3(-q.x(), q.y(), q.z())).norm(), 1e-6);
    }
}

TEST(Normals, TurnTheBoneWithTheSkin) {
  // Landmarks stay where they are; only the skin between them turns, about the front landmark.
  const Generic generic = round_head_with_curves();
  const Vec3 front(0, 0, skin_radii.z());
  const auto tilt = [&](const Vec3& p) {
    const double near = std::exp(-(p - front).squaredNorm() / (2 * 0.015 * 0.015));
    return Vec3(p.x(), p.y(), p.z() + 0.35 * near * (p.y() - front.y()));
  };
  const TriangleMesh skin = mapped(globe(skin_radii, 96, 192), tilt);
  auto landmarks = carried(generic, same);
  FitOptions options;
  options.exponent = 3;
  options.smoothing = 0.1;
  options.curve_spacing = 0;
  options.skin_normal_share = 0;
  const auto slope = [&](const FitResult& result) {
    return result.bone_map.warp().jacobian(generic.landmarks[0].bone)(2, 1);
  };
  const double plain = slope(fit(generic, skin, landmarks, options));
  options.normal_deviation = 0.05;
  const double turned = slope(fit(generic, skin, landmarks, options));
  EXPECT_LT(std::abs(plain), 0.05);
  EXPECT_NEAR(turned, 0.3, 0.08);
  options.exponent = 1;
  EXPECT_THROW(fit(generic, skin, landmarks, options), Error)
      << "a thin plate in space has no gradient at data";
}

TEST(Landmarks, MoreLandmarksReduceTheError) {
  const Generic generic = round_head();
  const TriangleMesh skin = mapped(globe(skin_radii), lean);
  const TriangleMesh truth = mapped(generic.cranium, lean);
  const auto all = carried(generic, lean);
  double last = 1;
  for (const size_t count : {6u, 10u, 14u, 18u}) {
    std::map<std::string, TargetLandmark> some;
    for (const GenericLandmark& landmark : generic.landmarks)
      if (some.size() < count) some[landmark.name] = all.at(landmark.name);
    some["point10_left"] = all.at("point10_left");
    const double error = mean_distance(fit(generic, skin, some).cranium.vertices, truth.vertices);
    EXPECT_LT(error, last * 1.02) << count;
    last = error;
  }
  EXPECT_LT(last, 0.003);
}

TEST(Landmarks, AnUncertainOneSlidesAlongTheSkin) {
  const Generic generic = round_head();
  const TriangleMesh skin = globe(skin_radii);
  auto landmarks = carried(generic, same);
  const FitResult right = fit(generic, skin, landmarks);
  const Vec3 misplaced = skin_radii.cwiseProduct(Vec3(1, 0.12, 0.1).normalized());
  landmarks["point6_left"] = {misplaced, 1};
  const double sure = mean_distance(fit(generic, skin, landmarks).cranium.vertices, right.cranium.vertices);
  landmarks["point6_left"].confidence = 0.2;
  const double unsure = mean_distance(fit(generic, skin, landmarks).cranium.vertices, right.cranium.vertices);
  EXPECT_LT(unsure, 0.4 * sure);
  EXPECT_GT(sure, 0.0002);
}

TEST(Fitter, AMovedLandmarkIsFollowedAsByANewFit) {
  const Generic generic = round_head_with_curves();
  const Exterior skin = exterior(mapped(globe(skin_radii), lean));
  auto landmarks = carried(generic, lean);
  Fitter fitter(generic, skin, landmarks);
  const FitResult before = fitter.result();
  const auto bone = [](const FitResult& result) {
    for (const FittedLandmark& landmark : result.landmarks)
      if (landmark.name == "point7_left") return landmark.bone;
    return Vec3(Vec3::Zero());
  };
  const FitResult still = fitter.move_landmark("point7_left", landmarks["point7_left"].skin);
  EXPECT_LT(mean_distance(still.cranium.vertices, before.cranium.vertices), 2e-4) << "not moved";
  const Vec3 target =
      skin.surface.closest(landmarks["point7_left"].skin + Vec3(-0.004, 0.003, 0.002)).position;
  const FitResult moved = fitter.move_landmark("point7_left", target);
  landmarks["point7_left"].skin = target;
  const FitResult fresh = fit(generic, skin, landmarks);
  const double change = (bone(fresh) - bone(before)).norm();
  EXPECT_GT(change, 0.002);
  EXPECT_LT((bone(moved) - bone(fresh)).norm(), 0.25 * change);
  EXPECT_LT(mean_distance(moved.cranium.vertices, fresh.cranium.vertices), 5e-4);
  EXPECT_EQ(moved.bone_outside_skin, 0);
  EXPECT_LT((moved.warp(generic.landmarks[0].skin) - fresh.warp(generic.landmarks[0].skin)).norm(), 1e-3);
  // Moving on, again and back, leaves nothing behind.
  const FitResult back = fitter.move_landmark("point7_left", carried(generic, lean)["point7_left"].skin);
  EXPECT_LT(mean_distance(back.cranium.vertices, before.cranium.vertices), 5e-4);
  EXPECT_LT((bone(back) - bone(before)).norm(), 0.25 * change);
  EXPECT_THROW(fitter.move_landmark("third_eye", target), Error);
  EXPECT_THROW(fitter.move_landmark("point7_left", Vec3(0, std::nan(""), 0)), Error);
}

TEST(Fitter, DepthsScaleTogetherAndOneByOne) {
  const Generic generic = round_head();
  const Exterior skin = exterior(globe(skin_radii));
  Fitter fitter(generic, skin, carried(generic, same));
  const auto depth = [](const FitResult& result, const std::string& name) {
    for (const FittedLandmark& landmark : result.landmarks)
      if (landmark.name == name) return landmark.depth;
    return 0.0;
  };
  const double front = depth(fitter.result(), "point0"), back = depth(fitter.result(), "point4");
  const FitResult one = fitter.set_depth_scale("point0", 1.5);
  EXPECT_GT(depth(one, "point0"), 1.2 * front);
  EXPECT_NEAR(depth(one, "point4"), back, 0.1 * back);
  fitter.set_depth_scale("point0", 1);
  const FitResult all = fitter.set_tissue_scale(1.5);
  EXPECT_NEAR(depth(all, "point0"), 1.5 * front, 0.15 * front);
  EXPECT_NEAR(depth(all, "point4"), 1.5 * back, 0.15 * back);
  EXPECT_THROW(fitter.set_tissue_scale(0), Error);
  EXPECT_THROW(fitter.set_depth_scale("third_eye", 1), Error);
}

TEST(PartialHead, GetsThePartOfASkullItCan) {
  const Generic generic = round_head_with_curves();
  // Cut off above a plane, as a scan ends: no forehead, no landmarks there.
  const double top = 0.045;
  TriangleMesh whole = globe(skin_radii, 48, 96), scan{whole.vertices, {}};
  for (const Triangle& t : whole.triangles)
    if (whole.vertices[t[0]].y() < top && whole.vertices[t[1]].y() < top && whole.vertices[t[2]].y() < top)
      scan.triangles.push_back(t);
  auto landmarks = carried(generic, same);
  std::erase_if(landmarks, [&](const auto& entry) { return entry.second.skin.y() > top - 0.003; });
  const FitResult part = fit(generic, scan, landmarks);
  EXPECT_GT(part.uncovered_share, 0.1);
  EXPECT_LT(part.uncovered_share, 0.5);
  ASSERT_EQ(part.warnings.size(), 1u);
  EXPECT_EQ(part.bone_outside_skin, 0);
  ASSERT_LT(part.cranium.triangle_count(), generic.cranium.triangle_count());
  double highest = -1, worst = 0;
  for (const Vec3& v : part.cranium.vertices) {
    highest = std::max(highest, v.y());
    worst = std::max(worst, std::abs(v.cwiseQuotient(testing::bone_share * skin_radii).norm() - 1));
  }
  EXPECT_LT(highest, top + 0.02);
  EXPECT_GT(highest, top - 0.02);
  EXPECT_LT(worst, 0.05) << "what is there is right";
  FitOptions options;
  options.trim_uncovered = false;
  EXPECT_EQ(fit(generic, scan, landmarks, options).cranium.triangle_count(),
            generic.cranium.triangle_count());
  EXPECT_EQ(fit(generic, whole, carried(generic, same)).uncovered_share, 0);
}

}  // namespace
}  // namespace fascia::skull
