#include "app/engine/live_skull.h"

#include <gtest/gtest.h>

#include "anatomy/anatomy.h"
#include "builder/skull/from_anatomy.h"

namespace fascia::app {
namespace {

std::vector<rig::Vec3f> single(const std::vector<Vec3>& points) {
  std::vector<rig::Vec3f> all;
  for (const Vec3& p : points)
    all.push_back(p.cast<float>());
  return all;
}

double largest(const std::vector<Vec3>& shift) {
  double most = 0.0;
  for (const Vec3& d : shift)
    most = std::max(most, d.norm());
  return most;
}

/// The generic head as a rig of itself.
TEST(LiveSkull, FollowsALandmarkWhereItIsMovedAndGoesBackWithIt) {
  const skull::Generic generic = skull::from_anatomy(anatomy::load_generic());
  auto rig = std::make_shared<rig::Rig>();
  rig->skull.cranium.positions = single(generic.cranium.vertices);
  rig->skull.mandible.positions = single(generic.mandible.vertices);
  for (const skull::GenericLandmark& landmark : generic.landmarks) {
    rig::Landmark known;
    known.name = landmark.name;
    known.skin = landmark.skin.cast<float>();
    known.confidence = 1.0F;
    rig->skull.landmarks.push_back(known);
  }
  LiveSkull live(
      rig,
      [&] {
        return HeadMeshes{generic.skin, {}, {}};
      },
      LiveSkull::Pace::at_once);
  EXPECT_EQ(live.shift(), nullptr);
  Vec3 chin = Vec3::Zero();
  for (const skull::GenericLandmark& landmark : generic.landmarks)
    if (landmark.name == "pogonion") chin = landmark.skin;
  live.submit({{"pogonion", chin + Vec3(0, 0, 0.005)}});
  const auto shift = live.shift();
  ASSERT_TRUE(shift);
  ASSERT_EQ(shift->mandible.size(), generic.mandible.vertices.size());
  ASSERT_EQ(shift->cranium.size(), generic.cranium.vertices.size());
  EXPECT_GT(largest(shift->mandible), 0.002);
  EXPECT_LT(largest(shift->cranium), 0.25 * largest(shift->mandible));
  live.submit({{"pogonion", chin.cast<float>().cast<double>()}});
  ASSERT_TRUE(live.shift());
  // The fit goes on from where it is: it comes back to within its own tolerance.
  EXPECT_LT(largest(live.shift()->mandible), 4e-4);
  live.submit({});
  EXPECT_EQ(live.shift(), nullptr);
}

TEST(LiveSkull, AHeadThatNoSkullFitsIsLeftAsItIs) {
  LiveSkull live(
      std::make_shared<rig::Rig>(), [] { return HeadMeshes(); }, LiveSkull::Pace::background);
  live.submit({{"pogonion", Vec3(0, 0, 0.1)}});
  EXPECT_EQ(live.shift(), nullptr);
}

}  // namespace
}  // namespace fascia::app
