// Figures 4.11 and 4.12 to the digits of an independent computation (NumPy, dense saddle system).
#include "builder/splines/deformation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "builder/splines/crease.h"
#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

constexpr double digits8 = 6e-9, digits7 = 6e-8;
constexpr double quarter = std::numbers::pi / 4;

Mat3 rotation(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

struct Figure411 {
  double exponent;
  int degree;
  Vec2 diagonal, half, twice, corner;
};

TEST(Deformation, Figure411RotatedGradientsInThePlane) {
  const Vec2 four_diagonal(-0.29155744, 0.12076705), four_half(0.05538725, -0.13371664),
      four_twice(-0.52294682, 1.26250531), four_corner(-2.27465315, 0.94219218);
  for (const Figure411& expected : {Figure411{3.5,
                                              -1,
                                              {-0.25763541, 0.10671608},
                                              {0.05207219, -0.12571338},
                                              {-0.43304361, 1.04545976},
                                              {-1.69547215, 0.70228756}},
                                    Figure411{4, 1, four_diagonal, four_half, four_twice, four_corner},
                                    Figure411{3,
                                              -1,
                                              {-0.20924719, 0.08667303},
                                              {0.04513857, -0.10897414},
                                              {-0.33287209, 0.80362431},
                                              {-1.17845412, 0.48813168}},
                                    Figure411{4, 2, four_diagonal, four_half, four_twice, four_corner}}) {
    std::vector<DeformationLandmark> landmarks(4);
    const Vec3 places[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    for (int i = 0; i < 4; ++i) {
      landmarks[i].source = landmarks[i].target = places[i];
      landmarks[i].carry_frame(rotation(Vec3::UnitZ(), quarter), 2);
    }
    DeformationOptions options;
    options.dimension = 2;
    options.exponent = expected.exponent;
    options.degree = expected.degree;
    const Warp warp = fit_deformation(landmarks, options);
    const auto shift = [&](double x, double y) {
      return Vec2((warp(Vec3(x, y, 0)) - Vec3(x, y, 0)).head<2>());
    };
    const double h = std::numbers::sqrt2 / 2;
    // The figures' corner points are the exact ones.
    EXPECT_LT((shift(h, h) - expected.diagonal).cwiseAbs().maxCoeff(), digits8) << expected.exponent;
    EXPECT_LT((shift(0.5, 0) - expected.half).cwiseAbs().maxCoeff(), digits8);
    EXPECT_LT((shift(2, 0) - expected.twice).cwiseAbs().maxCoeff(), digits8);
    EXPECT_LT((shift(1.5, 1.5) - expected.corner).cwiseAbs().maxCoeff(), digits8);
    for (const Vec3& place : places)
      EXPECT_LT((warp.jacobian(place) - rotation(Vec3::UnitZ(), quarter)).norm(), 1e-10);
    EXPECT_EQ(warp(Vec3(0.3, 0.2, 5)).z(), 5);
  }
}

struct Figure412 {
  bool about_own_radius, further_turn;
  Vec3 edge, equator, centre;
};

// Landmarks at the octahedron's corners stay; triads at the four of the equator turn by -45 degrees about the
// vertical or each about its own radius (c), and the one at +x by -45 degrees more about x (d).
TEST(Deformation, Figure412cdTurnedTriads) {
  for (const Figure412& expected :
       {Figure412{false, false, {-0.0132854, -0.0320737, 0}, {0.0866730, -0.2092472, 0}, {0, 0, 0}},
        Figure412{false,
                  true,
                  {-0.0132854, 0.1771635, -0.0943762},
                  {0.0866730, -0.2571271, -0.1155923},
                  {0, -0.0261424, -0.0631133}},
        Figure412{true, false, {-0.0195482, 0.2705981, -0.0731943}, {-0.0648046, -0.0648046, 0}, {0, 0, 0}},
        Figure412{true,
                  true,
                  {-0.0195482, 0.3583957, -0.2851565},
                  {-0.0648046, -0.2222870, -0.0652314},
                  {0, 0, 0}}}) {
    std::vector<DeformationLandmark> landmarks;
    std::vector<Mat3> turns;
    for (const Vec3& corner :
         {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
      DeformationLandmark landmark;
      landmark.source = landmark.target = corner;
      Mat3 turn = rotation(expected.about_own_radius ? corner : Vec3::UnitZ(), -quarter);
      if (expected.further_turn && corner.x() == 1) turn = rotation(Vec3::UnitX(), -quarter) * turn;
      if (corner.z() == 0) landmark.carry_frame(turn);
      landmarks.push_back(landmark);
      turns.push_back(turn);
    }
    const Warp warp = fit_deformation(landmarks);
    const double h = std::numbers::sqrt2 / 2;
    const auto shift = [&](const Vec3& p) { return Vec3(warp(p) - p); };
    EXPECT_LT((shift({h, 0, h}) - expected.edge).cwiseAbs().maxCoeff(), digits7);
    EXPECT_LT((shift({h, h, 0}) - expected.equator).cwiseAbs().maxCoeff(), digits7);
    EXPECT_LT((shift({0, 0, 0}) - expected.centre).cwiseAbs().maxCoeff(), digits7);
    for (size_t i = 2; i < 6; ++i)
      EXPECT_LT((warp.jacobian(landmarks[i].source) - turns[i]).norm(), 1e-10);
  }
}

TEST(Deformation, VectorsOfALandmarkArriveAndTheRestIsFree) {
  std::vector<DeformationLandmark> landmarks;
  for (const Vec3& p : scattered(12, 1)) {
    DeformationLandmark landmark;
    landmark.source = p;
    landmark.target = 1.1 * p + Vec3(0, 0.1 * p.x() * p.x(), 0);
    landmarks.push_back(landmark);
  }
  landmarks[0].vectors = {{Vec3(1, 1, 0), Vec3(0.5, 1.5, 0.2)}};
  landmarks[4].vectors = {{Vec3(0, 0, 2), Vec3(0, 1, 2)}, {Vec3(0, 1, 0), Vec3(0, 1, -0.5)}};
  const Warp warp = fit_deformation(landmarks);
  for (const DeformationLandmark& landmark : landmarks) {
    EXPECT_LT((warp(landmark.source) - landmark.target).norm(), 1e-10);
    for (const CarriedVector& carried : landmark.vectors)
      EXPECT_LT((warp.jacobian(landmark.source) * carried.vector - carried.image).norm(), 1e-9);
  }
}

TEST(Deformation, NormalsCarryTangentPlanesAndCostLessThanWholeFrames) {
  std::vector<DeformationLandmark> landmarks;
  for (const Vec3& p : scattered(14, 2)) {
    DeformationLandmark landmark;
    landmark.source = p;
    landmark.target = p + 0.1 * Vec3(p.y() * p.z(), p.x() * p.z(), p.x());
    landmark.normal = CarriedNormal{p, p + Vec3(0.3, 0.1, -0.2)};
    landmarks.push_back(landmark);
  }
  const Warp warp = fit_deformation(landmarks);
  std::vector<DeformationLandmark> framed = landmarks;
  for (size_t i = 0; i < landmarks.size(); ++i) {
    const Mat3 J = warp.jacobian(landmarks[i].source);
    for (const Vec3& tangent : tangents(landmarks[i].normal->source))
      EXPECT_NEAR(landmarks[i].normal->target.normalized().dot(J * tangent), 0, 1e-9);
    EXPECT_LT((warp(landmarks[i].source) - landmarks[i].target).norm(), 1e-9);
    // The same with the images of the tangents nudged within the target's tangent plane bends more.
    framed[i].normal.reset();
    for (const Vec3& tangent : tangents(landmarks[i].normal->source))
      framed[i].vectors.push_back({tangent, J * tangent});
  }
  const double least = warp.displacement().coefficients().energy;
  EXPECT_NEAR(fit_deformation(framed).displacement().coefficients().energy, least, 1e-8 * least);
  framed[3].vectors[0].image *= 1.05;
  EXPECT_GT(fit_deformation(framed).displacement().coefficients().energy, least);
}

TEST(Deformation, AffineMapsAndTheirNormalsAreExact) {
  Mat3 A;
  A << 1.2, 0.1, -0.3, 0.2, 0.8, 0.1, 0, -0.1, 1.1;
  std::vector<DeformationLandmark> landmarks;
  for (const Vec3& p : scattered(10, 3)) {
    DeformationLandmark landmark;
    landmark.source = p;
    landmark.target = A * p;
    landmark.normal = CarriedNormal{p, A.inverse().transpose() * p};
    landmarks.push_back(landmark);
  }
  const Warp warp = fit_deformation(landmarks);
  for (const Vec3& p : scattered(10, 4))
    EXPECT_LT((warp(p) - A * p).norm(), 1e-8);
}

TEST(Deformation, RefusesDependentVectors) {
  std::vector<DeformationLandmark> landmarks(5);
  for (int i = 0; i < 5; ++i)
    landmarks[i].source = landmarks[i].target = scattered(5, 5)[i];
  landmarks[2].vectors = {{Vec3(1, 0, 0), Vec3(1, 0, 0)}, {Vec3(2, 0, 0), Vec3(3, 0, 0)}};
  EXPECT_THROW(fit_deformation(landmarks), Error);
  landmarks[2].vectors.clear();
  landmarks[2].normal = CarriedNormal{Vec3::Zero(), Vec3(0, 0, 1)};
  EXPECT_THROW(fit_deformation(landmarks), Error);
}

// Two landmarks pushed towards each other press the grid between them, across the line that joins them.
TEST(Crease, LiesBetweenLandmarksThatApproach) {
  std::vector<Vec3> source = {{-0.25, 0, 0}, {0.25, 0, 0}, {-2, -2, 0}, {2, -2, 0}, {-2, 2, 0}, {2, 2, 0}};
  std::vector<Vec3> target = source;
  target[0].x() = -0.1;
  target[1].x() = 0.1;
  WarpOptions options;
  options.dimension = 2;
  options.exponent = 2;
  const Warp warp = fit_warp(source, target, options);
  const std::vector<Crease> creases = find_creases(warp, {Vec3(-0.2, -1.4, 0), Vec3(0.2, 1.4, 0)});
  ASSERT_FALSE(creases.empty());
  EXPECT_LT(creases[0].stretch, 0.6);
  EXPECT_NEAR(creases[0].stretch, std::abs(warp.jacobian(creases[0].point)(0, 0)), 1e-9);
  EXPECT_NEAR(std::abs(creases[0].direction.x()), 1, 1e-3);
  EXPECT_NEAR(creases[0].point.y(), 0, 0.02);
}

// The edge information of one vector makes a crease of the asked stretch at the asked place.
TEST(Crease, AnImposedCreaseIsFound) {
  std::vector<DeformationLandmark> landmarks(5);
  const Vec3 places[] = {{0.1, -0.2, 0}, {-2, -2, 0}, {2, -2, 0}, {-2, 2, 0}, {2, 2, 0}};
  for (int i = 0; i < 5; ++i)
    landmarks[i].source = landmarks[i].target = places[i];
  const Vec3 across = Vec3(1, 1, 0).normalized();
  landmarks[0].vectors = {{across, 0.3 * across}};
  DeformationOptions options;
  options.dimension = 2;
  const Warp warp = fit_deformation(landmarks, options);
  const std::vector<Crease> creases = find_creases(warp, {Vec3(-1, -1, 0), Vec3(1, 1, 0)});
  ASSERT_FALSE(creases.empty());
  EXPECT_LT((creases[0].point - places[0]).norm(), 0.1);
  EXPECT_NEAR(creases[0].stretch, 0.3, 0.01);
  EXPECT_GT(std::abs(creases[0].direction.dot(across)), 0.99);
  EXPECT_TRUE(find_creases(Warp(), {Vec3(-1, -1, -1), Vec3(1, 1, 1)}).empty());
  EXPECT_THROW(find_creases(warp, {Vec3(1, 1, 0), Vec3(-1, 1, 0)}), Error);
}

}  // namespace
}  // namespace fascia::splines
