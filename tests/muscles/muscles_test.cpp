#include "builder/muscles/order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "geometry/error.h"
#include "tests/muscles/ball_head.h"

namespace fascia::muscles {
namespace {

using anatomy::Attachment;
using anatomy::MuscleKind;
using geodesics::kPi;

bool segments_cross(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto area = [](const Vec3& p, const Vec3& q, const Vec3& r) {
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  };
  return area(a, b, c) * area(a, b, d) < 0 && area(c, d, a) * area(c, d, b) < 0;
}

int front_crossings(const Muscle& muscle) {
  int count = 0;
  for (size_t i = 0; i < muscle.fibres.size(); ++i)
    for (size_t j = i + 1; j < muscle.fibres.size(); ++j)
      for (size_t k = 0; k + 1 < muscle.fibres[i].points.size(); ++k)
        for (size_t l = 0; l + 1 < muscle.fibres[j].points.size(); ++l)
          count +=
              segments_cross(muscle.fibres[i].points[k].position, muscle.fibres[i].points[k + 1].position,
                             muscle.fibres[j].points[l].position, muscle.fibres[j].points[l + 1].position);
  return count;
}

TEST(BuildMuscles, LaysAStrapFromBoneToTheModiolus) {
  BallHead head;
  head.muscles = {strap("zygomaticus_major_left", 1.0)};
  const Result result = build(head.inputs());
  ASSERT_EQ(result.muscles.size(), 1u);
  const Muscle& muscle = result.muscles[0];
  EXPECT_GE(muscle.fibres.size(), 3u);
  EXPECT_LE(muscle.fibres.size(), 9u);
  EXPECT_EQ(front_crossings(muscle), 0);
  EXPECT_EQ(muscle.crossings, 0);
  EXPECT_NEAR(muscle.strength, 6.0, 1e-12);
  EXPECT_EQ(muscle.origin_on, Attachment::cranium);
  EXPECT_EQ(muscle.fibres.front().bundle, 0);
  EXPECT_EQ(muscle.fibres.back().bundle, 1);
  for (const Fibre& fibre : muscle.fibres) {
    EXPECT_NEAR(fibre.points.front().position.norm(), kBone, 2e-4);
    // Depth .4 between skin and bone at the insertion, .6 half way.
    EXPECT_NEAR(fibre.points.back().position.norm(), kSkin - 0.4 * (kSkin - kBone), 3e-4);
    EXPECT_NEAR(fibre.points[fibre.points.size() / 2].position.norm(), kSkin - 0.6 * (kSkin - kBone), 8e-4);
    for (const FibrePoint& point : fibre.points) {
      if (!point.bound) continue;
      const spatial::SurfaceQuery smas(head.smas);
      EXPECT_LT(
          (position(head.smas, point.smas) + point.offset * smas.smooth_normal(point.smas) - point.position)
              .norm(),
          1e-12);
    }
  }
  // Great circle between the regions' middles at the mean radius.
  const Vec3 a = front(kBone, 0.045, 0.03).normalized(), b = front(kSmas, 0.022, -0.02).normalized();
  EXPECT_NEAR(muscle.mean_length, std::acos(a.dot(b)) * 0.5 * (kBone + 0.0952), 0.05 * muscle.mean_length);
}

TEST(BuildMuscles, AreMirroredOnTheOtherSide) {
  BallHead head;
  head.muscles = {strap("left", 1.0), strap("right", -1.0)};
  const Result result = build(head.inputs());
  EXPECT_NEAR(result.muscles[0].mean_length, result.muscles[1].mean_length,
              0.02 * result.muscles[0].mean_length);
  EXPECT_EQ(result.muscles[0].fibres.size(), result.muscles[1].fibres.size());
}

TEST(BuildMuscles, PassesItsWaypoints) {
  BallHead head;
  head.muscles = {strap("m", 1.0)};
  const Vec3 waypoint = front(kSmas, 0.05, 0.0);
  head.muscles[0].waypoints = {waypoint};
  const Result result = build(head.inputs());
  const Muscle& muscle = result.muscles[0];
  EXPECT_EQ(front_crossings(muscle), 0);
  EXPECT_EQ(muscle.crossings, 0);
  double nearest = 1.0;
  for (const Fibre& fibre : muscle.fibres)
    for (const FibrePoint& point : fibre.points)
      nearest = std::min(nearest, (point.position - waypoint).norm());
  EXPECT_LT(nearest, 0.005);
}

TEST(BuildMuscles, RingsKeepTheirDistanceFromTheMouth) {
  BallHead head;
  head.muscles = {ring("upper", MuscleKind::sphincter_ring, 0.004, 0.012, 0.0, kPi),
                  ring("lower", MuscleKind::sphincter_ring, 0.004, 0.012, -kPi, 0.0)};
  const Result result = build(head.inputs());
  for (const Muscle& muscle : result.muscles) {
    EXPECT_EQ(front_crossings(muscle), 0);
    EXPECT_EQ(muscle.crossings, 0);
    const size_t count = muscle.fibres.size();
    for (size_t i = 0; i < count; ++i) {
      const double distance = 0.004 + 0.008 * (i + 0.5) / count;
      for (const FibrePoint& point : muscle.fibres[i].points) {
        // To the lip line, over the sphere: within a fifth of the distance.
        double nearest = 1.0;
        for (int k = 0; k <= 100; ++k)
          nearest = std::min(nearest, std::acos(std::min(1.0, front(kSkin, -0.025 + 0.05 * k / 100, -0.03)
                                                                  .normalized()
                                                                  .dot(point.position.normalized()))) *
                                          0.0975);
        EXPECT_NEAR(nearest, distance, 0.2 * distance + 2e-4);
        EXPECT_NEAR(point.position.norm(), kSkin - 0.4 * (kSkin - kBone), 1e-3);
      }
    }
  }
  // From the subject's left corner over the upper lip to the right corner; the lower the other way round.
  EXPECT_GT(result.muscles[0].fibres[0].points.front().position[0], 0.02);
  EXPECT_LT(result.muscles[0].fibres[0].points.back().position[0], -0.02);
  EXPECT_LT(result.muscles[1].fibres[0].points.front().position[0], -0.02);
  const Muscle& upper = result.muscles[0];
  EXPECT_GT(upper.fibres[0].points[upper.fibres[0].points.size() / 2].position[1], -0.03);
}

TEST(BuildMuscles, CompressorsRunInwardsAcrossTheRings) {
  BallHead head;
  head.muscles = {ring("compressor", MuscleKind::compressor, 0.001, 0.009, 0.0, kPi)};
  const Result result = build(head.inputs());
  for (const Fibre& fibre : result.muscles[0].fibres) {
    EXPECT_GT(fibre.points.front().position.norm(), fibre.points.back().position.norm() + 0.005);
    EXPECT_LT(fibre.rest_length, 0.02);
  }
}

TEST(BuildMuscles, DeepMusclesRunFromBoneToBone) {
  BallHead head;
  anatomy::Muscle deep = strap("masseter_left", 1.0);
  deep.group = "masticatory";
  deep.insertion = {Attachment::cranium, patch(kBone, 0.05, -0.03, 0.006, 0.004)};
  deep.waypoints = {front(0.0905, 0.055, 0.0)};
  head.muscles = {deep};
  const Muscle muscle = build(head.inputs()).muscles[0];
  EXPECT_EQ(front_crossings(muscle), 0);
  EXPECT_EQ(muscle.crossings, 0);
  for (const Fibre& fibre : muscle.fibres) {
    EXPECT_NEAR(fibre.points.front().position.norm(), kBone, 2e-4);
    EXPECT_NEAR(fibre.points.back().position.norm(), kBone, 2e-4);
    for (const FibrePoint& point : fibre.points)
      EXPECT_GT(point.position.norm(), kBone - 2e-4);
  }
}

TEST(BuildMuscles, TakesOptionsAndEdits) {
  BallHead head;
  head.muscles = {strap("a", 1.0), strap("b", -1.0)};
  head.muscles[1].prevalence = 0.06;
  Options options;
  options.least_prevalence = 0.5;
  options.spacing = 0.004;
  options.edits["a"].strength = 2.0;
  options.edits["a"].insertion = Sketch{patch(kSmas, 0.0, -0.05, 0.004, 0.004), true};
  const Result coarse = build(head.inputs(), options);
  ASSERT_EQ(coarse.muscles.size(), 1u);
  EXPECT_NEAR(coarse.muscles[0].strength, 12.0, 1e-12);
  EXPECT_LT(coarse.muscles[0].fibres[0].points.back().position[1], -0.04);
  options.spacing = 0.001;
  EXPECT_GT(build(head.inputs(), options).muscles[0].fibres.size(), coarse.muscles[0].fibres.size());
  options.absent = {"a"};
  EXPECT_TRUE(build(head.inputs(), options).muscles.empty());
}

Fibre straight(const spatial::SurfaceQuery& smas, double x, double to, bool bound = true) {
  Fibre fibre;
  for (int k = 0; k <= 8; ++k) {
    const Vec3 p = front(kSmas, x + (to - x) * k / 8.0, -0.02 + 0.04 * k / 8.0);
    fibre.points.push_back({p, smas.closest(p).surface, 0.0, bound});
  }
  return fibre;
}

TEST(Crossings, AreCountedAndPutInOrder) {
  const spatial::SurfaceQuery smas(shell(kSmas));
  const auto replace = [&](const Vec3& p, double) {
    const spatial::ClosestPoint closest = smas.closest(p);
    return FibrePoint{closest.position, closest.surface, 0.0, true};
  };
  std::vector<Fibre> fibres = {straight(smas, 0.0, 0.0), straight(smas, 0.004, 0.004),
                               straight(smas, 0.008, 0.008)};
  EXPECT_EQ(crossings(fibres, smas), 0);
  std::swap(fibres[0].points, fibres[2].points);  // in another order, but side by side
  EXPECT_EQ(crossings(fibres, smas), 0);
  fibres = {straight(smas, 0.0, 0.008), straight(smas, 0.004, 0.0), straight(smas, 0.008, 0.004)};
  EXPECT_EQ(crossings(fibres, smas), 2);
  EXPECT_EQ(put_in_order(fibres, smas, replace), 0);
  EXPECT_EQ(crossings(fibres, smas), 0);
  // The same ends as before, and evenly spaced fibres between them.
  std::vector<double> begins, ends;
  for (const Fibre& fibre : fibres) {
    ASSERT_EQ(fibre.points.size(), 9u);
    begins.push_back(fibre.points.front().position[0]);
    ends.push_back(fibre.points.back().position[0]);
  }
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(begins[i], 0.004 * i, 1e-9);
    EXPECT_NEAR(ends[i], 0.004 * i, 1e-9);
  }
  // Without any point on the SMAS they are seen along their own sheet's normal.
  fibres = {straight(smas, 0.0, 0.008, false), straight(smas, 0.004, 0.002, false)};
  EXPECT_EQ(crossings(fibres, smas), 1);
}

TEST(Modiolus, GathersWhatInsertsThereAndTheRingsOfTheMouth) {
  BallHead head;
  head.muscles = {strap("above", 1.0), strap("below", 1.0),
                  ring("upper", MuscleKind::sphincter_ring, 0.004, 0.02, 0.0, kPi / 2)};
  for (auto& muscle : head.muscles)
    muscle.side = anatomy::Side::left;
  head.muscles[0].insertion.polygon = patch(kSmas, 0.032, -0.022, 0.004, 0.004);
  head.muscles[1].insertion.polygon = patch(kSmas, 0.034, -0.040, 0.004, 0.004);
  head.muscles[1].origin.polygon = patch(kBone, 0.03, -0.06, 0.006, 0.004);
  const Result result = build(head.inputs());
  ASSERT_EQ(result.modioli.size(), 1u);
  const Modiolus& node = result.modioli[0];
  EXPECT_EQ(node.name, "modiolus_left");
  EXPECT_EQ(node.muscles, (std::vector<std::string>{"above", "below", "upper"}));
  EXPECT_NEAR((node.centre - front(kSmas, 0.033, -0.031)).norm(), 0.0, 1e-3);
  EXPECT_LE(node.radius, 0.0055);
  for (const Muscle& muscle : result.muscles) {
    EXPECT_EQ(muscle.crossings, 0) << muscle.name;
    for (const Fibre& fibre : muscle.fibres) {
      const Vec3 end = muscle.name == "upper" ? fibre.points.front().position : fibre.points.back().position;
      EXPECT_LT((end.normalized() - node.centre.normalized()).norm() * kSmas, 0.0055) << muscle.name;
    }
  }
  EXPECT_EQ(result.muscles[2].origin_on, Attachment::modiolus);
  // Away from the corner the rings keep their distance.
  const Fibre& outer = result.muscles[2].fibres.back();
  EXPECT_GT(outer.points.back().position[1], -0.03 + 0.015);
  head.constants.modiolus_radius = 0.0;
  EXPECT_TRUE(build(head.inputs()).modioli.empty());
}

TEST(BuildMuscles, RunAcrossRegionsThatOverlapOrContainEachOther) {
  BallHead head;
  anatomy::Muscle over = strap("over", 1.0), inside = strap("inside", -1.0);
  over.origin = {Attachment::smas, patch(kSmas, 0.03, 0.0, 0.008, 0.008)};
  over.insertion = {Attachment::smas, patch(kSmas, 0.036, -0.004, 0.008, 0.008)};
  inside.origin = {Attachment::smas, patch(kSmas, -0.03, 0.0, 0.012, 0.012)};
  inside.insertion = {Attachment::smas, patch(kSmas, -0.03, 0.0, 0.003, 0.003)};
  head.muscles = {over, inside};
  head.constants.modiolus_radius = 0.0;
  const Result result = build(head.inputs());
  for (const Muscle& muscle : result.muscles) {
    EXPECT_GT(muscle.shortest, 0.003) << muscle.name;
    EXPECT_EQ(muscle.crossings, 0) << muscle.name;
  }
  // Across both: all fibres run towards the insertion.
  for (const Fibre& fibre : result.muscles[0].fibres)
    EXPECT_GT((fibre.points.back().position - fibre.points.front().position).dot(Vec3(0.006, -0.004, 0.0)),
              0.0);
  // From all sides inward: fibres end within the inner region.
  for (const Fibre& fibre : result.muscles[1].fibres)
    EXPECT_LT((fibre.points.back().position - front(kSmas, -0.03, 0.0)).norm(), 0.006);
}

TEST(Sketches, StandForRegionsOrSayWhyNot) {
  BallHead head;
  head.muscles = {strap("a", 1.0)};
  const auto built = [&](Sketch sketch) {
    Options options;
    options.edits["a"].origin = std::move(sketch);
    return build(head.inputs(), options).muscles[0];
  };
  const auto refused = [&](Sketch sketch, const std::string& says) {
    try {
      built(std::move(sketch));
      ADD_FAILURE() << "not refused: " << says;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("a: origin"), std::string::npos) << error.what();
    }
  };
  const std::vector<Vec3> square = patch(kSkin, 0.03, 0.04, 0.005, 0.005);
  std::vector<Vec3> cloud = {square[2], square[0], front(kSkin, 0.03, 0.04), square[3], square[1]};
  // A curve round the region and points in it, in any order, are the same region; on the skin, they are
  // brought to the bone.
  const Muscle curve = built({square, true}), points = built({cloud, false});
  ASSERT_EQ(curve.fibres.size(), points.fibres.size());
  EXPECT_NEAR(curve.mean_length, points.mean_length, 1e-4);
  for (const Fibre& fibre : curve.fibres)
    EXPECT_NEAR(fibre.points.front().position.norm(), kBone, 2e-4);
  refused({{}, true}, "three or more");
  refused({{square[0], square[0], square[1]}, true}, "2 different points");
  refused({{square[0], square[2], square[1], square[3]}, true}, "crosses itself");
  refused({{square[0], square[1], Vec3(0.03, 0.04, 0.13)}, true}, "off the head");
  refused({{square[0], square[1], Vec3(0.03, NAN, 0.1)}, true}, "finite");
  refused({patch(kSkin, 0.03, 0.04, 0.0002, 0.0002), true}, "wide");
  head.muscles = {ring("a", MuscleKind::sphincter_ring, 0.004, 0.012, 0.0, kPi)};
  Options options;
  options.edits["a"].origin = Sketch{square, true};
  EXPECT_THROW(build(head.inputs(), options), Error) << "a ring has no regions";
}

TEST(BuildMuscles, CarriesRegionsByTheWarp) {
  BallHead head;
  head.muscles = {strap("a", 1.0)};
  const std::vector<Vec3> from = {Vec3(0, 0, 0), Vec3(.1, 0, 0), Vec3(0, .1, 0), Vec3(0, 0, .1)};
  std::vector<Vec3> to = from;
  for (Vec3& p : to)
    p[0] = -p[0];  // the mirror: the muscle comes out on the right
  const splines::Warp warp = splines::fit_warp(from, to);
  Inputs inputs = head.inputs();
  inputs.warp = &warp;
  const Result result = build(inputs);
  for (const Fibre& fibre : result.muscles[0].fibres)
    EXPECT_LT(fibre.points[0].position[0], -0.03);
}

TEST(BuildMuscles, OneThatFailsIsOmittedAndNamedTheOthersAreBuilt) {
  BallHead head;
  head.muscles = {strap("a", 1.0), strap("b", -1.0)};
  head.muscles[0].insertion.polygon[0][1] = NAN;
  const Result result = build(head.inputs());
  ASSERT_EQ(result.muscles.size(), 1U);
  EXPECT_EQ(result.muscles[0].name, "b");
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_EQ(result.warnings[0].rfind("a was omitted", 0), 0U) << result.warnings[0];
  Options edited;
  edited.edits["a"].strength = 2.0;  // what the user is at work on he is told of
  EXPECT_THROW(build(head.inputs(), edited), Error);
}

TEST(BuildMuscles, ReportsMissingInput) {
  BallHead head;
  head.muscles = {ring("o", MuscleKind::sphincter_ring, 0.004, 0.012, 0.0, kPi)};
  Inputs inputs = head.inputs();
  inputs.landmarks.erase("stomion");
  const Result without = build(inputs);
  EXPECT_TRUE(without.muscles.empty());
  ASSERT_FALSE(without.warnings.empty());
  EXPECT_NE(without.warnings[0].find("stomion"), std::string::npos);
  EXPECT_THROW(build({}), Error);
  head.muscles = {strap("a", 1.0), strap("a", -1.0)};
  EXPECT_THROW(build(head.inputs()), Error);
  head.muscles = {strap("a", 1.0)};
  Options options;
  options.edits["unknown"].strength = 2.0;
  EXPECT_THROW(build(head.inputs(), options), Error);
}

}  // namespace
}  // namespace fascia::muscles
