// Generic head and skull as one: depths, cover, and whether curves and regions lie on their surfaces.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/skull/exterior.h"
#include "builder/skull/tissue_depth.h"
#include "builder/spatial/surface_query.h"
#include "geometry/error.h"

namespace fascia::anatomy {
namespace {

struct Surfaces {
  GenericAnatomy anatomy = load_generic();
  spatial::SurfaceQuery skin{anatomy.head_object("skin")->mesh};
  skull::Exterior outer = skull::exterior(anatomy.head_object("skin")->mesh);
  spatial::SurfaceQuery cranium{anatomy.skull_object("cranium")->mesh};
  spatial::SurfaceQuery mandible{anatomy.skull_object("mandible")->mesh};
  spatial::SurfaceQuery teeth_upper{anatomy.skull_object("teeth_upper")->mesh};
  spatial::SurfaceQuery teeth_lower{anatomy.skull_object("teeth_lower")->mesh};

  double to_bone(const Vec3& point) const {
    return std::min(cranium.closest(point).distance, mandible.closest(point).distance);
  }
};

const Surfaces& surfaces() {
  static const Surfaces all;
  return all;
}

/// Distance along the inward normal from the skin to the first bone or tooth.
std::optional<double> measured_depth(const Landmark& landmark) {
  const Surfaces& all = surfaces();
  const Vec3 start = all.skin.closest(*landmark.skin).position;
  std::optional<double> depth;
  for (const spatial::SurfaceQuery* part :
       {&all.cranium, &all.mandible, &all.teeth_upper, &all.teeth_lower}) {
    const auto hit = part->first_hit(start, -landmark.normal, 0.06);
    if (hit && (!depth || hit->distance < *depth)) depth = hit->distance;
  }
  return depth;
}

TEST(HeadAndSkull, DepthAtEveryLandmarkWithinOneDeviationOfTheTable) {
  const TissueDepthTable& table = surfaces().anatomy.depth_tables.front();
  int checked = 0;
  for (const Landmark& landmark : surfaces().anatomy.landmarks) {
    if (!landmark.craniometric || landmark.depth.empty() || !landmark.skin) continue;
    const TissueDepth& wanted = *table.find(landmark.depth);
    const auto depth = measured_depth(landmark);
    ASSERT_TRUE(depth) << landmark.name << ": no bone under it";
    EXPECT_LE(std::abs(*depth - wanted.mean), wanted.deviation)
        << landmark.name << ": " << *depth * 1e3 << " mm, table " << wanted.mean * 1e3;
    ++checked;
  }
  EXPECT_GE(checked, 36);
}

TEST(HeadAndSkull, BoneLiesInsideTheSkinEverywhere) {
  double least = 1.0;
  for (const char* part : {"cranium", "mandible"}) {
    for (const Vec3& point : surfaces().anatomy.skull_object(part)->mesh.vertices) {
      const double cover = -surfaces().outer.closest(point).signed_distance;
      least = std::min(least, cover);
      EXPECT_GT(cover, 0.001) << part << " at " << 1e3 * point.transpose() << " mm";
    }
  }
  RecordProperty("least_cover_mm", std::to_string(least * 1e3));
}

TEST(HeadAndSkull, BonePointsLieOnTheirBones) {
  double sum = 0;
  int count = 0;
  for (const Landmark& landmark : surfaces().anatomy.landmarks) {
    if (!landmark.bone) continue;
    const double off = surfaces().to_bone(*landmark.bone);
    // Where the depth places the point, the skull may miss it by as much as people differ.
    const TissueDepth* depth =
        landmark.depth.empty() ? nullptr : surfaces().anatomy.depth_tables.front().find(landmark.depth);
    const double allowed = landmark.bone_from_depth ? depth ? depth->deviation : 0.006 : 0.0003;
    EXPECT_LE(off, allowed) << landmark.name << ": " << off * 1e3 << " mm";
    EXPECT_NEAR(landmark.bone_normal.norm(), 1.0, 1e-9) << landmark.name;
    sum += off;
    ++count;
  }
  EXPECT_LT(sum / count, 0.001);
}

TEST(HeadAndSkull, TangentsLieInTheSkinAndLeadAwayFromTheMidplane) {
  for (const Landmark& landmark : surfaces().anatomy.landmarks) {
    if (!landmark.skin) continue;
    EXPECT_NEAR(landmark.tangent.norm(), 1.0, 1e-9) << landmark.name;
    EXPECT_NEAR(landmark.tangent.dot(landmark.normal), 0.0, 2e-5) << landmark.name;
    const double side = landmark.side == Side::right ? -1.0 : 1.0;
    EXPECT_GE(side * landmark.tangent.x(), 0.0) << landmark.name;
  }
}

TEST(HeadAndSkull, ChinPointsStandInOrder) {
  const auto bone = [](const char* name) { return *surfaces().anatomy.landmark(name)->bone; };
  EXPECT_GT(bone("pogonion").z(), bone("gnathion").z());
  EXPECT_GT(bone("gnathion").z(), bone("menton").z());
  EXPECT_GT(bone("pogonion").y(), bone("gnathion").y());
  EXPECT_GT(bone("gnathion").y(), bone("menton").y());
  // The orbit's most lateral point lies lateral to its inner rim and in front of the temporal fossa.
  EXPECT_GT(bone("ectoconchion_left").x(), bone("frontomalare_orbitale_left").x() - 0.002);
  EXPECT_LT(bone("ectoconchion_left").x(), bone("frontomalare_temporale_left").x() + 0.004);
}

TEST(HeadAndSkull, CurvesLieOnTheirSurfacesAndMirror) {
  for (const char* name :
       {"orbital_rim", "piriform_margin", "mandible_border", "temporal_line", "zygomatic_arch", "brow",
        "upper_lid_margin", "lower_lid_margin", "upper_vermilion_border", "lower_vermilion_border",
        "lip_line", "nasolabial_fold", "jaw_line", "upper_lid_crease", "alar_groove", "hairline"}) {
    ASSERT_NE(surfaces().anatomy.curve(std::string(name) + "_left"), nullptr) << name;
  }
  for (const Curve& curve : surfaces().anatomy.curves) {
    const spatial::SurfaceQuery& surface = curve.on == "skin"      ? surfaces().skin
                                           : curve.on == "cranium" ? surfaces().cranium
                                                                   : surfaces().mandible;
    EXPECT_GE(curve.points.size(), 8U) << curve.name;
    for (const Vec3& point : curve.points)
      EXPECT_LT(surface.closest(point).distance, 0.0002) << curve.name;
    for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
      EXPECT_LT((curve.points[i + 1] - curve.points[i]).norm(), 0.025) << curve.name << " jumps at " << i;
    }
    if (curve.side != Side::left) continue;
    const Curve* right = surfaces().anatomy.curve(curve.name.substr(0, curve.name.size() - 4) + "right");
    ASSERT_NE(right, nullptr) << curve.name;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      EXPECT_EQ(right->points[i], Vec3(-curve.points[i].x(), curve.points[i].y(), curve.points[i].z()));
    }
  }
}

TEST(HeadAndSkull, RegionsLieOnTheSkin) {
  const Tissue& tissue = surfaces().anatomy.tissue;
  for (const std::vector<Zone>* zones : {&tissue.skin_attachments, &tissue.gliding_planes}) {
    EXPECT_FALSE(zones->empty());
    for (const Zone& zone : *zones) {
      for (const Vec3& corner : zone.polygon) {
        EXPECT_LT(surfaces().skin.closest(corner).distance, 0.0005)
            << zone.name << " at " << 1e3 * corner.transpose();
      }
      // No corner has slipped to another part of the head: the straight way to the next one keeps near the
      // skin.
      for (std::size_t i = 0; i < zone.polygon.size(); ++i) {
        const Vec3 middle = 0.5 * (zone.polygon[i] + zone.polygon[(i + 1) % zone.polygon.size()]);
        EXPECT_LT(surfaces().outer.surface.closest(middle).distance, 0.015) << zone.name << " side " << i;
      }
    }
  }
  for (const RetainingLigament& ligament : tissue.ligaments) {
    for (std::size_t i = 0; i < ligament.bone.size(); ++i) {
      EXPECT_LT(surfaces().skin.closest(ligament.skin[i]).distance, 0.0015) << ligament.name;
      // Between skin and bone; the osteocutaneous ones on the bone.
      EXPECT_LT(surfaces().outer.surface.signed_distance(ligament.bone[i]), 0.0) << ligament.name;
      if (ligament.type == "osteocutaneous") {
        EXPECT_LT(surfaces().to_bone(ligament.bone[i]), 0.003) << ligament.name << " point " << i;
      }
    }
  }
}

/// How far a region's corners and the middles of its sides lie from where it says it is.
double off_its_surface(const Region& region) {
  const Surfaces& all = surfaces();
  const bool on_bone = region.on == Attachment::cranium || region.on == Attachment::mandible;
  const spatial::SurfaceQuery& surface = region.on == Attachment::cranium    ? all.cranium
                                         : region.on == Attachment::mandible ? all.mandible
                                                                             : all.outer.surface;
  double worst = 0;
  for (std::size_t i = 0; i < region.polygon.size(); ++i) {
    const Vec3& corner = region.polygon[i];
    const Vec3 middle = 0.5 * (corner + region.polygon[(i + 1) % region.polygon.size()]);
    for (const Vec3& point : {corner, middle})
      worst = std::max(worst, surface.closest(point).distance);
    if (!on_bone) {
      EXPECT_LT(surface.signed_distance(corner), 0.0005) << "outside the skin";
    }
  }
  return worst;
}

TEST(HeadAndSkull, MuscleRegionsLieWhereTheySay) {
  // Within the skin by what the region is in; the orbit's apex, where the lid's levator begins, is filled in
  // the skull.
  const std::map<Attachment, double> within{
      {Attachment::cranium, 0.006},  {Attachment::mandible, 0.006}, {Attachment::skin, 0.006},
      {Attachment::tarsus, 0.004},   {Attachment::smas, 0.006},     {Attachment::galea, 0.006},
      {Attachment::modiolus, 0.010}, {Attachment::fascia, 0.014},   {Attachment::hyoid, 0.028}};
  for (const Muscle& muscle : surfaces().anatomy.muscles) {
    for (const Region* region : {&muscle.origin, &muscle.insertion}) {
      if (region->polygon.empty()) continue;
      SCOPED_TRACE(muscle.name + (region == &muscle.origin ? " origin" : " insertion"));
      ASSERT_EQ(within.count(region->on), 1U);
      const bool orbit = muscle.layer == "orbit" && region->on == Attachment::cranium;
      EXPECT_LT(off_its_surface(*region), orbit ? 0.008 : within.at(region->on));
    }
  }
}

TEST(HeadAndSkull, DenseDepthFieldPassesThroughEveryTableAndStaysWithinIt) {
  const GenericAnatomy& anatomy = surfaces().anatomy;
  for (const TissueDepthTable& table : anatomy.depth_tables) {
    const skull::TissueDepthField field(anatomy, table.name);
    double least = 1.0;
    double greatest = 0.0;
    for (const Landmark& landmark : anatomy.landmarks) {
      const TissueDepth* depth = landmark.depth.empty() ? nullptr : table.find(landmark.depth);
      if (!depth || !landmark.skin) continue;
      EXPECT_NEAR(field.mean(*landmark.skin), depth->mean, 1e-9) << landmark.name;
      EXPECT_NEAR(field.deviation(*landmark.skin), depth->deviation, 1e-9) << landmark.name;
      least = std::min(least, depth->mean);
      greatest = std::max(greatest, depth->mean);
    }
    for (const Vec3& point : surfaces().skin.mesh().vertices) {
      EXPECT_GE(field.mean(point), least);
      EXPECT_LE(field.mean(point), greatest);
      EXPECT_NEAR(field.mean(point), field.mean({-point.x(), point.y(), point.z()}), 1e-9);
    }
  }
  EXPECT_THROW(skull::TissueDepthField(anatomy, "nobody_1900"), Error);
}

}  // namespace
}  // namespace fascia::anatomy
