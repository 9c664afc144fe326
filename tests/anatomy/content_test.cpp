#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "anatomy/anatomy.h"
#include "geometry/error.h"

namespace fascia::anatomy {
namespace {

const GenericAnatomy& generic() {
  static const GenericAnatomy anatomy = load_generic();
  return anatomy;
}

Vec3 mirror(const Vec3& p) {
  return Vec3(-p.x(), p.y(), p.z());
}

std::string other_side(std::string name) {
  return name.replace(name.size() - 5, 5, "_right");
}

TEST(Landmarks, AllCraniometricPointsWithDepths) {
  // Every landmark of the default table stands on the face.
  for (const TissueDepth& depth : generic().depth_tables.front().depths) {
    bool found = false;
    for (const Landmark& landmark : generic().landmarks)
      found = found || landmark.depth == depth.key;
    EXPECT_TRUE(found) << depth.key;
  }
  EXPECT_EQ(generic().depth_tables.front().depths.size(), 25U);
}

TEST(Landmarks, BoneLiesTheTabledDepthUnderTheSkin) {
  const TissueDepthTable& table = generic().depth_tables.front();
  int checked = 0;
  for (const Landmark& landmark : generic().landmarks) {
    if (!landmark.bone_from_depth) continue;
    ++checked;
    const double depth = table.find(landmark.depth)->mean;
    EXPECT_LT((*landmark.skin - depth * landmark.normal - *landmark.bone).norm(), 2e-6) << landmark.name;
  }
  EXPECT_EQ(checked, 34);
}

TEST(Landmarks, ExactlySymmetricAndUnitNormals) {
  int pairs = 0;
  for (const Landmark& left : generic().landmarks) {
    if (left.skin) {
      EXPECT_NEAR(left.normal.norm(), 1.0, 1e-12) << left.name;
    }
    if (left.side == Side::midline) {
      if (left.skin) {
        EXPECT_EQ(left.skin->x(), 0.0) << left.name;
      }
      if (left.bone) {
        EXPECT_EQ(left.bone->x(), 0.0) << left.name;
      }
    }
    if (left.side != Side::left) continue;
    ++pairs;
    const Landmark* right = generic().landmark(other_side(left.name));
    ASSERT_NE(right, nullptr) << left.name;
    if (left.skin) {
      EXPECT_EQ(mirror(*left.skin), *right->skin) << left.name;
    }
    if (left.bone) {
      EXPECT_EQ(mirror(*left.bone), *right->bone) << left.name;
    }
    if (left.skin) {
      EXPECT_GT(left.skin->x(), 0.0) << left.name;
    }
  }
  EXPECT_GT(pairs, 40);
}

TEST(Landmarks, AFewAreRequired) {
  int required = 0;
  for (const Landmark& landmark : generic().landmarks)
    required += landmark.required ? 1 : 0;
  EXPECT_GE(required, 18);
  EXPECT_LE(required, 24);
}

TEST(Landmarks, ProportionsOfAnAdult) {
  const auto skin = [](const char* name) { return *generic().landmark(name)->skin; };
  const auto bone = [](const char* name) { return *generic().landmark(name)->bone; };
  // Farkas 1994, adults of both sexes, mean plus and minus about three deviations, in metres.
  EXPECT_NEAR((skin("exocanthion_left") - skin("exocanthion_right")).norm(), 0.089, 0.012);
  EXPECT_NEAR((skin("endocanthion_left") - skin("endocanthion_right")).norm(), 0.032, 0.008);
  EXPECT_NEAR((skin("cheilion_left") - skin("cheilion_right")).norm(), 0.052, 0.010);
  EXPECT_NEAR((skin("alare_left") - skin("alare_right")).norm(), 0.034, 0.008);
  EXPECT_NEAR((skin("sellion") - skin("menton")).norm(), 0.118, 0.018);
  // Bizygomatic and bigonial breadth of the skull.
  EXPECT_NEAR((bone("zygion_left") - bone("zygion_right")).norm(), 0.129, 0.012);
  EXPECT_NEAR((bone("gonion_left") - bone("gonion_right")).norm(), 0.097, 0.015);
}

TEST(Head, ObjectsAreWholeInSpiteOfTheirGroups) {
  const MeshObject* skin = generic().head_object("skin");
  ASSERT_NE(skin, nullptr);
  EXPECT_GT(skin->mesh.triangle_count(), 4000);
  EXPECT_EQ(skin->corner_uvs.size(), skin->mesh.triangles.size());
  const Bounds box = bounds(skin->mesh.vertices);
  EXPECT_NEAR(box.upper.y(), generic().landmark("vertex")->skin->y(), 0.003);
}

TEST(Muscles, LeftMirrorsRight) {
  int pairs = 0;
  for (const Muscle& left : generic().muscles) {
    if (left.side != Side::left) continue;
    ++pairs;
    const Muscle* right = generic().muscle(other_side(left.name));
    ASSERT_NE(right, nullptr) << left.name;
    ASSERT_EQ(left.origin.polygon.size(), right->origin.polygon.size());
    for (size_t i = 0; i < left.origin.polygon.size(); ++i)
      EXPECT_EQ(mirror(left.origin.polygon[i]), right->origin.polygon[left.origin.polygon.size() - 1 - i]);
    for (size_t i = 0; i < left.waypoints.size(); ++i)
      EXPECT_EQ(mirror(left.waypoints[i]), right->waypoints[i]);
    if (left.band) {
      EXPECT_NEAR(std::cos(left.band->begin_angle), -std::cos(right->band->end_angle), 1e-12) << left.name;
      EXPECT_NEAR(std::sin(left.band->begin_angle), std::sin(right->band->end_angle), 1e-12) << left.name;
      EXPECT_EQ(left.band->upper(), right->band->upper()) << left.name;
    }
  }
  EXPECT_EQ(pairs, 54);
}

TEST(Muscles, EveryMuscleOfTheFaceIsThere) {
  std::set<std::string> wholes;
  for (const Muscle& muscle : generic().muscles)
    wholes.insert(muscle.whole);
  for (const char* name : {"frontalis",
                           "corrugator_supercilii",
                           "procerus",
                           "orbicularis_oculi",
                           "levator_labii_superioris_alaeque_nasi",
                           "levator_labii_superioris",
                           "levator_anguli_oris",
                           "zygomaticus_minor",
                           "zygomaticus_major",
                           "incisivus_labii_superioris",
                           "incisivus_labii_inferioris",
                           "orbicularis_oris",
                           "depressor_labii_inferioris",
                           "depressor_anguli_oris",
                           "mentalis",
                           "risorius",
                           "buccinator",
                           "platysma",
                           "temporalis",
                           "masseter",
                           "medial_pterygoid",
                           "lateral_pterygoid",
                           "nasalis",
                           "depressor_septi_nasi",
                           "depressor_supercilii",
                           "levator_palpebrae_superioris",
                           "digastric",
                           "mylohyoid",
                           "geniohyoid"})
    for (const char* side : {"_left", "_right"})
      EXPECT_TRUE(wholes.count(std::string(name) + side)) << name;
}

double course_length(const Muscle& muscle) {
  const auto mean = [](const std::vector<Vec3>& points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : points)
      sum += point;
    return Vec3(sum / static_cast<double>(points.size()));
  };
  Vec3 at = mean(muscle.origin.polygon);
  double length = 0.0;
  for (const Vec3& point : muscle.waypoints) {
    length += (point - at).norm();
    at = point;
  }
  return length + (mean(muscle.insertion.polygon) - at).norm();
}

TEST(Muscles, LengthsArePlausible) {
  for (const Muscle& muscle : generic().muscles) {
    if (muscle.band) continue;
    EXPECT_GT(course_length(muscle), 0.012) << muscle.name;
    EXPECT_LT(course_length(muscle), 0.125) << muscle.name;
  }
  // 55.7 mm in a published finite-element face (ArtiSynth).
  EXPECT_NEAR(course_length(*generic().muscle("zygomaticus_major_superior_left")), 0.0557, 0.006);
}

TEST(Muscles, PartsOfTheOrbicularisDoNotOverlap) {
  for (const Muscle& a : generic().muscles)
    for (const Muscle& b : generic().muscles) {
      if (!a.band || !b.band || a.name >= b.name || a.kind != MuscleKind::sphincter_ring || b.kind != a.kind)
        continue;
      if (a.side != b.side || a.band->orifice != b.band->orifice || a.band->upper() != b.band->upper())
        continue;
      EXPECT_TRUE(a.band->outer <= b.band->inner + 1e-12 || b.band->outer <= a.band->inner + 1e-12)
          << a.name << " and " << b.name;
    }
}

TEST(Actuators, EveryMuscleAndTheJawEyesLidsLips) {
  EXPECT_EQ(generic().actuators.size(), 2 * 54 + 3 + 2 * 8U);
  for (const char* name :
       {"jaw_open", "jaw_forward", "jaw_lateral", "eye_yaw_left", "eye_pitch_right", "buccal_pressure_left",
        "lip_roll_upper_right", "lip_seal_left", "lid_upper_left", "lid_lower_right"})
    EXPECT_NE(generic().actuator(name), nullptr) << name;
  EXPECT_EQ(generic().actuator("jaw_lateral")->minimum, -1.0);
  ASSERT_NE(generic().whole("orbicularis_oculi_left"), nullptr);
  EXPECT_EQ(generic().whole("orbicularis_oculi_left")->members.size(), 7U);
  EXPECT_EQ(generic().whole("orbicularis_oculi_pretarsal_right")->members.size(), 2U);
}

TEST(Expressions, VocabulariesAreComplete) {
  EXPECT_EQ(generic().expression_set("arkit")->expressions.size(), 52U);
  EXPECT_EQ(generic().expression_set("viseme")->expressions.size(), 15U);
  EXPECT_EQ(generic().expression_set("vrm")->expressions.size(), 18U);
  EXPECT_EQ(generic().expression_set("smile")->expressions.size(), 3U);
  EXPECT_EQ(generic().expression_set("arkit")->find("mouthClose")->corrects, "jawOpen");
  for (const int unit :
       {1, 2, 4, 5, 6, 7, 9, 10, 11, 12, 14, 15, 16, 17, 18, 20, 22, 23, 24, 25, 26, 27, 28, 43, 45})
    EXPECT_NE(generic().expression_set("au")->find(std::to_string(unit)), nullptr) << unit;
}

TEST(Expressions, ANewMuscleTakesPartInTheActionUnitsItLists) {
  GenericAnatomy anatomy = generic();
  Muscle muscle = anatomy.muscles.front();
  muscle.name = muscle.whole = "malaris_left";
  muscle.side = Side::left;
  muscle.action_units = {6, -43};
  add_muscle(anatomy, muscle);
  const auto weight = [&](const char* unit) {
    for (const auto& [name, value] : anatomy.expression_set("au")->find(unit)->weights)
      if (name == "malaris_left") return value;
    return 0.0;
  };
  EXPECT_EQ(weight("6"), 1.0);
  EXPECT_EQ(weight("L6"), 1.0);
  EXPECT_EQ(weight("R6"), 0.0) << "the other side";
  EXPECT_EQ(weight("43"), -1.0) << "it relaxes";
  EXPECT_EQ(weight("12"), 0.0);
  const size_t members = anatomy.expression_set("au")->find("6")->weights.size();
  add_muscle(anatomy, muscle);
  EXPECT_EQ(anatomy.expression_set("au")->find("6")->weights.size(), members) << "replaced, not doubled";
  muscle.name = muscle.whole = "another_left";
  muscle.action_units = {99};
  EXPECT_THROW(add_muscle(anatomy, muscle), Error);
}

TEST(Expressions, WeightsStayInTheChannelsRange) {
  // A muscle may be relaxed (negative) but no further than it can be contracted.
  for (const ExpressionSet& set : generic().expression_sets)
    for (const Expression& expression : set.expressions)
      for (const auto& [name, weight] : expression.weights) {
        const Actuator& actuator = *generic().actuator(name);
        EXPECT_LE(weight, actuator.maximum) << set.name << ":" << expression.name << " " << name;
        EXPECT_GE(weight, actuator.is_muscle ? -1.0 : actuator.minimum)
            << set.name << ":" << expression.name << " " << name;
      }
}

/// Actuator name of the other side; the name itself when it has none.
std::string swapped(const std::string& name) {
  if (name.size() > 5 && name.ends_with("_left")) return name.substr(0, name.size() - 5) + "_right";
  if (name.size() > 6 && name.ends_with("_right")) return name.substr(0, name.size() - 6) + "_left";
  return name;
}

TEST(Expressions, LeftMirrorsRight) {
  const ExpressionSet& arkit = *generic().expression_set("arkit");
  int pairs = 0;
  for (const Expression& left : arkit.expressions) {
    if (!left.name.ends_with("Left")) continue;
    const Expression* right = arkit.find(left.name.substr(0, left.name.size() - 4) + "Right");
    ASSERT_NE(right, nullptr) << left.name;
    ++pairs;
    const std::map<std::string, double> weights(right->weights.begin(), right->weights.end());
    EXPECT_EQ(weights.size(), left.weights.size()) << left.name;
    for (const auto& [name, weight] : left.weights) {
      const bool sideways = name == "jaw_lateral" || name.starts_with("eye_yaw");
      ASSERT_TRUE(weights.count(swapped(name))) << left.name << " " << name;
      EXPECT_DOUBLE_EQ(weights.at(swapped(name)), sideways ? -weight : weight) << left.name << " " << name;
    }
  }
  EXPECT_EQ(pairs, 20);
}

TEST(Mechanics, InMetresRadiansAndPascal) {
  const Mechanics& m = generic().mechanics;
  EXPECT_EQ(m.skin.young_modulus, 14000.0);
  EXPECT_EQ(m.skin.thickness, 0.0017);
  EXPECT_EQ(m.lids.crease.begin, 0.010);
  EXPECT_EQ(m.lids.crease.end, 0.015);
  EXPECT_NEAR(m.jaw.open_angle, 24.981 * 3.14159265358979 / 180.0, 1e-12);
  EXPECT_NEAR(m.lids.crease.rise(0.0125), 0.5, 1e-12);
  EXPECT_EQ(m.lids.crease.fall(0.009), 1.0);
}

TEST(Mechanics, PlacesOfTheFaceStandOnBothSides) {
  const Mechanics& m = generic().mechanics;
  EXPECT_EQ(m.attachment_regions.size(), 21U);  // three of the midline, nine pairs
  const auto named = [&](const std::string& name) -> const AttachmentRegion& {
    return *std::find_if(m.attachment_regions.begin(), m.attachment_regions.end(),
                         [&](const AttachmentRegion& region) { return region.name == name; });
  };
  EXPECT_EQ(named("buccal_space_right").place.parts[0].landmark, "cheilion_right");
  EXPECT_EQ(named("forehead_lateral_left").place.parts[1].share, Vec3(0.8, 0.0, 0.0));
  // Of places made from whole landmarks the shares sum to one, or they would move with the head's origin.
  for (const AttachmentRegion& region : m.attachment_regions) {
    Vec3 sum = Vec3::Zero();
    for (const FacePlace::Part& part : region.place.parts)
      sum += part.share;
    EXPECT_NEAR(sum.y(), 1.0, 1e-12) << region.name;
    EXPECT_NEAR(sum.z(), 1.0, 1e-12) << region.name;
  }
}

TEST(Tissue, ZonesInRangeAndLigamentsOfPlausibleLength) {
  const Tissue& tissue = generic().tissue;
  for (const Zone& zone : tissue.skin_attachments) {
    EXPECT_GT(zone.value, 0.0) << zone.name;
    EXPECT_LE(zone.value, 1.0) << zone.name;
  }
  for (const Zone& zone : tissue.gliding_planes)
    EXPECT_LT(zone.value, 0.02) << zone.name;
  EXPECT_EQ(tissue.ligaments.size(), 16U);
  for (const RetainingLigament& ligament : tissue.ligaments)
    for (size_t i = 0; i < ligament.bone.size(); ++i) {
      const double length = (ligament.bone[i] - ligament.skin[i]).norm();
      EXPECT_GT(length, 0.003) << ligament.name;
      EXPECT_LT(length, 0.020) << ligament.name;
    }
}

}  // namespace
}  // namespace fascia::anatomy
