// The stand-in for the Hessian that Newton steps use: exact where no curvature is negative, never negative
// elsewhere.

#include "sim/curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>

#include "sim/reference_solver.h"
#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

using Gradient = std::function<void(const Vec3*, Vec3*)>;

Positions random_vectors(size_t count, double size, std::mt19937& random) {
  Positions v(count);
  for (Vec3& p : v)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = size * (2.0 * random() / 4294967295.0 - 1.0);
  return v;
}

/// Largest difference between curvature times a direction and central differences of the gradient, relative.
double curvature_error(const Gradient& gradient, const Curvature& curvature, const Positions& x,
                       const Positions& direction) {
  Positions ahead(x.size(), Vec3::Zero()), behind = ahead, product = ahead, there = x;
  const double step = 1e-8;
  for (size_t i = 0; i < x.size(); ++i)
    there[i] = x[i] + step * direction[i];
  gradient(there.data(), ahead.data());
  for (size_t i = 0; i < x.size(); ++i)
    there[i] = x[i] - step * direction[i];
  gradient(there.data(), behind.data());
  curvature.times(direction.data(), product.data());
  double scale = 1e-30, error = 0.0;
  for (size_t i = 0; i < x.size(); ++i) {
    scale = std::max(scale, product[i].norm());
    error = std::max(error, ((ahead[i] - behind[i]) / (2 * step) - product[i]).norm());
  }
  return error / scale;
}

const Positions six = {Vec3(0, 0, 0),     Vec3(.005, 0, 0),     Vec3(.001, .004, .001),
                       Vec3(0, 0, -.003), Vec3(.005, 0, -.003), Vec3(.001, .004, -.002)};
const Positions fan = {six[0], six[1], six[2], Vec3(.002, -.004, -.001)};

Positions scaled(const Positions& rest, double factor) {
  Positions x = rest;
  for (Vec3& p : x)
    p *= factor;
  return x;
}

TEST(CurvatureTerms, AreTheHessianWhereNothingIsCompressed) {
  std::mt19937 random(3);
  const Membrane membrane = make_membrane({0, 1, 2}, 20.0, 0.35, six.data());
  const Hinge hinge = make_hinge({0, 1, 2, 3}, 1e-4, fan.data());
  const Prism prism = make_prism({0, 1, 2, 3, 4, 5}, 2e4, six.data());
  const Spring spring{{0, 1}, 0.005, 10.0, 0.0002, 40.0, false};
  const Tether tether{2, Vec3(1, 2, 2).normalized(), 0.3, 2.0};
  for (int k = 0; k < 10; ++k) {
    const Positions v = random_vectors(6, 1.0, random), stretched = scaled(six, 1.03 + 0.025 * k);
    Curvature c;
    add_membrane(membrane, stretched.data(), c);
    EXPECT_LT(curvature_error([&](auto p, auto g) { membrane_energy(membrane, p, g); }, c, stretched, v),
              1e-5);
    c.clear();
    add_spring(spring, stretched.data(), c);
    EXPECT_LT(curvature_error([&](auto p, auto g) { spring_energy(spring, p, g); }, c, stretched, v), 1e-5);
    c.clear();
    add_hinge(hinge, fan.data(), c);
    EXPECT_LT(curvature_error([&](auto p, auto g) { hinge_energy(hinge, p, g); }, c, fan, v), 1e-5);
    c.clear();
    add_prism(prism, six.data(), c);
    EXPECT_LT(curvature_error([&](auto p, auto g) { prism_energy(prism, p, g); }, c, six, v), 1e-5);
    c.clear();
    add_tether(tether, tether.normal, c);
    EXPECT_LT(curvature_error([&](auto p, auto g) { tether_energy(tether, six[2], tether.normal, p, g); }, c,
                              stretched, v),
              1e-5);
  }
}

TEST(CurvatureTerms, CrushedTrianglesAreExactToo) {
  std::mt19937 random(5);
  const Membrane membrane = make_membrane({0, 1, 2}, 20.0, 0.35, six.data());
  // Shortened one way and drawn out the other, to 0.475 of its area: all modes in its plane are positive
  // there.
  Positions x = six;
  for (Vec3& p : x)
    p = Vec3(0.25 * p.x(), 1.9 * p.y(), 1.9 * p.z());
  Positions v = random_vectors(6, 1.0, random);
  const Vec3 normal = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
  for (Vec3& p : v)
    p -= normal.dot(p) * normal;
  Curvature c;
  add_membrane(membrane, x.data(), c);
  EXPECT_LT(curvature_error(
                [&](auto p, auto g) {
                  membrane_energy(membrane, p, g);
                  for (size_t i = 0; i < 6; ++i)
                    g[i] -= normal.dot(g[i]) * normal;
                },
                c, x, v),
            1e-4);
}

TEST(CurvatureTerms, AreNeverNegative) {
  std::mt19937 random(11);
  const Membrane membrane = make_membrane({0, 1, 2}, 20.0, 0.35, six.data());
  const Hinge hinge = make_hinge({0, 1, 2, 3}, 1e-4, fan.data());
  const Prism prism = make_prism({0, 1, 2, 3, 4, 5}, 2e4, six.data());
  const Spring spring{{0, 1}, 0.005, 10.0, 0.0002, 40.0, false};
  for (int k = 0; k < 200; ++k) {
    Positions x = random_vectors(6, 0.004, random);
    const Positions v = random_vectors(6, 1.0, random);
    Curvature c;
    add_membrane(membrane, x.data(), c);
    add_hinge(hinge, x.data(), c);
    add_prism(prism, x.data(), c);
    add_spring(spring, x.data(), c);
    Positions product(6, Vec3::Zero());
    c.times(v.data(), product.data());
    double sum = 0.0, size = 0.0;
    for (size_t i = 0; i < 6; ++i) {
      sum += v[i].dot(product[i]);
      size += product[i].norm();
    }
    EXPECT_GT(sum, -1e-9 * size);
  }
}

/// Newton steps from where three quasi-Newton steps have come end where a long quasi-Newton solve does.
TEST(Newton, FindsThePoseThatQuasiNewtonFinds) {
  testing::PatchOptions o;
  o.across = 10;
  rig::TissueLevel level = testing::make_patch(o);
  testing::add_fibre(level, o, 0, 4, 1, 6, 0.2F);
  const FaceModel model(lattice_of(level), {});
  ASSERT_TRUE(model.valid()) << model.fault();
  const float full[] = {1.0F};
  ReferenceSolver face(model, 1);
  std::vector<Vec3f> slow(level.rest.size()), quick(slow);
  PoseOptions only_first, mostly_newton;
  only_first.solver = {2000, 1e-7};
  only_first.newton.iterations = 0;
  mostly_newton.solver = {3, 1e-7};
  const MinimiseResult first = face.static_pose({full, {}, Vec3::Zero()}, only_first, slow);
  ASSERT_TRUE(first.converged);
  EXPECT_GT(first.iterations, 8);
  ASSERT_TRUE(face.static_pose({full, {}, Vec3::Zero()}, mostly_newton, quick).converged);
  for (size_t i = 0; i < slow.size(); ++i)
    EXPECT_LT((slow[i] - quick[i]).norm(), 2e-6F);
}

}  // namespace
}  // namespace fascia::sim
