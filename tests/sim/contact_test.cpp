#include "sim/contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/reference_solver.h"
#include "tests/sim/patch.h"

namespace fascia::sim {
namespace {

using testing::column_at;
using testing::make_patch;
using testing::PatchOptions;

/// The field of a ball of `radius` about `centre`, on a grid of millimetres.
void add_ball(rig::TissueLevel& level, uint8_t bone, const Vec3& centre, double radius) {
  const double spacing = 0.001, reach = 0.02;
  level.contact_field_bone.push_back(bone);
  level.contact_field_origin.push_back((centre - Vec3::Constant(reach)).cast<float>());
  level.contact_field_spacing.push_back(static_cast<float>(spacing));
  level.contact_field_step.push_back(1e-4F);
  level.contact_field_size.push_back({41, 41, 41});
  for (int k = 0; k <= 40; ++k)
    for (int j = 0; j <= 40; ++j)
      for (int i = 0; i <= 40; ++i) {
        const double distance = (spacing * Vec3(i - 20, j - 20, k - 20)).norm() - radius;
        level.contact_field_values.push_back(
            static_cast<uint8_t>(std::clamp(std::round(128 + distance / 1e-4), 0.0, 255.0)));
      }
}

/// A patch whose inner layer is free mucosa, with a ball behind it.
rig::TissueLevel patch_before_a_ball(const PatchOptions& o, uint8_t bone) {
  rig::TissueLevel level = make_patch(o);
  for (uint32_t c = 0; c < level.columns; ++c) {
    const uint32_t inner = 2 * level.columns + c;
    if (level.kinds[level.columns + c] == rig::NodeKind::free) level.kinds[inner] = rig::NodeKind::mucosa;
    level.contact_node.push_back(inner);
    level.contact_field.push_back(0);
  }
  add_ball(level, bone, Vec3(0, 0, -0.019), 0.010);
  return level;
}

TEST(Contact, SteepnessBoundsTheSlopeOfAField) {
  rig::TissueLevel level = patch_before_a_ball({}, 0);
  EXPECT_LT(DistanceField(lattice_of(level), 0).steepness(), 1.8) << "a sound one";
  for (size_t i = 0; i < level.contact_field_values.size(); ++i)  // torn by a sheet of no thickness
    if (i / 1681 > 14) level.contact_field_values[i] = 255;
  const DistanceField field(lattice_of(level), 0);
  double steepest = 0.0;
  Vec3 ignored;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 p(0.004 * std::sin(1.0 * i), 0.004 * std::sin(1.7 * i), -0.024 + 0.003 * std::sin(2.3 * i));
    const Vec3 q = p + 2e-5 * Vec3(std::sin(3.1 * i), std::sin(4.3 * i), std::sin(5.9 * i));
    steepest =
        std::max(steepest, std::abs(field.sample(p, ignored) - field.sample(q, ignored)) / (p - q).norm());
  }
  EXPECT_LE(steepest, field.steepness());
  EXPECT_GT(steepest, 5.0) << "the field tried is steep";
}

TEST(Contact, AFieldGivesDistanceAndSlope) {
  PatchOptions o;
  const rig::TissueLevel level = patch_before_a_ball(o, 0);
  const DistanceField field(lattice_of(level), 0);
  for (const Vec3& p :
       {Vec3(0.0043, 0.0032, -0.0077), Vec3(-0.0058, 0.0023, -0.0126), Vec3(0.0014, -0.0067, -0.0119)}) {
    Vec3 gradient;
    const double distance = field.sample(p, gradient);
    const Vec3 arm = p - Vec3(0, 0, -0.019);
    EXPECT_NEAR(distance, arm.norm() - 0.010, 2e-4);
    EXPECT_LT((gradient - arm.normalized()).norm(), 0.2);
    for (int axis = 0; axis < 3; ++axis) {  // the slope is the interpolant's own
      Vec3 ignored, ahead = p, behind = p;
      ahead[axis] += 1e-8;
      behind[axis] -= 1e-8;
      EXPECT_NEAR((field.sample(ahead, ignored) - field.sample(behind, ignored)) / 2e-8, gradient[axis],
                  1e-5);
    }
  }
  Vec3 ignored;
  const double beyond = field.sample(Vec3(1, 0, 0), ignored);  // past the grid it goes on as it ends
  EXPECT_GT(beyond, 0.0);
  EXPECT_EQ(ignored.x(), 0.0);
}

TEST(Contact, PressedTissueStopsAtTheBone) {
  PatchOptions o;
  const rig::TissueLevel level = patch_before_a_ball(o, 0);
  const FaceModel model(lattice_of(level), {});
  ASSERT_TRUE(model.valid()) << model.fault();
  ReferenceSolver face(model, 0);
  std::vector<Vec3f> x(level.rest.size());
  const Controls press{{}, {}, Vec3(0, 0, -100.0)};
  EXPECT_TRUE(face.static_pose(press, {}, x).converged);
  // Without the ball its place would be entered by a millimetre and more.
  rig::TissueLevel alone = level;
  alone.contact_node.clear();
  alone.contact_field.clear();
  const FaceModel free_model(lattice_of(alone), {});
  ReferenceSolver free_face(free_model, 0);
  std::vector<Vec3f> y(level.rest.size());
  free_face.static_pose(press, {}, y);
  double with = 0.0, without = 0.0;
  for (uint32_t c = 0; c < level.columns; ++c) {
    const auto depth = [&](const std::vector<Vec3f>& all) {
      return 0.010 - (all[2 * level.columns + c].cast<double>() - Vec3(0, 0, -0.019)).norm();
    };
    with = std::max(with, depth(x));
    without = std::max(without, depth(y));
  }
  EXPECT_GT(without, 5e-4);
  EXPECT_LT(with, 0.4 * without);
  EXPECT_LT(with, 4e-4);
}

TEST(Contact, AFieldMovesWithItsBone) {
  PatchOptions o;
  const rig::TissueLevel level = patch_before_a_ball(o, 1);  // on the mandible
  Jaw jaw = jaw_of(rig::JawJoint{});
  jaw.forward_glide = 0.004;
  jaw.forward_drop = 0.0;
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 0);
  std::vector<Vec3f> x(level.rest.size());
  EXPECT_TRUE(face.static_pose({{}, {0, 1, 0}, Vec3::Zero()}, {}, x).converged);
  const uint32_t middle = 2 * level.columns + column_at(o, 4, 4);
  EXPECT_GT(x[middle].z() - level.rest[middle].z(), 0.002F);  // pushed out by the ball that came forward
}

/// Two strips of skin, one over the other, their outer sides facing: lips. Gap of 1 mm; side 0 above.
struct TwoLips : ::testing::Test {
  PatchOptions o;
  rig::TissueLevel level;
  uint32_t half = 0;
  TwoLips() {
    o.across = 8;
    o.along = 4;
    rig::TissueLevel below = make_patch(o);
    half = below.columns;
    level = below;
    const uint32_t columns = 2 * half;
    level.columns = columns;
    level.rest.assign(3 * columns, rig::Vec3f::Zero());
    level.kinds.assign(3 * columns, rig::NodeKind::free);
    level.masses.assign(3 * columns, 5e-5F);
    level.jaw_weights.assign(3 * columns, 0.0F);
    for (uint32_t layer = 0; layer < 3; ++layer)
      for (uint32_t c = 0; c < half; ++c) {
        const rig::Vec3f p = below.rest[layer * half + c];
        level.rest[layer * columns + c] = p;
        level.rest[layer * columns + half + c] = rig::Vec3f(p.x() + 0.0011F, p.y() - 0.0007F, 0.001F - p.z());
        for (const uint32_t at : {c, half + c})
          level.kinds[layer * columns + at] = below.kinds[layer * half + c];
        level.jaw_weights[layer * columns + c] = 1.0F;  // the lower one goes with the jaw
        if (level.kinds[layer * columns + c] == rig::NodeKind::fixed)
          level.kinds[layer * columns + c] = rig::NodeKind::fixed_mandible;
        if (level.kinds[layer * columns + c] == rig::NodeKind::fixed_cranium)
          level.kinds[layer * columns + c] = rig::NodeKind::fixed_mandible;
      }
    const size_t prisms = below.triangles.size();
    for (size_t t = 0; t < prisms; ++t) {
      const auto& k = below.triangles[t];
      level.triangles.push_back({half + k[0], half + k[2], half + k[1]});
    }
    for (auto* list :
         {&level.skin_membrane, &level.smas_membrane, &level.volume_stiffness, &level.inner_volume_stiffness})
      list->resize(2 * prisms, list->front());
    for (auto* list : {&level.skin_bending, &level.smas_bending})
      list->resize(columns, list->front());
    const auto shifted = [&](uint32_t node, bool upper) {
      return (node / half) * columns + node % half + (upper ? half : 0);
    };
    level.spring_nodes.clear();
    for (const bool upper : {false, true})
      for (const auto& s : below.spring_nodes)
        level.spring_nodes.push_back({shifted(s[0], upper), shifted(s[1], upper)});
    for (auto* list : {&level.spring_stiffness, &level.spring_limit_strain, &level.spring_second_stiffness})
      list->resize(2 * below.spring_nodes.size(), list->front());
    level.spring_one_sided.assign(2 * below.spring_nodes.size(), 0);
    level.tether_nodes.clear();
    for (const bool upper : {false, true})
      for (const uint32_t t : below.tether_nodes)
        level.tether_nodes.push_back(shifted(t, upper));
    level.tether_normals.resize(2 * below.tether_nodes.size(), rig::Vec3f::UnitZ());
    for (auto* list : {&level.tether_normal_stiffness, &level.tether_tangential_stiffness})
      list->resize(2 * below.tether_nodes.size(), list->front());
    for (uint32_t t = 0; t < 2 * prisms; ++t) {
      level.facing_prism.push_back(t);
      level.facing_side.push_back(t < prisms ? 1 : 0);
    }
    jaw.forward_glide = 0.004;
    jaw.forward_drop = 0.0;
  }
  Jaw jaw = jaw_of(rig::JawJoint{});
  /// The smallest gap between the two over the lower one's middle nodes, by the upper one's height beside
  /// them.
  double smallest_gap(const std::vector<Vec3f>& x) const {
    double gap = 1e9;
    for (uint32_t j = 1; j < o.along; ++j)
      for (uint32_t i = 1; i < o.across; ++i) {
        const Vec3f& p = x[column_at(o, i, j)];
        double nearest = 1e9, height = 0.0;
        for (uint32_t c = 0; c < half; ++c) {
          const Vec3f& q = x[half + c];
          const double d = (q - p).head<2>().norm();
          if (d < nearest) {
            nearest = d;
            height = q.z() - p.z();
          }
        }
        gap = std::min(gap, height);
      }
    return gap;
  }
};

TEST_F(TwoLips, DoNotPassThroughEachOther) {
  const FaceModel model(lattice_of(level), jaw);
  ASSERT_TRUE(model.valid()) << model.fault();
  ReferenceSolver face(model, 0);
  std::vector<Vec3f> x(level.rest.size());
  // The lower one is carried 4 mm up through a gap of one.
  EXPECT_TRUE(face.static_pose({{}, {0, 1, 0}, Vec3::Zero()}, {}, x).converged);
  EXPECT_GT(smallest_gap(x), -3e-4);
  rig::TissueLevel alone = level;
  alone.facing_prism.clear();
  alone.facing_side.clear();
  const FaceModel free_model(lattice_of(alone), jaw);
  ReferenceSolver free_face(free_model, 0);
  free_face.static_pose({{}, {0, 1, 0}, Vec3::Zero()}, {}, x);
  EXPECT_LT(smallest_gap(x), -2e-3);
}

TEST_F(TwoLips, DoNotPassThroughEachOtherInTimeEither) {
  const FaceModel model(lattice_of(level), jaw);
  ReferenceSolver face(model, 0);
  std::vector<Vec3f> x(level.rest.size());
  for (int frame = 0; frame < 30; ++frame) {
    ASSERT_EQ(
        face.step(1.0 / 60, {{}, {0, std::min(1.0F, 0.2F * static_cast<float>(frame)), 0}, Vec3::Zero()})
            .status,
        StepStatus::done);
    face.positions(x);
    EXPECT_GT(smallest_gap(x), -5e-4) << frame;
  }
}

TEST_F(TwoLips, StickyOnesPartLater) {
  double gap[2];
  for (int sticky = 0; sticky < 2; ++sticky) {
    FaceModelOptions options;
    options.contact.stickiness = sticky;
    const FaceModel model(lattice_of(level), jaw, options);
    ReferenceSolver face(model, 0);
    for (int frame = 0; frame < 15; ++frame)
      face.step(1.0 / 60, {{}, {0, 0.4F, 0}, Vec3::Zero()});
    for (int frame = 0; frame < 20; ++frame)
      face.step(1.0 / 60, {{}, {}, Vec3::Zero()});
    std::vector<Vec3f> x(level.rest.size());
    face.positions(x);
    gap[sticky] = x[half + column_at(o, 4, 2)].z() - x[column_at(o, 4, 2)].z();
  }
  EXPECT_LT(gap[1], 0.7 * gap[0]);
  EXPECT_GT(gap[1], -3e-4);
}

/// A node on a flat bone, pressed by gravity at an angle: it slides where the slope is steeper than friction,
/// else it stays.
TEST(Contact, FrictionHoldsUntilCoulombsLimit) {
  for (const double slope : {0.15, 0.9}) {
    PatchOptions o;
    rig::TissueLevel level = patch_before_a_ball(o, 0);
    level.contact_field_values.clear();
    for (int k = 0; k <= 40; ++k)  // a plane: the ball's field replaced by height above z = -0.0085
      for (int j = 0; j <= 40; ++j)
        for (int i = 0; i <= 40; ++i) {
          const double z = -0.019 - 0.02 + 0.001 * k;
          level.contact_field_values.push_back(
              static_cast<uint8_t>(std::clamp(std::round(128 + (z + 0.0085) / 1e-4), 0.0, 255.0)));
        }
    double slid[2];
    for (int rough = 0; rough < 2; ++rough) {
      FaceModelOptions options;
      options.contact.friction = rough * 0.5;
      const FaceModel model(lattice_of(level), {}, options);
      ReferenceSolver face(model, 0);
      for (int i = 0; i < 15; ++i)
        face.step(1.0 / 60, {{}, {}, Vec3(0, 0, -150)});
      const uint32_t middle = 2 * level.columns + column_at(o, 4, 4);
      const double before = face.state()[middle].x();
      for (int i = 0; i < 8; ++i)
        face.step(1.0 / 60, {{}, {}, Vec3(150 * slope, 0, -150)});
      slid[rough] = face.state()[middle].x() - before;
    }
    EXPECT_GT(slid[0], 1e-5);
    if (slope < 0.5)
      EXPECT_LT(slid[1], 0.6 * slid[0]);
    else
      EXPECT_LT(slid[1], slid[0]);
  }
}

}  // namespace
}  // namespace fascia::sim
