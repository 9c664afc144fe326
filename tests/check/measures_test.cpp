// Each measure on surfaces whose answer is known beforehand.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "check/crossing.h"
#include "check/damage.h"
#include "check/eye_turn.h"
#include "check/landmark_motion.h"
#include "check/lids.h"
#include "check/lip_look.h"
#include "check/mirror.h"
#include "check/openings.h"
#include "check/scale.h"
#include "check/stillness.h"
#include "tests/check/shapes.h"

namespace fascia::check {
namespace {

using namespace fascia::testing;

LidState lids_of(const Head& head, const Head& posed) {
  const Skin skin(head, Vec3::Zero(), 0.1);
  const LidLook look(head, skin, *head.eyes[0], lid_seam(skin, head.landmarks, *head.eyes[0], true), true);
  const Shape shape = rest_shape(posed);
  return look.look(skin.vertices(shape), shape);
}

TEST(Lids, GapIsTheVisibleArcBetweenThem) {
  const Head open = eye_with_lids(0.5, -0.3);
  const LidState state = lids_of(open, open);
  ASSERT_EQ(state.gaps.size(), 9U);
  for (const double gap : state.gaps)
    EXPECT_NEAR(gap, 0.8 * 0.012, 1.5e-4);
  EXPECT_NEAR(lids_of(open, eye_with_lids(0.05, -0.05)).widest, 0.1 * 0.012, 1.5e-4);
  EXPECT_EQ(lids_of(open, eye_with_lids(0.0, 0.0)).widest, 0.0);
}

TEST(Lids, OneStationLeftOpenIsFound) {
  const Head open = eye_with_lids(0.5, -0.3);
  Head posed = eye_with_lids(0.0, 0.0);
  // A notch in the upper lid over the fourth station of nine, .16 radians high.
  std::vector<Vec3>& skin = posed.parts[0].mesh.vertices;
  for (size_t v = 0; v < skin.size() / 2; ++v) {
    const double azimuth = std::atan2(skin[v].x(), skin[v].z()), elevation = std::asin(skin[v].y() / 0.0125);
    if (std::abs(azimuth - 1.22 * (2 * 0.4 - 1)) > 0.1 || elevation > 0.16) continue;
    skin[v] =
        0.0125 * Vec3(std::sin(azimuth) * std::cos(0.16), std::sin(0.16), std::cos(azimuth) * std::cos(0.16));
  }
  const LidState state = lids_of(open, posed);
  EXPECT_NEAR(state.widest, 0.16 * 0.012, 3e-4);
  EXPECT_EQ(std::max_element(state.gaps.begin(), state.gaps.end()) - state.gaps.begin(), 3);
}

TEST(Lids, AnEyeballThatStandsOutIsMeasured) {
  const Head open = eye_with_lids(0.5, -0.3);
  Head posed = eye_with_lids(0.0, 0.0);
  EXPECT_EQ(lids_of(open, posed).cornea_out, 0.0);
  for (Vec3& p : posed.parts[1].mesh.vertices)
    p *= 13.2 / 12.0;  // .7 mm beyond the lids
  EXPECT_NEAR(lids_of(open, posed).cornea_out, 7e-4, 1e-4);
}

TEST(Lids, AFoldFarBeforeTheLidHidesTheEye) {
  // Above its edge the lid hangs over in a fold 21 mm from the eye's centre, and its lining lies within the
  // ball: what one sees there is the fold, not the eye.
  const auto folded = [](double upper, double lower) {
    Head head = eye_with_lids(upper, lower);
    std::vector<Vec3>& skin = head.parts[0].mesh.vertices;
    const TriangleMesh lid = head.parts[0].mesh;
    for (Vec3& p : skin)
      if (std::asin(p.y() / p.norm()) > 0.52) p *= 21.0 / 12.5;
    TriangleMesh lining = lid;
    for (Vec3& p : lining.vertices)
      p *= std::asin(p.y() / p.norm()) > 0.52 ? 10.0 / 12.5 : 1.0;
    append(head.parts[0].mesh, lining);
    return head;
  };
  const Head open = folded(0.5, -0.3);
  EXPECT_EQ(lids_of(open, folded(0.0, 0.0)).cornea_out, 0.0);
}

/// The eyeball as a part of the skin that nothing moves, as in scans.
Head scanned(Head head) {
  head.parts[0].is_still.assign(head.parts[0].mesh.vertices.size(), false);
  append(head.parts[0].mesh, head.parts[1].mesh);
  head.parts[0].is_still.resize(head.parts[0].mesh.vertices.size(), true);
  head.parts.pop_back();
  return head;
}

TEST(Lids, AnEyeMergedWithTheLidsIsTheVisiblePartBetweenThem) {
  const Head open = scanned(eye_with_lids(0.5, -0.3));
  EXPECT_NEAR(lids_of(open, open).widest, 0.8 * 0.012, 1.5e-4);
  EXPECT_EQ(lids_of(open, scanned(eye_with_lids(0.0, 0.0))).widest, 0.0);
}

TEST(Lids, AFlatEyeMergedWithTheLidsCountsAsCoveredByThem) {
  constexpr double deep = 0.5, before = 0.55;  // of where eyes lie
  // What of the lids has come between the edges at rest lies deep too.
  const auto flat = [&](Head head) {
    for (Vec3& p : head.parts[0].mesh.vertices)
      if (const double elevation = std::asin(p.y() / 0.0125); elevation < 0.47 && elevation > -0.27)
        p *= before;
    for (Vec3& p : head.parts[1].mesh.vertices)
      p *= deep;
    return scanned(std::move(head));
  };
  const Head open = flat(eye_with_lids(0.5, -0.3));
  EXPECT_NEAR(lids_of(open, open).widest, 0.8 * 0.012, 1.5e-4);
  EXPECT_EQ(lids_of(open, flat(eye_with_lids(0.0, 0.0))).widest, 0.0);
  EXPECT_NEAR(lids_of(open, flat(eye_with_lids(0.05, -0.05))).widest, 0.1 * 0.012, 1.5e-4);
}

TEST(Lids, ThatAreShutAtRestAndStayAreClosed) {
  constexpr double slit = 0.004;  // radians on each side: edges in one place are welded
  Head shut = eye_with_lids(slit, -slit);
  shut.parts.pop_back();
  shut.parts[0].is_still.assign(shut.parts[0].mesh.vertices.size(), true);
  // Both margins placed on the upper lid, as where the eye was thought open.
  shut.landmarks["palpebrale_superius_left"] = 0.0125 * Vec3(0.0, std::sin(0.5), std::cos(0.5));
  shut.landmarks["palpebrale_inferius_left"] = 0.0125 * Vec3(0.0, std::sin(0.1), std::cos(0.1));
  const LidState state = lids_of(shut, shut);
  EXPECT_EQ(state.gaps.size(), 9U);
  EXPECT_LT(state.widest, 3.0 * slit * 0.012);
}

TEST(Lids, ThatAreShutButForALineOfLashesAreShut) {
  // Over two of nine stations the edges lie 1 mm apart: the rest tells that nothing opens here.
  Head shut = eye_with_lids(0.004, -0.004);
  shut.parts.pop_back();
  std::vector<Vec3>& skin = shut.parts[0].mesh.vertices;
  shut.parts[0].is_still.assign(skin.size(), true);
  for (size_t v = 0; v < skin.size() / 2; ++v) {
    const double azimuth = std::atan2(skin[v].x(), skin[v].z()), elevation = std::asin(skin[v].y() / 0.0125);
    if (std::abs(azimuth + 0.122) > 0.2 || elevation > 0.08) continue;
    skin[v] =
        0.0125 * Vec3(std::sin(azimuth) * std::cos(0.08), std::sin(0.08), std::cos(azimuth) * std::cos(0.08));
  }
  const LidState state = lids_of(shut, shut);
  EXPECT_EQ(state.gaps.size(), 9U);
  EXPECT_NEAR(state.widest, 0.084 * 0.012, 1e-4);
}

TEST(Lids, SeamFollowsBothEdges) {
  const Head open = eye_with_lids(0.5, -0.3);
  const Skin skin(open, Vec3::Zero(), 0.1);
  const Seam seam = lid_seam(skin, open.landmarks, *open.eyes[0], true);
  ASSERT_EQ(seam.stations.size(), 9U);
  for (size_t s = 0; s < 9; ++s) {
    EXPECT_NEAR(std::asin(position(skin.rest(), seam.upper_edge[s]).y() / 0.0125), 0.5, 0.03);
    EXPECT_NEAR(std::asin(position(skin.rest(), seam.lower_edge[s]).y() / 0.0125), -0.3, 0.03);
  }
}

TEST(Mouth, OpensAsWideAsItsLipsPart) {
  const Head closed = flat_mouth();
  const Skin skin(closed, Vec3::Zero(), 0.2);
  const Seam seam = mouth_seam(skin, closed.landmarks, 1.0);
  ASSERT_GE(seam.stations.size(), 37U);
  const MouthOpening at_rest = mouth_opening(skin, seam, skin.rest().vertices, 1e-3);
  EXPECT_LT(at_rest.parted_share, 0.06);  // but for the stations next to the corners
  const MouthOpening open = mouth_opening(skin, seam, skin.vertices(rest_shape(flat_mouth(0.02))), 1e-3);
  EXPECT_NEAR(open.most, 0.02, 5e-4);
  EXPECT_GT(open.parted_share, 0.95);
  EXPECT_NEAR(open.corner_left, 0.714, 0.04);  // an ellipse at 15 % of its width
  EXPECT_NEAR(open.corner_right, 0.714, 0.04);
}

TEST(Mouth, ALowerLipThatMovesUpIsNoOpening) {
  const Head closed = flat_mouth();
  const Skin skin(closed, Vec3::Zero(), 0.2);
  const Seam seam = mouth_seam(skin, closed.landmarks, 1.0);
  EXPECT_EQ(mouth_opening(skin, seam, skin.vertices(rest_shape(flat_mouth(-0.01))), 1e-3).parted_share, 0.0);
}

TEST(Mouth, LipsThatAreOneSurfaceDoNotPart) {
  Head head = flat_mouth();
  head.parts[0].mesh =
      grid(120, 120, [](double u, double v) { return Vec3(0.12 * (u - 0.5), 0.12 * (v - 0.5), 0.0); });
  const Skin skin(head, Vec3::Zero(), 0.2);
  const Seam seam = mouth_seam(skin, head.landmarks, 1.0);
  std::vector<Vec3> stretched = skin.rest().vertices;
  for (Vec3& p : stretched)
    if (p.y() < 0.0) p.y() *= 1.3;
  EXPECT_EQ(mouth_opening(skin, seam, stretched, 1e-3).parted_share, 0.0);
}

TEST(Crossing, DepthBehindAPlateIsItsDistance) {
  const TriangleMesh plate = grid(10, 10, [](double u, double v) { return Vec3(0.02 * u, 0.02 * v, 0.0); });
  const Vec3 against(0, 0, -1), along(0, 0, 1);
  const std::vector<double> depth =
      depths_behind({Vec3(0.011, 0.009, -7e-4), Vec3(0.011, 0.009, -7e-4), Vec3(0.011, 0.009, 7e-4),
                     Vec3(0.011, 0.009, -5e-3), Vec3(-0.001, 0.01, -7e-4)},
                    {against, along, against, against, against}, plate, 0.003);
  EXPECT_NEAR(depth[0], 7e-4, 1e-9);
  EXPECT_EQ(depth[1], 0.0) << "faces as the plate does: no crossing, its own other side";
  EXPECT_EQ(depth[2], 0.0) << "before it";
  EXPECT_EQ(depth[3], 0.0) << "too far behind";
  EXPECT_EQ(depth[4], 0.0) << "beside it";
}

TEST(Crossing, LipsThatPassEachOtherAreMeasured) {
  // The lower lip as a ledge below the upper one, as deep as it is high, and pushed up into it.
  const Head head = thick_lips(0.0);
  const Skin skin(head, Vec3::Zero(), 0.2);
  const Seam seam = mouth_seam(skin, head.landmarks, 1.0);
  ASSERT_FALSE(seam.empty());
  const Crossings crossings = crossings_of(skin, seam, {}, {}, 1.0);
  ASSERT_EQ(crossings.kinds.size(), 1U);
  const auto worst = [&](double up) {
    Depth depth;
    for (const CrossingPair& pair : crossings.kinds[0].pairs)
      depth.take(pair.find(skin.vertices(rest_shape(thick_lips(up)))));
    return depth.most;
  };
  EXPECT_EQ(worst(0.0), 0.0);
  EXPECT_EQ(worst(-0.002), 0.0);
  EXPECT_NEAR(worst(0.0009), 7e-4, 1e-5);
}

TEST(Poking, TeethBeforeTheLipsAreMeasured) {
  Head head = thick_lips(0.0);
  head.parts.push_back({"teeth_upper", grid(10, 10, [](double u, double v) {
                          return Vec3(0.02 * (u - 0.5), 0.004 + 0.005 * v, -0.002);
                        })});
  const Skin skin(head, Vec3::Zero(), 0.2);
  const TrackedLandmarks landmarks(skin, head.landmarks);
  const LipLook look(head, skin, landmarks, 1.0);
  ASSERT_TRUE(look.has_teeth());
  Shape shape = rest_shape(head);
  EXPECT_EQ(look.look(skin.rest().vertices, shape).teeth.most, 0.0);
  for (Vec3& p : shape[1])
    p.z() += 0.0035;                                                             // 1.5 mm before the lip
  EXPECT_NEAR(look.look(skin.rest().vertices, shape).teeth.most, 1.5e-3, 4e-4);  // longer seen aslant
  EXPECT_EQ(look.look(skin.rest().vertices, shape).lining.most, 0.0);
}

TEST(Damage, CountsTurnedTrianglesAndStretchedEdges) {
  Head head;
  head.parts.push_back(
      {"skin", grid(20, 20, [](double u, double v) { return Vec3(0.02 * u, 0.02 * v, 0.0); })});
  const Skin skin(head, Vec3(0.01, 0.01, 0), 1.0);
  EXPECT_EQ(damage(skin, skin.rest().vertices, 1e-4).turned, 0);
  std::vector<Vec3> wide = skin.rest().vertices;
  for (Vec3& p : wide)
    p.x() *= 3.0;
  const Damage stretched = damage(skin, wide, 1e-4);
  EXPECT_EQ(stretched.stretched, 20 * 21);  // the edges along x; the diagonals grow by 2.24
  EXPECT_NEAR(stretched.longest, 3.0, 1e-9);
  EXPECT_EQ(stretched.turned, 0);
  std::vector<Vec3> turned = skin.rest().vertices;
  size_t vertex = 0;
  for (size_t v = 0; v < turned.size(); ++v)
    if ((turned[v] - Vec3(0.01, 0.01, 0)).norm() < 1e-6) vertex = v;
  turned[vertex].x() += 0.0014;  // over the edge of the two triangles to its right
  int expected = 0;
  for (const Triangle& t : skin.rest().triangles) {
    const auto p = [&](size_t k) { return turned[static_cast<size_t>(t[k])]; };
    expected += (p(1) - p(0)).cross(p(2) - p(0)).z() < 0.0;
  }
  ASSERT_GT(expected, 0);
  EXPECT_EQ(damage(skin, turned, 1e-4).turned, expected);
}

TEST(Damage, WhatStaysUnderAFoldIsNotTurned) {
  // A sheet folds down over what it is one with, as a lid over an eye that is its own skin: the strip between
  // the two turns over, and the rows above and below it face against that without having turned.
  Head head;
  head.parts.push_back(
      {"skin", grid(4, 20, [](double u, double v) { return Vec3(0.02 * u, 0.02 * v, 0.0); })});
  const Skin skin(head, Vec3(0.01, 0.01, 0), 1.0);
  std::vector<Vec3> folded = skin.rest().vertices;
  for (Vec3& p : folded)
    if (p.y() > 0.0105) p += Vec3(0.0, -0.0025, 0.001);
  EXPECT_EQ(damage(skin, folded, 1e-4).turned, 0);
}

TEST(Eyes, TurnAboutAnotherPointThanTheirCentre) {
  const Head head = eye_with_lids(0.5, -0.3);
  const std::vector<Vec3>& rest = head.parts[1].mesh.vertices;
  Vec3 centre;
  double radius = 0.0;
  ASSERT_TRUE(sphere_centre(rest, centre, radius));
  EXPECT_LT(centre.norm(), 1e-6);
  EXPECT_NEAR(radius, 0.012, 1e-6);
  const Mat3 turn = Eigen::AngleAxisd(25.0 * EIGEN_PI / 180.0, Vec3::UnitY()).toRotationMatrix();
  const Vec3 about(0.0, 0.0, 0.001);
  std::vector<Vec3> now;
  for (const Vec3& p : rest)
    now.push_back(turn * (p - about) + about);
  const EyeTurn found = eye_turn(rest, now, centre);
  EXPECT_NEAR(found.yaw * 180.0 / EIGEN_PI, 25.0, 1e-6);
  EXPECT_NEAR(found.off_centre, 0.001, 1e-8);
  EXPECT_LT(found.bent, 1e-9);
  now[7] += Vec3(0, 0.0005, 0);
  EXPECT_NEAR(eye_turn(rest, now, centre).bent, 5e-4, 5e-5);
}

TEST(Mirror, AHalfThatMovesTwoMillimetresMoreIsFound) {
  const Head head = flat_mouth();
  Landmarks landmarks = head.landmarks;
  landmarks["buccale_left"] = Vec3(0.04, -0.01, 0);
  landmarks["buccale_right"] = Vec3(-0.04, -0.012, 0);  // not quite where its partner is
  const Skin skin(head, Vec3::Zero(), 0.2);
  const MirrorPoints mirror(skin, landmarks, 1.0);
  std::vector<Vec3> posed = skin.rest().vertices;
  Vec3 place;
  for (Vec3& p : posed)
    p += Vec3(0.1 * p.x(), 0.002, 0.001);
  EXPECT_LT(mirror.asymmetry(posed, place), 2e-4);
  for (Vec3& p : posed)
    if (p.x() > 0) p.y() += 0.002;
  EXPECT_NEAR(mirror.asymmetry(posed, place), 0.002, 2e-4);
}

TEST(Mirror, WhereLipsMeetEachIsComparedWithItself) {
  Head head = flat_mouth();
  // The left half of the lips meets .4 mm higher than the right.
  for (Vec3& p : head.parts[0].mesh.vertices)
    if (p.x() > 0.002 && p.x() < 0.024 && std::abs(p.y()) < 0.004) p.y() += 0.0004;
  Landmarks landmarks = head.landmarks;
  for (int k = 0; k < 20; ++k) {
    const double x = 0.003 + 0.001 * k;
    landmarks["edge_" + std::to_string(k) + "_left"] = Vec3(x, 0.0004 + 1.5e-4, 0);
    landmarks["edge_" + std::to_string(k) + "_right"] = Vec3(-x, 1.5e-4, 0);
  }
  const Skin skin(head, Vec3::Zero(), 0.2);
  const Seam seam = mouth_seam(skin, head.landmarks, 1.0);
  std::vector<Vec3> posed = skin.rest().vertices;
  for (size_t v = 0; v < posed.size(); ++v)
    if (seam.sides[v] == Seam::lower && std::abs(posed[v].x()) < 0.0249) posed[v].y() -= 0.01;
  Vec3 place;
  EXPECT_LT(MirrorPoints(skin, landmarks, 1.0, seam.sides).asymmetry(posed, place), 5e-4);
}

TEST(Motion, DirectionsAreTheSubjects) {
  EXPECT_EQ(along(Vec3(1, 2, 3), "out", true), 1);
  EXPECT_EQ(along(Vec3(1, 2, 3), "out", false), -1);
  EXPECT_EQ(along(Vec3(1, 2, 3), "in", false), 1);
  EXPECT_EQ(along(Vec3(1, 2, 3), "down", true), -2);
  EXPECT_EQ(along(Vec3(1, 2, 3), "back", true), -3);
  EXPECT_NEAR(along(Vec3(1, 2, 2), "away", true), 3, 1e-12);
}

TEST(Still, HairAboveTheHairlineAndTheNeckAreWatched) {
  Head head = flat_mouth();
  head.landmarks["trichion"] = Vec3(0, 0.03, 0);
  head.landmarks["gnathion"] = Vec3(0, -0.02, 0);
  head.parts.push_back({"hair", grid(4, 4, [](double u, double v) { return Vec3(u - 0.5, 0.1 * v, 0.0); })});
  Shape shape = rest_shape(head);
  for (Vec3& p : shape[1])
    p.x() += p.y() > 0.06 ? 0.003 : 0.02;  // a moustache may move
  const std::vector<Stillness> found = stillness(head, shape, 0.03);
  ASSERT_EQ(found.size(), 2U);
  for (const Stillness& one : found)
    EXPECT_NEAR(one.most, one.name == "hair" ? 0.003 : 0.0, 1e-12) << one.name;
}

TEST(Sizes, GrowWithTheFace) {
  Landmarks face = {{"exocanthion_left", Vec3(0.045, 0.035, 0)},
                    {"exocanthion_right", Vec3(-0.045, 0.035, 0)},
                    {"endocanthion_left", Vec3(0.015, 0.035, 0)},
                    {"endocanthion_right", Vec3(-0.015, 0.035, 0)},
                    {"cheilion_left", Vec3(0.025, -0.035, 0)},
                    {"cheilion_right", Vec3(-0.025, -0.035, 0)},
                    {"sellion", Vec3(0, 0.04, 0.01)},
                    {"gnathion", Vec3(0, -0.08, 0)}};
  const AdultSizes adult = distances(face);
  EXPECT_NEAR(adult.mouth, 0.05, 1e-12);
  EXPECT_NEAR(adult.eye, 0.03, 1e-12);
  for (auto& [name, p] : face)
    p *= 0.6;
  const Sizes child = sizes(face, adult);
  EXPECT_NEAR(child.face, 0.6, 1e-12);
  EXPECT_NEAR(child.mouth, 0.6, 1e-12);
  EXPECT_NEAR(child.eye, 0.6, 1e-12);
}

}  // namespace
}  // namespace fascia::check
