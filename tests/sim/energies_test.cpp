#include "sim/energies.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>

#include "sim/face_model.h"
#include "sim/formulas/activation_force.h"
#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

using Energy = std::function<double(const Vec3*, Vec3*)>;

/// Largest difference between the gradient and central differences of the energy, relative to the largest
/// entry.
double gradient_error(const Energy& energy, Positions x) {
  Positions gradient(x.size(), Vec3::Zero()), ignored(x.size(), Vec3::Zero());
  energy(x.data(), gradient.data());
  double scale = 1e-30, error = 0.0;
  for (const Vec3& g : gradient)
    scale = std::max(scale, g.cwiseAbs().maxCoeff());
  const double step = 1e-8;
  for (size_t i = 0; i < x.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const double value = x[i][axis];
      x[i][axis] = value + step;
      const double ahead = energy(x.data(), ignored.data());
      x[i][axis] = value - step;
      const double behind = energy(x.data(), ignored.data());
      x[i][axis] = value;
      error = std::max(error, std::abs((ahead - behind) / (2 * step) - gradient[i][axis]));
    }
  return error / scale;
}

Positions shaken(const Positions& rest, double size, uint32_t seed) {
  std::mt19937 random(seed);
  Positions x = rest;
  for (Vec3& p : x)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] += size * (2.0 * random() / 4294967295.0 - 1.0);
  return x;
}

const Positions six = {Vec3(0, 0, 0),     Vec3(.005, 0, 0),     Vec3(.001, .004, .001),
                       Vec3(0, 0, -.003), Vec3(.005, 0, -.003), Vec3(.001, .004, -.002)};

TEST(Energies, GradientsMatchFiniteDifferences) {
  const Membrane membrane = make_membrane({0, 1, 2}, 20.0, 0.35, six.data());
  const Positions fan = {six[0], six[1], six[2], Vec3(.002, -.004, -.001)};
  const Hinge hinge = make_hinge({0, 1, 2, 3}, 1e-4, fan.data());
  const Prism prism = make_prism({0, 1, 2, 3, 4, 5}, 2e4, six.data());
  const Spring spring{{0, 1}, 0.005, 10.0, 0.0005, 40.0, false};
  const Tether tether{2, Vec3(1, 2, 2).normalized(), 0.3, 2.0};
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    const double size = seed <= 10 ? 0.0004 : 0.002;
    const Positions x = shaken(six, size, seed), f = shaken(fan, size, seed);
    EXPECT_LT(gradient_error([&](auto p, auto g) { return membrane_energy(membrane, p, g); }, x), 1e-5);
    EXPECT_LT(gradient_error([&](auto p, auto g) { return hinge_energy(hinge, p, g); }, f), 1e-5);
    EXPECT_LT(gradient_error([&](auto p, auto g) { return prism_energy(prism, p, g); }, x), 1e-5);
    EXPECT_LT(gradient_error([&](auto p, auto g) { return spring_energy(spring, p, g); }, x), 1e-5);
    EXPECT_LT(
        gradient_error([&](auto p, auto g) { return tether_energy(tether, six[2], tether.normal, p, g); }, x),
        1e-5);
  }
}

TEST(Energies, TrianglesThatLieOnEachOtherMakeNoHinge) {
  const auto fan = [](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180.0;
    return Positions{Vec3(0, 0, 0), Vec3(.005, 0, 0), Vec3(.002, .004, 0),
                     Vec3(.002, .004 * std::cos(angle), .004 * std::sin(angle))};
  };
  const std::array<uint32_t, 4> nodes = {0, 1, 2, 3};
  EXPECT_TRUE(is_folded_shut(nodes, fan(0.0).data()));
  EXPECT_TRUE(is_folded_shut(nodes, fan(4.0).data()));
  for (const double degrees : {8.0, 20.0, 90.0, 180.0}) {
    const Positions rest = fan(degrees);
    EXPECT_FALSE(is_folded_shut(nodes, rest.data())) << degrees;
    Positions gradient(4, Vec3::Zero());
    EXPECT_LT(hinge_energy(make_hinge(nodes, 1e-4, rest.data()), rest.data(), gradient.data()), 1e-20)
        << "what is a hinge is at ease at rest";
  }
}

/// Newton per metre with which a hinge over the edge of 1 mm holds the corner of a triangle of `height`
/// metres.
double corner_stiffness(double height) {
  const Positions rest = {Vec3(0, 0, 0), Vec3(.001, 0, 0), Vec3(.0005, height, 0), Vec3(.0005, -.001, 0)};
  const Hinge hinge = make_hinge({0, 1, 2, 3}, 1e-4, rest.data());
  Positions moved = rest, gradient(4, Vec3::Zero());
  const double way = 1e-7;
  moved[2].z() += way;
  hinge_energy(hinge, moved.data(), gradient.data());
  return gradient[2].z() / way;
}

TEST(Energies, AHingeOverASliverStaysAsSoftAsOverALowTriangle) {
  // Of a plate: rigidity |edge|^2 / (areas height^2), areas of heights h and 1 mm.
  const auto plate = [](double h) { return 1e-4 * 1e-6 / (0.5e-3 * (h + 1e-3) * h * h); };
  for (const double height : {1e-3, 7e-4, 4.1e-4})
    EXPECT_NEAR(corner_stiffness(height) / plate(height), 1.0, 1e-6) << height;
  for (const double height : {2e-4, 5e-5, 1e-6, 1e-9})
    EXPECT_LT(corner_stiffness(height), 1.5 * plate(4e-4)) << height;
}

TEST(Energies, RigidMotionHasZeroEnergy) {
  const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, -1).normalized());
  const Positions fan = {six[0], six[1], six[2], Vec3(.002, -.004, -.001)};
  Positions moved, moved_fan;
  for (const Vec3& p : six)
    moved.push_back(turn * p + Vec3(.1, -.2, .3));
  for (const Vec3& p : fan)
    moved_fan.push_back(turn * p + Vec3(.1, -.2, .3));
  Positions g(6, Vec3::Zero());
  EXPECT_LT(membrane_energy(make_membrane({0, 1, 2}, 20.0, 0.35, six.data()), moved.data(), g.data()), 1e-25);
  EXPECT_LT(hinge_energy(make_hinge({0, 1, 2, 3}, 1e-4, fan.data()), moved_fan.data(), g.data()), 1e-25);
  EXPECT_LT(prism_energy(make_prism({0, 1, 2, 3, 4, 5}, 2e4, six.data()), moved.data(), g.data()), 1e-20);
}

TEST(Energies, PrismVolumeOfABoxHalf) {
  const Positions half = {Vec3(0, 0, 1), Vec3(2, 0, 1), Vec3(0, 3, 1),
                          Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 3, 0)};
  EXPECT_NEAR(prism_volume({0, 1, 2, 3, 4, 5}, half.data()), 3.0, 1e-14);
}

TEST(Energies, UniaxialStretchOfAMembraneHasYoungsModulus) {
  // Stretch along x with the side free to narrow by Poisson's ratio: energy = E h strain^2 area / 2 to first
  // order.
  const double strain = 1e-4, nu = 0.35;
  const Positions rest = {Vec3(0, 0, 0), Vec3(.01, 0, 0), Vec3(.003, .008, 0)};
  Positions x;
  for (const Vec3& p : rest)
    x.push_back(Vec3(p.x() * (1 + strain), p.y() * (1 - nu * strain), 0));
  Positions g(3, Vec3::Zero());
  const double energy = membrane_energy(make_membrane({0, 1, 2}, 20.0, nu, rest.data()), x.data(), g.data());
  EXPECT_NEAR(energy / (0.5 * 20.0 * strain * strain * 4e-5), 1.0, 1e-3);
}

TEST(Energies, BendingOntoACylinderIsAThinPlates) {
  // A sheet of equilateral triangles rolled onto a cylinder of radius r costs D / (2 r^2) an area.
  const double a = 0.002, r = 0.05, rigidity = 1e-4;
  const uint32_t n = 24;
  Positions flat, rolled;
  for (uint32_t j = 0; j <= n; ++j)
    for (uint32_t i = 0; i <= n; ++i) {
      const Vec3 p((i + 0.5 * (j % 2)) * a, j * a * std::sqrt(3.0) / 2, 0);
      flat.push_back(p);
      rolled.push_back(Vec3(r * std::sin(p.x() / r), p.y(), r * std::cos(p.x() / r) - r));
    }
  const auto at = [&](uint32_t i, uint32_t j) { return j * (n + 1) + i; };
  Positions g(flat.size(), Vec3::Zero());
  double energy = 0.0, area = 0.0;
  for (uint32_t j = 2; j + 2 < n; ++j)
    for (uint32_t i = 2; i + 2 < n; ++i) {
      const uint32_t o = j % 2;  // the three edges that leave a vertex to the right and up
      const uint32_t v = at(i, j), e = at(i + 1, j), ne = at(i + o, j + 1), nw = at(i + o - 1, j + 1);
      const uint32_t se = at(i + o, j - 1), w = at(i - 1, j);
      energy += hinge_energy(make_hinge({v, e, ne, se}, rigidity, flat.data()), rolled.data(), g.data());
      energy += hinge_energy(make_hinge({v, ne, nw, e}, rigidity, flat.data()), rolled.data(), g.data());
      energy += hinge_energy(make_hinge({v, nw, w, ne}, rigidity, flat.data()), rolled.data(), g.data());
      area += a * a * std::sqrt(3.0) / 2;
    }
  EXPECT_NEAR(energy / (rigidity / (2 * r * r) * area), 1.0, 0.01);
}

/// A patch with one of everything, and what drives it.
struct Everything {
  testing::PatchOptions options;
  rig::TissueLevel level;
  Everything() : level(testing::make_patch(options)) {
    testing::add_fibre(level, options, 0, 4, 1, 6, 0.3F);
    for (uint32_t i = 2; i < 6; ++i) {
      const uint32_t column = testing::column_at(options, i, 6);
      testing::add_carrier(level, 1, column, rig::Vec3f(0, 0, -0.02F), 0.3F, -0.3F);
      level.globe_contact_node.push_back(column);
      level.globe_contact_globe.push_back(0);
    }
    level.globe_centre.push_back(rig::Vec3f(0, 0.01F, -0.03F));
    level.globe_radius.push_back(0.029F);
    for (uint32_t c = 0; c < level.columns; ++c)  // a mouth behind the middle rows
      if (level.kinds[level.columns + c] == rig::NodeKind::free)
        level.kinds[2 * level.columns + c] = rig::NodeKind::mucosa;
    for (uint32_t t = 40; t < 60; ++t) {
      level.pressure_channel.push_back(2);
      level.pressure_prism.push_back(t);
      level.pressure.push_back(500.0F);
    }
    for (size_t i = 0; i < level.rest.size(); ++i)
      level.jaw_weights[i] = level.rest[i].y() < 0 ? std::min(1.0F, -level.rest[i].y() * 60.0F) : 0.0F;
  }
};

TEST(Energies, OfAWholeFaceHaveTheirGradientAndCurvature) {
  Everything all;
  Jaw jaw = jaw_of(rig::JawJoint{});
  jaw.origin = Vec3(0, 0.05, -0.08);
  const FaceModel model(lattice_of(all.level), jaw);
  ASSERT_TRUE(model.valid()) << model.fault();
  Frame frame = model.make_frame();
  const float activations[] = {0.8F, 0.7F, 0.9F};
  model.place({activations, {0.6F, 0.2F, -0.4F}, Vec3(1, -9, 2)}, frame);
  Positions x = shaken(frame.carried, 0.0005, 5), g(x.size()), ahead(x.size()), behind(x.size());
  for (size_t i = 0; i < x.size(); ++i)
    if (model.prescribed(i)) x[i] = frame.carried[i];
  model.energy(frame, x.data(), g.data());
  Positions v = shaken(Positions(x.size(), Vec3::Zero()), 1.0, 9), hv(x.size()), work(3 * x.size()),
            moved = x;
  double slope = 0.0, curve = 0.0, vhv = 0.0;
  for (const uint32_t i : model.unknowns())
    slope += g[i].dot(v[i]);
  const double step = 1e-9;
  for (const uint32_t i : model.unknowns())
    moved[i] = x[i] + step * v[i];
  const double up = model.energy(frame, moved.data(), ahead.data());
  for (const uint32_t i : model.unknowns())
    moved[i] = x[i] - step * v[i];
  const double down = model.energy(frame, moved.data(), behind.data());
  EXPECT_NEAR((up - down) / (2 * step) / slope, 1.0, 1e-5);
  model.hessian_times(frame, x.data(), v.data(), hv.data(), work);
  for (const uint32_t i : model.unknowns()) {
    curve += (ahead[i] - behind[i]).dot(v[i]) / (2 * step);
    vhv += hv[i].dot(v[i]);
  }
  EXPECT_NEAR(vhv / curve, 1.0, 1e-3);
}

TEST(Energies, RestFactorSolvesItsMatrix) {
  Everything all;
  const FaceModel model(lattice_of(all.level), {});
  ASSERT_TRUE(model.valid());
  const size_t n = model.unknowns().size();
  Positions x = shaken(Positions(n, Vec3::Zero()), 1.0, 3), scratch(n), b(n, Vec3::Zero());
  for (size_t i = 0; i < n; ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(model.stiffness(),
                                                                       static_cast<int>(i));
         e; ++e)
      b[i] += e.value() * x[static_cast<size_t>(e.col())];
  model.pose_factor().solve(b, scratch);
  double error = 0.0;
  for (size_t i = 0; i < n; ++i)
    error = std::max(error, (b[i] - x[i]).norm());
  EXPECT_LT(error, 1e-3);
}

TEST(Lattice, FaultsAreReported) {
  rig::TissueLevel level = testing::make_patch({});
  EXPECT_EQ(lattice_fault(lattice_of(level)), nullptr);
  level.rest[3].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_STREQ(lattice_fault(lattice_of(level)), "a rest position is not finite");
  level = testing::make_patch({});
  level.triangles[0][1] = level.columns;
  EXPECT_FALSE(FaceModel(lattice_of(level), {}).valid());
  level = testing::make_patch({});
  level.spring_stiffness.pop_back();
  EXPECT_FALSE(FaceModel(lattice_of(level), {}).valid());
}

TEST(ActivationForce, RisesFromZeroToTheMaximum) {
  for (const double initial : {0.2, 0.45, 1.0}) {
    const auto force = [initial](double a) { return formulas::activation_force(a, initial); };
    EXPECT_EQ(force(0.0), 0.0);
    EXPECT_DOUBLE_EQ(force(1.0), 1.0);
    EXPECT_EQ(formulas::activation_force_slope(0.0, initial), initial);
    for (double a = 0.0; a < 1.0; a += 0.1) {
      EXPECT_LT(force(a), force(a + 0.1));
      EXPECT_NEAR(formulas::activation_force_slope(a, initial), (force(a + 1e-6) - force(a - 1e-6)) / 2e-6,
                  1e-8);
    }
  }
}

}  // namespace
}  // namespace fascia::sim
