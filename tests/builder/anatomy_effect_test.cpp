#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/fields.h"
#include "builder/rigging/embedded_head.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/rigging/stages.h"
#include "builder/tissue/build.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/model/fields.h"
#include "tests/builder/field_digest.h"

/// Whatever a specialist corrects in the anatomy changes the rig: each number of mechanics.json by itself,
/// the other files list by list. (That every single number of those is read is test_anatomy's to show.)
namespace fascia::testing {

namespace {

namespace fs = std::filesystem;
using anatomy::GenericAnatomy;
using anatomy::Json;
using Pointer = Json::json_pointer;

/// The stages of a build of the generic head, each to be run alone with a changed anatomy.
class Stages {
 public:
  Stages() {
    const fs::path folder = fs::path(::testing::TempDir()) / "fascia_anatomy_effect";
    fs::create_directories(folder);
    rigging::write_embedded_head(folder / "head.obj", folder / "landmarks.json");
    scene_ = formats::read(folder / "head.obj");
    found_ =
        rigging::find_landmarks(scene_, formats::read_landmarks(folder / "landmarks.json"), anatomy_, {});
    for (const auto& [name, landmark] : found_.landmarks)
      points_[name] = landmark.position;
    skull_ = rigging::fit_skull(anatomy_, found_, 1.0);
    smas_ = smas_of(anatomy_);
    rigging::BuildReport report;
    rig_.muscles = rigging::build_muscles(anatomy_, found_.head, skull_, smas_, points_, {}, report);
    rig_.skull = rigging::rig_skull(skull_, found_.head, found_.landmarks);
    rig_.smas = rigging::rig_smas(smas_, skull_, anatomy_);
    rig_.actuation = rigging::rig_actuation(anatomy_, rig_.muscles);
    inputs_ = rigging::tissue_inputs(scene_, found_.head, skull_, smas_, points_, anatomy_.mechanics, rig_);
  }

  const GenericAnatomy& anatomy() const { return anatomy_; }

  uint64_t skull(const GenericAnatomy& changed) const {
    FieldDigest digest;
    const skull::FitResult fitted = rigging::fit_skull(changed, found_, 1.0);
    const rig::Skull built = rigging::rig_skull(fitted, found_.head, found_.landmarks);
    rig::skull_fields(digest, built);
    return digest.value();
  }
  uint64_t jaw(const GenericAnatomy& changed) const {
    skull::FitResult fitted = skull_;
    fitted.jaw.motion = changed.mechanics.jaw;
    FieldDigest digest;
    const rig::Skull built = rigging::rig_skull(fitted, found_.head, found_.landmarks);
    rig::skull_fields(digest, built);
    return digest.value();
  }
  uint64_t smas(const GenericAnatomy& changed) const {
    FieldDigest digest;
    const rig::Smas built = rigging::rig_smas(smas_of(changed), skull_, changed);
    rig::smas_fields(digest, built);
    return digest.value();
  }
  uint64_t zones(const GenericAnatomy& changed) const {
    FieldDigest digest;
    const rig::Smas built = rigging::rig_smas(smas_, skull_, changed);
    rig::smas_fields(digest, built);
    return digest.value();
  }
  uint64_t muscles(const GenericAnatomy& changed, const rigging::Edits& edits = {}) const {
    rigging::BuildReport report;
    FieldDigest digest;
    for (const rig::Muscle& muscle :
         rigging::build_muscles(changed, found_.head, skull_, smas_, points_, edits, report)) {
      rig::muscle_fields(digest, muscle);
      digest.list("", muscle.points);
      digest.list("", muscle.fibre_offsets);
      digest.list("", muscle.origin_region);
      digest.list("", muscle.insertion_region);
    }
    return digest.value();
  }
  uint64_t muscles_alone(const GenericAnatomy& changed) const { return muscles(changed); }
  uint64_t actuation(const GenericAnatomy& changed) const {
    FieldDigest digest;
    const rig::Actuation built = rigging::rig_actuation(changed, rig_.muscles);
    rig::actuation_fields(digest, built);
    return digest.value();
  }
  uint64_t tissue(const GenericAnatomy& changed) const { return lattice(inputs_, changed, false); }
  /// With what touches what, and the ligaments.
  uint64_t touching(const GenericAnatomy& changed) const { return lattice(inputs_, changed, true); }
  /// Of a head without eyeballs, which are then found.
  uint64_t eyeless(const GenericAnatomy& changed) const {
    tissue::TissueInputs inputs = inputs_;
    inputs.eye_left.radius = inputs.eye_right.radius = 0.0F;
    return lattice(inputs, changed, false);
  }

 private:
  /// Coarse, for there are many.
  static uint64_t lattice(tissue::TissueInputs inputs, const GenericAnatomy& changed, bool contact) {
    inputs.mechanics = changed.mechanics;
    tissue::TissueOptions options;
    options.levels = {{"coarse", 350}};
    options.contact = contact;
    FieldDigest digest;
    const tissue::TissueResult built = tissue::build(inputs, options);
    for (const rig::TissueLevel& level : built.tissue.levels)
      rig::tissue_level_fields(digest, level, rig::TissueLimits{});
    rig::mechanics_fields(digest, built.tissue.mechanics.value());
    return digest.value();
  }
  smas::Result smas_of(const GenericAnatomy& anatomy) const {
    smas::Inputs inputs = smas::inputs_from(anatomy);
    inputs.skin = &found_.head.skin;
    inputs.cranium = &skull_.cranium;
    inputs.mandible = &skull_.mandible;
    inputs.landmarks = points_;
    return smas::build(inputs);
  }

  GenericAnatomy anatomy_ = anatomy::load_generic();
  formats::Scene scene_;
  rigging::FoundLandmarks found_;
  Landmarks points_;
  skull::FitResult skull_;
  smas::Result smas_;
  rig::Rig rig_;
  tissue::TissueInputs inputs_;
};

const Stages& stages() {
  static const Stages all;
  return all;
}

using Stage = uint64_t (Stages::*)(const GenericAnatomy&) const;

/// The stage that a section of mechanics.json is for.
Stage stage_of(const std::string& section, const std::string& name) {
  if (section == "jaw") return &Stages::jaw;
  if (section == "smas_shape") return &Stages::smas;
  if (section == "muscles") return &Stages::muscles_alone;
  if (name == "free_travel") return &Stages::zones;
  if (section == "contact" || section == "ligaments") return &Stages::touching;
  return name.starts_with("globe_") ? &Stages::eyeless : &Stages::tissue;
}

/// The anatomy with `text` for mechanics.json; throws when it is refused.
GenericAnatomy with_mechanics(const Json& document) {
  GenericAnatomy changed = stages().anatomy();
  changed.mechanics = {};
  anatomy::load_mechanics(
      anatomy::DataFiles(std::map<std::string, std::string>{{"mechanics.json", document.dump()}}), changed);
  return changed;
}

/// The anatomy with number `at` changed to each of some values in turn that the reader allows: a tenth more,
/// a tenth less, and for thresholds that nothing of this head lies within a tenth of, the ends of the range.
std::vector<GenericAnatomy> changes_of(const Json& document, const Pointer& at, const Json& range) {
  std::vector<GenericAnatomy> changes;
  const double value = document[at].get<double>();
  for (const double to : {1.1 * value, 0.9 * value, range[1].get<double>(), range[0].get<double>()}) {
    if (to == value) continue;
    Json trial = document;
    trial[at] = to;
    try {
      changes.push_back(with_mechanics(trial));
    } catch (const Error&) {
    }
  }
  return changes;
}

TEST(AnatomyEffect, EveryConstantOfTheMechanicsChangesTheRig) {
  const Json document = Json::parse(anatomy::embedded_file("mechanics.json"));
  const auto run = [](Stage stage, const GenericAnatomy& anatomy) { return (stages().*stage)(anatomy); };
  const Stage all[] = {&Stages::jaw,    &Stages::smas,     &Stages::zones,  &Stages::muscles_alone,
                       &Stages::tissue, &Stages::touching, &Stages::eyeless};
  std::vector<uint64_t> before;
  for (const Stage stage : all)
    before.push_back(run(stage, stages().anatomy()));
  int tried = 0;
  for (const auto& [section, entries] : document["sections"].items())
    for (const auto& [name, entry] : entries.items()) {
      if (name == "means") continue;
      const auto kind =
          static_cast<size_t>(std::find(std::begin(all), std::end(all), stage_of(section, name)) - all);
      const Pointer at = Pointer("/sections") / section / name / "value";
      std::vector<Pointer> numbers = {at};
      if (entry["value"].is_array()) numbers = {at / 0, at / 1};
      for (const Pointer& number : numbers) {
        ++tried;
        const std::vector<GenericAnatomy> changes = changes_of(document, number, entry["range"]);
        ASSERT_FALSE(changes.empty()) << number;
        EXPECT_TRUE(std::any_of(
            changes.begin(), changes.end(),
            [&](const GenericAnatomy& changed) { return run(all[kind], changed) != before[kind]; }))
            << number << ": no stage uses it";
      }
    }
  EXPECT_GT(tried, 130);
}

TEST(AnatomyEffect, EveryPlaceOfTheFaceChangesTheRig) {
  const Json document = Json::parse(anatomy::embedded_file("mechanics.json"));
  const uint64_t before = stages().tissue(stages().anatomy());
  const std::vector<std::pair<std::string, std::vector<std::string>>> fields = {
      {"attachment_regions", {"/centre/0/share", "/offset/1", "/radius", "/bone", "/skin"}},
      {"holds", {"/centre/0/share", "/offset/1", "/radius", "/factor"}}};
  // Field by field in all entries at once: that each entry is read is test_anatomy's to show.
  for (const auto& [list, names] : fields)
    for (const std::string& name : names) {
      Json trial = document;
      for (Json& entry : trial[list]) {
        Json& number = entry[Pointer(name)];
        for (Json* one : number.is_array() ? std::vector<Json*>{&number[0], &number[1], &number[2]}
                                           : std::vector<Json*>{&number})
          *one = 1.1 * one->get<double>();
      }
      EXPECT_NE(stages().tissue(with_mechanics(trial)), before) << list << name;
    }
}

TEST(AnatomyEffect, EveryZoneDepthAndLigamentChangesTheRig) {
  const uint64_t zones = stages().zones(stages().anatomy()), smas = stages().smas(stages().anatomy());
  const auto expect = [&](Stage stage, uint64_t before, const std::string& what, const auto& change) {
    GenericAnatomy changed = stages().anatomy();
    change(changed.tissue);
    EXPECT_NE((stages().*stage)(changed), before) << what << " changes nothing";
  };
  for (auto list : {&anatomy::Tissue::skin_attachments, &anatomy::Tissue::gliding_planes})
    for (size_t i = 0; i < (stages().anatomy().tissue.*list).size(); ++i) {
      const std::string& name = (stages().anatomy().tissue.*list)[i].name;
      expect(&Stages::zones, zones, name, [&](anatomy::Tissue& t) { (t.*list)[i].value *= 0.9; });
      expect(&Stages::zones, zones, name, [&](anatomy::Tissue& t) { (t.*list)[i].falloff *= 1.1; });
      expect(&Stages::zones, zones, name, [&](anatomy::Tissue& t) {
        for (Vec3& corner : (t.*list)[i].polygon)
          corner *= 1.02;
      });
    }
  for (size_t i = 0; i < stages().anatomy().tissue.ligaments.size(); ++i) {
    const std::string& name = stages().anatomy().tissue.ligaments[i].name;
    expect(&Stages::zones, zones, name, [&](anatomy::Tissue& t) { t.ligaments[i].stiffness *= 1.1; });
    expect(&Stages::zones, zones, name, [&](anatomy::Tissue& t) { t.ligaments[i].bone[0] *= 1.1; });
    expect(&Stages::zones, zones, name, [&](anatomy::Tissue& t) { t.ligaments[i].skin[0] *= 1.1; });
  }
  expect(&Stages::zones, zones, "elsewhere", [](anatomy::Tissue& t) { t.skin_attachment *= 1.1; });
  expect(&Stages::zones, zones, "elsewhere", [](anatomy::Tissue& t) { t.glide *= 1.1; });
  expect(&Stages::smas, smas, "fraction", [](anatomy::Tissue& t) {
    for (anatomy::SmasDepth& site : t.smas_depths)
      site.fraction *= 1.1;
  });
  expect(&Stages::smas, smas, "free_depth", [](anatomy::Tissue& t) {
    for (anatomy::SmasDepth& site : t.smas_depths)
      site.free_depth *= 1.1;
  });
}

TEST(AnatomyEffect, EveryFieldOfAMuscleChangesTheRig) {
  const uint64_t before = stages().muscles(stages().anatomy());
  const auto expect = [&](const char* what, const std::function<void(anatomy::Muscle&)>& change) {
    GenericAnatomy changed = stages().anatomy();
    for (anatomy::Muscle& muscle : changed.muscles)
      change(muscle);
    EXPECT_NE(stages().muscles(changed), before) << what << " changes nothing";
  };
  const auto moved = [](std::vector<Vec3>& points) {
    for (Vec3& point : points)
      point *= 1.02;
  };
  expect("origin", [&](anatomy::Muscle& m) { moved(m.origin.polygon); });
  expect("insertion", [&](anatomy::Muscle& m) { moved(m.insertion.polygon); });
  expect("waypoints", [&](anatomy::Muscle& m) { moved(m.waypoints); });
  expect("depth_fraction", [](anatomy::Muscle& m) {
    for (double& fraction : m.depth_fraction)
      fraction *= 0.9;
  });
  expect("peak_shortening", [](anatomy::Muscle& m) { m.peak_shortening *= 1.1; });
  expect("cross_section", [](anatomy::Muscle& m) { m.cross_section *= 1.1; });
  expect("band, inner", [](anatomy::Muscle& m) {
    if (m.band) m.band->inner *= 1.1;
  });
  expect("band, outer", [](anatomy::Muscle& m) {
    if (m.band) m.band->outer *= 1.1;
  });
  expect("band, begin", [](anatomy::Muscle& m) {
    if (m.band) m.band->begin_angle += 0.1;
  });
  expect("band, end", [](anatomy::Muscle& m) {
    if (m.band) m.band->end_angle -= 0.1;
  });
}

TEST(AnatomyEffect, LandmarksDepthsChannelsAndTablesChangeTheRig) {
  const uint64_t skull = stages().skull(stages().anatomy()),
                 actuation = stages().actuation(stages().anatomy());
  const auto expect = [&](Stage stage, uint64_t before, const char* what,
                          const std::function<void(GenericAnatomy&)>& change) {
    GenericAnatomy changed = stages().anatomy();
    change(changed);
    EXPECT_NE((stages().*stage)(changed), before) << what << " changes nothing";
  };
  expect(&Stages::skull, skull, "bone", [](GenericAnatomy& a) {
    for (anatomy::Landmark& landmark : a.landmarks)
      if (landmark.bone) *landmark.bone *= 1.02;
  });
  expect(&Stages::skull, skull, "skin", [](GenericAnatomy& a) {
    for (anatomy::Landmark& landmark : a.landmarks)
      if (landmark.skin) *landmark.skin *= 1.02;
  });
  expect(&Stages::skull, skull, "curves", [](GenericAnatomy& a) {
    for (anatomy::Curve& curve : a.curves)
      for (Vec3& point : curve.points)
        point *= 1.02;
  });
  expect(&Stages::skull, skull, "mean depth", [](GenericAnatomy& a) {
    for (anatomy::TissueDepth& depth : a.depth_tables.front().depths)
      depth.mean *= 1.1;
  });
  expect(&Stages::skull, skull, "deviation", [](GenericAnatomy& a) {
    for (anatomy::TissueDepth& depth : a.depth_tables.front().depths)
      depth.deviation *= 1.1;
  });
  expect(&Stages::skull, skull, "skull.obj", [](GenericAnatomy& a) {
    for (anatomy::MeshObject& object : a.skull)
      for (Vec3& point : object.mesh.vertices)
        point *= 1.01;
  });
  for (auto field : {&anatomy::Actuator::minimum, &anatomy::Actuator::maximum, &anatomy::Actuator::rest})
    expect(&Stages::actuation, actuation, "channel", [&](GenericAnatomy& a) {
      for (anatomy::Actuator& actuator : a.actuators)
        actuator.*field += 0.1;
    });
  for (size_t set = 0; set < stages().anatomy().expression_sets.size(); ++set)
    for (size_t i = 0; i < stages().anatomy().expression_sets[set].expressions.size(); ++i) {
      if (stages().anatomy().expression_sets[set].expressions[i].weights.empty()) continue;
      expect(&Stages::actuation, actuation,
             stages().anatomy().expression_sets[set].expressions[i].name.c_str(),
             [&](GenericAnatomy& a) { a.expression_sets[set].expressions[i].weights[0].second *= 1.1; });
    }
}

}  // namespace
}  // namespace fascia::testing
