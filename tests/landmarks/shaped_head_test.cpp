// Heads that carry shapes of their own: what closes the eyes and raises the corners tells where the face is,
// when nothing else does.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <nlohmann/json.hpp>

#include "builder/rigging/find_landmarks.h"
#include "builder/rigging/shape_places.h"
#include "geometry/error.h"
#include "tests/landmarks/made_heads.h"

namespace fascia::testing {
namespace {

using Strings = std::vector<std::string>;

const anatomy::GenericAnatomy& anatomy_of_tests() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

/// A head as a ball, as toys have: hardly a nose, no chin, no brow.
Vec3 as_ball(const Vec3& p) {
  const Vec3 centre(0, 0, 0.02);
  const Vec3 from = p - centre;
  return centre + from.normalized() * (0.12 * from.norm() + 0.88 * 0.105);
}

/// The skin of a head, as glTF with a shape for each name: the four places are moved down, their
/// surroundings less.
MadeHead with_shapes(MadeHead head, const Strings& names) {
  using nlohmann::json;
  head.scene.meshes.resize(1);
  formats::SceneMesh& skin = head.scene.meshes[0];
  skin.mesh = skin.primitive = 0;
  const auto middle = [&](const char* a, const char* b) {
    return Vec3(0.5 * (head.truth.at(a) + head.truth.at(b)));
  };
  const Vec3 places[] = {middle("exocanthion_left", "endocanthion_left"),
                         middle("exocanthion_right", "endocanthion_right"), head.truth.at("cheilion_left"),
                         head.truth.at("cheilion_right")};
  json views = json::array(), accessors = json::array(), targets = json::array();
  std::vector<uint8_t>& bytes = head.scene.document.bin;
  const auto add = [&](const std::function<Vec3(const Vec3&)>& value) {
    const size_t start = bytes.size();
    for (const Vec3& p : skin.positions) {
      const Eigen::Vector3f v = value(p).cast<float>();
      bytes.resize(bytes.size() + sizeof v);
      std::memcpy(bytes.data() + bytes.size() - sizeof v, v.data(), sizeof v);
    }
    views.push_back({{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes.size() - start}});
    accessors.push_back({{"bufferView", views.size() - 1},
                         {"componentType", 5126},
                         {"count", skin.positions.size()},
                         {"type", "VEC3"}});
    return accessors.size() - 1;
  };
  const size_t positions = add([](const Vec3& p) { return p; });
  for (size_t k = 0; k < names.size(); ++k)
    targets.push_back({{"POSITION", add([&, k](const Vec3& p) {
                          const double gap = (p - places[k % 4]).norm() * head.millimetres / 8.0;
                          return Vec3(0, -0.01 * std::exp(-0.5 * gap * gap), 0);
                        })}});
  const json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", 0}, {"targets", targets}};
  head.scene.document.json =
      json{{"asset", {{"version", "2.0"}}},
           {"buffers", {{{"byteLength", bytes.size()}}}},
           {"bufferViews", views},
           {"accessors", accessors},
           {"meshes", {{{"primitives", {primitive}}, {"extras", {{"targetNames", names}}}}}}}
          .dump();
  return head;
}

const Strings arkit = {"eyeBlinkLeft", "eyeBlinkRight", "mouthSmileLeft", "mouthSmileRight"};

double worst_millimetres(const MadeHead& head, const rigging::FoundLandmarks& found) {
  double worst = 0.0;
  for (const char* name : {"exocanthion_left", "exocanthion_right", "cheilion_left", "cheilion_right"})
    worst = std::max(worst, head.millimetres * (transform_point(found.head.input_to_metres.inverse(),
                                                                found.landmarks.at(name).position) -
                                                head.truth.at(name))
                                                   .norm());
  return worst;
}

TEST(ShapedHead, PlacesAreThoseTheShapesMove) {
  const MadeHead plain = made_head(anatomy_of_tests(), "plain", [](const Vec3& p) { return p; });
  for (const Strings& names :
       {arkit, Strings{"Fcl_EYE_Close_L", "Fcl_EYE_Close_R", "mouthSmile_L", "mouthSmile_R"},
        Strings{"head.blink_left", "head.blink_right", "SmileLeft", "SmileRight"}}) {
    const auto places = rigging::places_by_shapes(with_shapes(plain, names).scene, anatomy_of_tests());
    ASSERT_TRUE(places) << names[0];
    ASSERT_EQ(places->anchors.size(), 4u);
    for (const landmarks::Anchor& anchor : places->anchors)
      EXPECT_LT((anchor.generic - anchor.target).norm(), 0.006);
    EXPECT_TRUE(places->agree({}));
    landmarks::Placement aside;
    aside.shift = Vec3(0.03, 0, 0);
    EXPECT_FALSE(places->agree(aside));
  }
}

TEST(ShapedHead, SidesMayBeTheViewers) {
  const MadeHead plain = made_head(anatomy_of_tests(), "plain", [](const Vec3& p) { return p; });
  const auto places = rigging::places_by_shapes(
      with_shapes(plain, {"eyeBlinkRight", "eyeBlinkLeft", "mouthSmileRight", "mouthSmileLeft"}).scene,
      anatomy_of_tests());
  ASSERT_TRUE(places);
  EXPECT_TRUE(places->agree({}));
}

TEST(ShapedHead, ThreePlacesAreNotEnough) {
  const MadeHead plain = made_head(anatomy_of_tests(), "plain", [](const Vec3& p) { return p; });
  EXPECT_FALSE(rigging::places_by_shapes(plain.scene, anatomy_of_tests()));
  EXPECT_FALSE(rigging::places_by_shapes(with_shapes(plain, {arkit[0], arkit[1], arkit[2]}).scene,
                                         anatomy_of_tests()));
  MadeHead damaged = with_shapes(plain, arkit);
  damaged.scene.document.bin.resize(100);
  EXPECT_FALSE(rigging::places_by_shapes(damaged.scene, anatomy_of_tests()));
  // All four about one place are no face.
  MadeHead heap = with_shapes(plain, {arkit[0], "b", "c", "d", arkit[1], "f", "g", "h", arkit[2]});
  EXPECT_FALSE(rigging::places_by_shapes(heap.scene, anatomy_of_tests()));
}

TEST(ShapedHead, AFaceThatIsPlainIsFoundAsWithoutThem) {
  const MadeHead plain = made_head(anatomy_of_tests(), "plain", [](const Vec3& p) { return p; });
  const MadeHead shaped = with_shapes(plain, arkit);
  MadeHead bare = shaped;
  bare.scene.document = {};
  const auto with = rigging::find_landmarks(shaped.scene, {}, anatomy_of_tests()),
             without = rigging::find_landmarks(bare.scene, {}, anatomy_of_tests());
  for (const auto& [name, landmark] : without.landmarks)
    EXPECT_EQ(landmark.position, with.landmarks.at(name).position) << name;
}

TEST(ShapedHead, ABallIsFoundByThem) {
  for (const double degrees : {0.0, 70.0}) {
    const MadeHead ball =
        moved(made_head(anatomy_of_tests(), "ball", as_ball),
              Eigen::AngleAxisd(degrees * EIGEN_PI / 180, Vec3(1, 2, 0).normalized()).toRotationMatrix(),
              100.0, Vec3(3, 2, 1));
    const MadeHead shaped = with_shapes(ball, arkit);
    MadeHead bare = shaped;
    bare.scene.document = {};
    // Half an eye's width: without them there is nothing to go by.
    try {
      EXPECT_GT(worst_millimetres(bare, rigging::find_landmarks(bare.scene, {}, anatomy_of_tests())), 15.0);
    } catch (const Error&) {
    }
    EXPECT_LT(worst_millimetres(shaped, rigging::find_landmarks(shaped.scene, {}, anatomy_of_tests())), 15.0);
  }
}

}  // namespace
}  // namespace fascia::testing
