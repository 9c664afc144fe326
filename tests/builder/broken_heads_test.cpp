// Heads with every fault that meshes have: each becomes a rig that moves as the sound head's does, or is
// refused with a message that says where and what. All kinds, so many of each: FASCIA_BROKEN_HEADS=6
// (scripts/test.sh --full); without it one each of some. FASCIA_BROKEN_HEADS_TO=FOLDER keeps them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "anatomy/anatomy.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "cli/posing.h"
#include "formats/files.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "rig/write/write.h"
#include "tests/builder/broken_heads.h"

namespace fascia::testing {
namespace {

const anatomy::GenericAnatomy& anatomy_data() {
  static const anatomy::GenericAnatomy data = anatomy::load_generic();
  return data;
}

/// A rig of a broken head, and where it goes.
class Rig {
 public:
  explicit Rig(const BrokenHead& head) {
    const formats::Scene scene = formats::read(head.file, head.bytes);
    rigging::BuildOptions options;
    options.detail = "low";
    rigging::BuildResult built = rigging::build_rig(scene, {}, anatomy_data(), options);
    const formats::Scene& source = built.opened ? *built.opened : scene;
    const auto bytes = rig::write(rigging::gltf_source(source, built.report.input_to_metres), built.rig);
    rig::read(bytes, head.file);  // throws when it is not sound
    const auto path = std::filesystem::temp_directory_path() / ("fascia_broken_" + head.kind + ".glb");
    formats::write_bytes(path, bytes.data(), bytes.size());
    face_ = std::make_unique<cli::Face>(path, cli::Face::Options{FASCIA_SPACE_METRES, "own", ""});
    std::filesystem::remove(path);
    report_ = std::move(built.report);
    const Mat4 to_rig = report_.input_to_metres * head.to_file;
    for (const anatomy::Landmark& landmark : anatomy_data().landmarks)
      if (landmark.skin) places_[landmark.name] = transform_point(to_rig, *landmark.skin);
    for (const rig::Landmark& landmark : built.rig.skull.landmarks)
      found_[landmark.name] = landmark.skin.cast<double>();
  }

  void pose(const std::map<std::string, double>& values) {
    face_->clear();
    face_->reset();
    for (const auto& [name, value] : values)
      face_->set(name, value);
    face_->pose();
  }

  /// How far the skin's vertex that is nearest to a landmark's true place has gone, metres.
  Vec3 moved(const std::string& landmark) const {
    double nearest = 1e300;
    Vec3 way = Vec3::Zero();
    for (size_t m = 0; m < face_->meshes().size(); ++m) {
      if (face_->meshes()[m].part != "skin") continue;
      for (size_t v = 0; v < face_->rest(m).size() / 3; ++v) {
        const double distance = (place(face_->rest(m), v) - places_.at(landmark)).norm();
        if (distance >= nearest) continue;
        nearest = distance;
        way = place(face_->positions(m), v) - place(face_->rest(m), v);
      }
    }
    return way;
  }

  bool is_finite() const {
    for (size_t m = 0; m < face_->meshes().size(); ++m)
      for (const float x : face_->positions(m))
        if (!std::isfinite(x)) return false;
    return true;
  }

  /// The widest crack between vertices that are in one place at rest, metres.
  double widest_crack() const {
    std::map<std::array<int64_t, 3>, std::vector<std::array<Vec3, 2>>> places;
    for (size_t m = 0; m < face_->meshes().size(); ++m)
      for (size_t v = 0; v < face_->rest(m).size() / 3; ++v) {
        const Vec3 rest = place(face_->rest(m), v);
        places[{std::llround(1e6 * rest[0]), std::llround(1e6 * rest[1]), std::llround(1e6 * rest[2])}]
            .push_back({rest, place(face_->positions(m), v)});
      }
    double widest = 0.0;
    for (const auto& [key, here] : places)
      for (const auto& [rest, now] : here)
        if ((rest - here[0][0]).norm() < 5e-7) widest = std::max(widest, (now - here[0][1]).norm());
    return widest;
  }

  const rigging::BuildReport& report() const { return report_; }
  /// How far from its true place a landmark was found, metres.
  double off(const std::string& landmark) const {
    return (found_.at(landmark) - places_.at(landmark)).norm();
  }

 private:
  static Vec3 place(std::span<const float> flat, size_t v) {
    return Vec3(flat[3 * v], flat[3 * v + 1], flat[3 * v + 2]);
  }
  std::unique_ptr<cli::Face> face_;
  rigging::BuildReport report_;
  Landmarks places_, found_;
};

bool contains_one(const std::string& text, const std::vector<std::string>& words) {
  return words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
           return text.find(word) != std::string::npos;
         });
}

/// Whether a text names a vertex or triangle of a mesh.
bool says_where(const std::string& text) {
  static const std::regex place("(vertex|triangle) [0-9]+ of '");
  return std::regex_search(text, place);
}

void expect_refused(const BrokenHead& head) {
  try {
    const Rig rig(head);
    ADD_FAILURE() << "became a rig";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(head.kind), std::string::npos) << "names the file: " << message;
    EXPECT_TRUE(contains_one(message, head.says)) << message;
  }
}

void expect_rig(const BrokenHead& head) {
  static Rig sound(broken_head("sound", 1));
  Rig rig(head);
  std::string warnings;
  for (const std::string& warning : rig.report().warnings)
    warnings += warning + "\n";
  EXPECT_TRUE(contains_one(warnings, head.says)) << warnings;
  const bool is_all_of_it = contains_one("face inward", head.says);
  EXPECT_TRUE(is_all_of_it || says_where(warnings)) << warnings;
  for (const char* name : {"exocanthion_left", "exocanthion_right", "pronasale", "cheilion_left", "pogonion"})
    EXPECT_LT(rig.off(name), 0.004) << name;
  rig.pose({});
  for (const char* name : {"pogonion", "cheilion_left", "palpebrale_superius_left"})
    EXPECT_EQ(rig.moved(name).norm(), 0.0) << "moves at rest: " << name;
  struct Pose {
    std::map<std::string, double> values;
    std::vector<std::string> landmarks;
  };
  const Pose poses[] = {
      {{{"arkit:jawOpen", 1.0}}, {"pogonion", "labiale_inferius"}},
      {{{"arkit:eyeBlinkLeft", 1.0}, {"arkit:eyeBlinkRight", 1.0}},
       {"palpebrale_superius_left", "palpebrale_superius_right"}},
      {{{"arkit:mouthSmileLeft", 1.0}, {"arkit:mouthSmileRight", 1.0}}, {"cheilion_left", "cheilion_right"}}};
  for (const Pose& pose : poses) {
    rig.pose(pose.values);
    sound.pose(pose.values);
    const std::string& what = pose.values.begin()->first;
    ASSERT_TRUE(rig.is_finite()) << what;
    for (const std::string& name : pose.landmarks) {
      const Vec3 way = rig.moved(name), wanted = sound.moved(name);
      EXPECT_LT((way - wanted).norm(), 0.0025 + 0.3 * wanted.norm())
          << what << " " << name << ": " << 1e3 * way.transpose() << " for " << 1e3 * wanted.transpose();
    }
    if (head.is_cut) {
      EXPECT_LT(rig.widest_crack(), 2e-5) << what;
    }
  }
}

/// Kinds tried in every run: one of each cause.
bool is_tried_always(const BrokenHead& head) {
  static const std::set<std::string> some = {"triangle_soup",
                                             "pieces_by_material",
                                             "one_half_mirrored_by_its_node",
                                             "backs_on_the_same_vertices",
                                             "second_shell",
                                             "patches_inside_out",
                                             "fins",
                                             "floating_bits",
                                             "collapsed_vertices",
                                             "inside_out",
                                             "no_eyeballs"};
  return !head.is_usable || some.count(head.kind) > 0;
}

class Broken : public ::testing::TestWithParam<std::string> {};

TEST_P(Broken, HeadBecomesARigOrIsRefusedWithTheReason) {
  const char* wanted = std::getenv("FASCIA_BROKEN_HEADS");
  const int seeds = wanted ? std::max(1, std::atoi(wanted)) : 1;
  if (!wanted && !is_tried_always(broken_head(GetParam(), 1)))
    GTEST_SKIP() << "one of each cause is enough here; all of them with FASCIA_BROKEN_HEADS=1";
  for (int seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const BrokenHead head = broken_head(GetParam(), static_cast<unsigned>(seed));
    if (const char* folder = std::getenv("FASCIA_BROKEN_HEADS_TO"))  // to be looked at
      formats::write_bytes(std::filesystem::path(folder) / (std::to_string(seed) + "_" + head.file),
                           head.bytes.data(), head.bytes.size());
    try {
      head.is_usable ? expect_rig(head) : expect_refused(head);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfAllKinds, Broken, ::testing::ValuesIn(broken_kinds()),
                         [](const auto& kind) { return kind.param; });

}  // namespace
}  // namespace fascia::testing
