// What the embedded head shows of a shape at a weight: that share of the way it goes at 1.
#include <algorithm>
#include <cmath>

#include "fascia/fascia.hpp"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {
namespace {

class ShapeResponse : public EmbeddedSubject {
 protected:
  static void SetUpTestSuite() {
    EmbeddedSubject::SetUpTestSuite();
    asset = new api::Asset(api::Asset::load(formats::read_bytes(at("rig.glb"))));
    face = new api::Face(*asset);
  }
  static void TearDownTestSuite() {
    delete face;
    delete asset;
    EmbeddedSubject::TearDownTestSuite();
  }

  static std::vector<double> positions() {
    std::vector<double> all;
    for (uint32_t mesh = 0; mesh < asset->info().mesh_count; ++mesh) {
      if (std::string(asset->mesh(mesh).part) != "skin") continue;
      for (const api::Vector3& position : face->positions(mesh))
        all.insert(all.end(), position.begin(), position.end());
    }
    return all;
  }

  /// How the skin lies with `shape` at `weight` beside the shape that it corrects at `base`.
  static std::vector<double> posed(const std::string& shape, float weight, float base) {
    face->clear();
    face->set("arkit:" + shape, weight);
    if (shape == "mouthClose") face->set("arkit:jawOpen", base);
    face->pose();
    return positions();
  }

  /// What the shape at `weight` adds.
  static std::vector<double> added(const std::string& shape, float weight) {
    std::vector<double> moved = posed(shape, weight, weight);
    const std::vector<double> without = posed(shape, 0.0F, weight);
    for (size_t i = 0; i < moved.size(); ++i)
      moved[i] -= without[i];
    return moved;
  }

  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (size_t i = 0; i < a.size(); ++i)
      sum += a[i] * b[i];
    return sum;
  }

  inline static api::Asset* asset = nullptr;
  inline static api::Face* face = nullptr;
};

TEST_F(ShapeResponse, EveryShapeShowsItsWeight) {
  // The solver ends a pose within its tolerance, and curves stand between heads: 0.01 beyond the 0.05 due.
  constexpr double due = 0.05, tolerance = 0.01;
  int shapes = 0;
  for (uint32_t s = 0;; ++s) {
    const fascia_set_info set = asset->set(s);
    if (std::string(set.name) != "arkit") continue;
    for (uint32_t m = 0; m < set.member_count; ++m) {
      const std::string shape = set.members[m];
      if (shape.ends_with("Right")) continue;  // mirror images
      const std::vector<double> whole = added(shape, 1.0F);
      const double most = std::abs(*std::max_element(
          whole.begin(), whole.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
      if (most < 2e-4) continue;  // the tongue
      ++shapes;
      for (const float weight : {0.1F, 0.25F, 0.5F, 0.75F})
        EXPECT_NEAR(dot(added(shape, weight), whole) / dot(whole, whole), static_cast<double>(weight),
                    due + tolerance)
            << shape << " at " << weight;
    }
    break;
  }
  EXPECT_GE(shapes, 30);
}

TEST_F(ShapeResponse, APoseDoesNotDependOnThePosesBefore) {
  for (const char* shape : {"mouthPucker", "mouthRollUpper", "jawOpen"}) {
    const std::vector<double> first = posed(shape, 1.0F, 0.0F);
    posed("mouthClose", 1.0F, 1.0F);
    posed("mouthSmileLeft", 0.6F, 0.0F);
    EXPECT_EQ(posed(shape, 1.0F, 0.0F), first) << shape;
  }
}

TEST_F(ShapeResponse, MouthCloseClosesTheLipsOverAnOpenJaw) {
  // Between the lips of the embedded head in the middle third of their width, in its own unit, millimetres.
  const auto gap = [](float close) {
    face->clear();
    face->set("arkit:jawOpen", 1.0F);
    face->set("arkit:mouthClose", close);
    face->pose();
    double upper = 1e9, lower = -1e9;
    for (uint32_t mesh = 0; mesh < asset->info().mesh_count; ++mesh) {
      const std::string name = asset->mesh(mesh).name;
      for (const api::Vector3& position : face->positions(mesh)) {
        if (std::abs(position[0]) > 8.0) continue;
        if (name == "lip_upper") upper = std::min(upper, static_cast<double>(position[1]));
        if (name == "lip_lower") lower = std::max(lower, static_cast<double>(position[1]));
      }
    }
    return upper - lower;
  };
  const double open = gap(0.0F), closed = gap(1.0F);
  EXPECT_GT(open, 15.0);
  EXPECT_LT(closed, 0.1 * open);
}

TEST_F(ShapeResponse, GazeTurnsTheEyesInProportion) {
  const int32_t pitch = asset->find_channel("eye_pitch_left");
  ASSERT_GE(pitch, 0);
  const auto turned = [&](float weight) {
    posed("eyeLookUpLeft", weight, 0.0F);
    return face->effective_values()[static_cast<size_t>(pitch)];
  };
  const float whole = turned(1.0F);
  EXPECT_GT(whole, 0.3F);
  for (const float weight : {0.1F, 0.5F, 0.9F})
    EXPECT_NEAR(turned(weight), weight * whole, 1e-6F);
}

}  // namespace
}  // namespace fascia::fit
