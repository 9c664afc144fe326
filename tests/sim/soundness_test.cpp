#include <gtest/gtest.h>

#include <limits>

#include "sim/realtime/solver.h"
#include "tests/sim/patch.h"

// A rig may hold any numbers. Whatever they are, a model is either refused with a reason, or its faces stay
// finite.
namespace fascia::sim {
namespace {

using testing::column_at;
using testing::make_patch;
using testing::PatchOptions;

struct Patch {
  rig::TissueLevel level;
  Jaw jaw = jaw_of(rig::JawJoint{});
  Patch() {
    PatchOptions options;
    options.across = 6;
    options.along = 5;
    level = make_patch(options);
    testing::add_fibre(level, options, 0, 3, 1, 5, 0.4F);
    const uint32_t middle = column_at(options, 3, 3);
    testing::add_carrier(level, 1, middle, level.rest[middle] - rig::Vec3f(0, 0, 0.012F), 0.5F, 0.3F);
    level.pressure_channel = {2};
    level.pressure_prism = {20};
    level.pressure = {300.0F};
    level.globe_centre = {level.rest[middle] - rig::Vec3f(0, 0, 0.011F)};
    level.globe_radius = {0.010F};
    level.globe_contact_node = {middle};
    level.globe_contact_globe = {0};
    level.contact_field_bone = {0};
    level.contact_field_origin = {rig::Vec3f(-0.02F, -0.02F, -0.05F)};
    level.contact_field_spacing = {0.005F};
    level.contact_field_step = {0.0005F};
    level.contact_field_size = {{8, 8, 8}};
    level.contact_field_values.assign(512, 140);
    level.contact_node = {middle, middle + 1};
    level.contact_field = {0, 0};
    for (size_t i = 0; i < level.jaw_weights.size(); i += 3)
      level.jaw_weights[i] = 0.5F;
  }

  std::vector<std::vector<float>*> numbers() {
    return {&level.masses,
            &level.jaw_weights,
            &level.spring_stiffness,
            &level.spring_limit_strain,
            &level.spring_second_stiffness,
            &level.skin_membrane,
            &level.smas_membrane,
            &level.skin_bending,
            &level.smas_bending,
            &level.tether_normal_stiffness,
            &level.tether_tangential_stiffness,
            &level.volume_stiffness,
            &level.inner_volume_stiffness,
            &level.fibre_taper,
            &level.fibre_strength,
            &level.fibre_shortest,
            &level.carrier_angle,
            &level.carrier_reverse,
            &level.carrier_stiffness,
            &level.carrier_drive,
            &level.pressure,
            &level.globe_radius,
            &level.contact_field_spacing,
            &level.contact_field_step};
  }
  std::vector<std::vector<rig::Vec3f>*> vectors() {
    return {&level.rest,           &level.tether_normals, &level.fibre_weights, &level.fibre_rest,
            &level.carrier_origin, &level.carrier_axis,   &level.globe_centre,  &level.contact_field_origin};
  }
};

/// What becomes of the patch: refused, or finite after a pose and some steps.
bool comes_to_no_harm(const Patch& patch) {
  const FaceModel face(lattice_of(patch.level), patch.jaw);
  if (!face.valid()) return true;
  const realtime::Model model(face);
  if (!model.valid()) return true;
  realtime::Solver quick(model, 3);
  ReferenceSolver reference(face, 3);
  const std::vector<float> pull = {0.7F, 0.5F, 0.3F};
  std::vector<Vec3f> moved(patch.level.rest.size());
  const auto is_finite = [&] {
    for (const Vec3f& d : moved)
      if (!d.allFinite()) return false;
    return true;
  };
  PoseOptions few;
  few.solver.iterations = 20;
  few.newton.iterations = 2;
  quick.static_pose({pull, {0.3F, 0, 0}}, few, moved);
  bool all = is_finite();
  reference.static_pose({pull, {0.3F, 0, 0}}, few, moved);
  all = all && is_finite();
  for (int frame = 0; frame < 5; ++frame) {
    quick.step(1.0 / 60.0, {pull, {0.3F, 0, 0}});
    quick.displacements(moved);
    all = all && is_finite();
  }
  return all;
}

const float absurd[] = {std::numeric_limits<float>::quiet_NaN(),
                        std::numeric_limits<float>::infinity(),
                        1e38F,
                        1e10F,
                        1e6F,
                        1e-6F,
                        1e-30F,
                        0.0F,
                        -1.0F,
                        -1e38F};

TEST(Soundness, ThePatchItselfIsSound) {
  const Patch patch;
  EXPECT_EQ(realtime::model_fault(lattice_of(patch.level), patch.jaw), "");
  EXPECT_TRUE(comes_to_no_harm(patch));
}

TEST(Soundness, ExtremeValuesAreRejectedOrHandled) {
  const size_t lists = Patch().numbers().size();
  for (size_t i = 0; i < lists; ++i)
    for (const float value : absurd)
      for (const bool everywhere : {true, false}) {
        Patch patch;
        std::vector<float>& list = *patch.numbers()[i];
        if (everywhere)
          std::fill(list.begin(), list.end(), value);
        else
          list[list.size() / 2] = value;
        EXPECT_TRUE(comes_to_no_harm(patch))
            << "list " << i << " with " << value << (everywhere ? " everywhere" : "");
      }
}

TEST(Soundness, ExtremePositionsAreRejectedOrHandled) {
  const size_t lists = Patch().vectors().size();
  for (size_t i = 0; i < lists; ++i)
    for (const float value : absurd)
      for (const bool everywhere : {true, false}) {
        Patch patch;
        std::vector<rig::Vec3f>& list = *patch.vectors()[i];
        for (size_t k = everywhere ? 0 : list.size() / 2;
             k < (everywhere ? list.size() : list.size() / 2 + 1); ++k)
          list[k].y() = value;
        EXPECT_TRUE(comes_to_no_harm(patch))
            << "list " << i << " with " << value << (everywhere ? " everywhere" : "");
      }
}

TEST(Soundness, ALatticeFarFromTheOriginIsRefusedBySayingSo) {
  Patch patch;
  for (rig::Vec3f& place : patch.level.rest)
    place.x() += 2e4F;
  EXPECT_NE(realtime::model_fault(lattice_of(patch.level), patch.jaw).find("kilometre"), std::string::npos);
}

TEST(Soundness, AnInvalidJawIsRejected) {
  const Patch patch;
  for (int fault = 0; fault < 4; ++fault) {
    Jaw jaw = jaw_of(rig::JawJoint{});
    if (fault == 0) jaw.open_angle = 40.0;
    if (fault == 1) jaw.lateral = Vec3(1e20, 0, 0);
    if (fault == 2) jaw.up = jaw.forward;
    if (fault == 3) jaw.open_glide.y() = NAN;
    EXPECT_NE(jaw_fault(jaw), nullptr) << fault;
    EXPECT_FALSE(FaceModel(lattice_of(patch.level), jaw).valid());
  }
}

TEST(Soundness, AMatrixWithoutAFactorLeavesAnEmptyOne) {
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(40, 40);
  matrix.setIdentity();
  Positions places(40);
  for (size_t i = 0; i < places.size(); ++i)
    places[i] = Vec3(static_cast<double>(i), 0, 0);
  const realtime::Dissection dissection(matrix, places);
  realtime::PanelFactor factor;
  EXPECT_TRUE(factor.compute(dissection, matrix));
  EXPECT_GT(factor.entries(), 0U);
  matrix.coeffRef(30, 30) = -1.0;
  EXPECT_FALSE(factor.compute(dissection, matrix));
  EXPECT_EQ(factor.entries(), 0U);
  EXPECT_EQ(factor.view().fronts, 0U);
}

}  // namespace
}  // namespace fascia::sim
