#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/builder/posed_face.h"

namespace fascia::testing {

/// What holds of the muscles of every head as they lie at rest.
inline void expect_muscles_are_sound(const rigging::BuildReport& report) {
  EXPECT_EQ(report.muscles.size(), 108u);
  for (const auto& muscle : report.muscles) {
    EXPECT_EQ(muscle.crossings, 0) << muscle.name;
    EXPECT_GE(muscle.fibres, 3) << muscle.name;
    EXPECT_GT(muscle.shortest_mm, 2.0) << muscle.name;
    EXPECT_LE(muscle.longest_mm, 3.0 * muscle.shortest_mm) << muscle.name << ": a fibre goes astray";
    EXPECT_GT(muscle.area_mm2, 5.0) << muscle.name;
    EXPECT_NEAR(muscle.thickness_mm * muscle.area_mm2, muscle.volume_mm3, 1e-6 * muscle.volume_mm3)
        << muscle.name;
    EXPECT_LT(muscle.origin_distance_mm, 8.0) << muscle.name;
    EXPECT_LT(muscle.insertion_distance_mm, 8.0) << muscle.name;
  }
  ASSERT_EQ(report.modioli.size(), 2u);
  for (const auto& node : report.modioli) {
    const std::string side = node.name.substr(node.name.rfind('_'));
    // The seven: rings of both lips, buccinator, zygomaticus major, levator and depressor anguli oris,
    // risorius, platysma.
    for (const char* muscle : {"orbicularis_oris_marginal_upper", "orbicularis_oris_peripheral_lower",
                               "buccinator_upper", "zygomaticus_major_superior", "levator_anguli_oris",
                               "depressor_anguli_oris", "risorius", "platysma_modiolar"})
      EXPECT_NE(std::find(node.muscles.begin(), node.muscles.end(), muscle + side), node.muscles.end())
          << muscle << side;
    EXPECT_LT(node.radius_mm, 8.0) << node.name;
  }
}

/// What any adult face must do, in millimetres.
inline void expect_face_moves_as_anatomy_says(PosedFace& face) {
  EXPECT_EQ(face.report().bone_outside_skin, 0);
  EXPECT_EQ(face.report().smas_outside_layers, 0);

  face.pose({});
  EXPECT_EQ(face.largest_motion(), 0.0) << "zero activation moves something";

  face.pose({{"zygomaticus_major_left", 1}, {"zygomaticus_major_right", 1}});
  for (const char* side : {"left", "right"}) {
    const double outward = std::string(side) == "left" ? 1.0 : -1.0;
    const Vec3 corner = face.moved(std::string("cheilion_") + side);
    EXPECT_GT(corner.norm(), 5.0) << side;
    EXPECT_LT(corner.norm(), 14.0) << side;
    EXPECT_GT(corner[1], 1.5) << side << " corner goes up";
    EXPECT_GT(outward * corner[0], 1.5) << side << " corner goes outward";
  }

  face.pose({{"frontalis_left", 1}, {"frontalis_right", 1}});
  EXPECT_GE(face.moved("superciliare_left")[1], 4.0);
  EXPECT_GE(face.moved("superciliare_right")[1], 4.0);

  face.pose({{"corrugator_supercilii_left", 1}, {"corrugator_supercilii_right", 1}});
  EXPECT_LT(face.moved("superciliare_mediale_left")[0], -0.8) << "brows draw together";
  EXPECT_GT(face.moved("superciliare_mediale_right")[0], 0.8);

  face.pose({{"jaw_open", 1}});
  EXPECT_GE(face.moved("labiale_superius")[1] - face.moved("labiale_inferius")[1], 25.0) << "the lips part";
  EXPECT_LT(face.moved("labiale_superius").norm(), 3.5) << "the upper lip stays";
  EXPECT_GT(face.moved("buccale_left").norm(), 2.0) << "the cheeks follow";
  EXPECT_LT(face.moved("buccale_left").norm(), 30.0);

  const auto lips_apart = [&] {
    return (face.moved("labiale_superius") - face.moved("labiale_inferius")).norm();
  };
  face.pose({{"jaw_open", 0.5}});
  const double open = lips_apart();
  face.pose({{"jaw_open", 0.5}, {"lip_seal_left", 1}, {"lip_seal_right", 1}});
  EXPECT_LT(lips_apart(), 0.5 * open) << "sealed lips stay together before an open jaw";

  face.pose({{"levator_palpebrae_superioris_left", 1}, {"levator_palpebrae_superioris_right", 1}});
  for (const char* lid : {"palpebrale_superius_left", "palpebrale_superius_right"}) {
    EXPECT_GT(face.moved(lid)[1], 0.5) << lid;
    EXPECT_LT(face.moved(lid)[1], 5.0) << lid;
  }

  face.pose({{"lid_upper_left", 1}, {"lid_upper_right", 1}});
  const double left_lid = -face.moved("palpebrale_superius_left")[1],
               right_lid = -face.moved("palpebrale_superius_right")[1];
  EXPECT_GT(left_lid, 6.0) << "the eye closes";
  EXPECT_NEAR(left_lid, right_lid, 0.2 * left_lid) << "one eye as the other";

  face.pose({{"buccal_pressure_left", 1}, {"buccal_pressure_right", 1}});
  EXPECT_GT(face.moved("buccale_left")[0], 3.0) << "the cheek fills";
  EXPECT_LT(face.moved("buccale_right")[0], -3.0);

  face.pose({{"lip_roll_upper_left", 1}, {"lip_roll_upper_right", 1}});
  EXPECT_LT(face.moved("labiale_superius")[2], -1.0) << "the lip rolls in";
  EXPECT_LT(face.moved("labiale_superius").norm(), 9.0);
  EXPECT_LT(face.moved("alare_left").norm(), 1.5) << "the nostrils stay";

  face.pose({{"depressor_anguli_oris_left", 1}});
  EXPECT_LT(face.moved("cheilion_left")[1], -2.0) << "the corner goes down";

  face.pose({{"zygomaticus_major_left", 1}});
  EXPECT_GT(face.moved("cheilion_left").norm(), 4.0);
  EXPECT_LT(face.moved("cheilion_right").norm(), 1.0) << "one side stays one side";
  EXPECT_LT(face.largest_skin_motion_right_of(-20.0), 2.0);  // lips hang together; the corner beyond stays
}

}  // namespace fascia::testing
