// A person whose muscles are known to be stronger and weaker than the tables', on the embedded head at low
// detail.
#include "fit/calibration.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/calibrate_depth.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Calibrate : public EmbeddedSubject {
 protected:
  using Named = std::map<std::string, float>;

  /// What a person looks like whose muscles pull `strength` times as much as `set` says.
  static CalibrationCase seen(const std::string& name, const Named& set, const Named& strength) {
    Named pulled = set;
    for (auto& [channel, value] : pulled)
      if (const auto entry = strength.find(channel); entry != strength.end()) value *= entry->second;
    const std::vector<float> values = values_of(pulled);
    subject->pose(values, false);
    return {name,
            {subject->displacements(values), std::vector<double>(subject->vertex_count(), 1.0)},
            values_of(set)};
  }

  /// Length of a region's outline.
  static float girth(const std::vector<rig::Vec3f>& region) {
    float sum = 0.0F;
    for (size_t i = 0; i < region.size(); ++i)
      sum += (region[(i + 1) % region.size()] - region[i]).norm();
    return sum;
  }

  static double gain(const Calibration& calibration, const std::string& channel) {
    return calibration.gains[static_cast<size_t>(subject->channel(channel))];
  }
};

const std::map<std::string, float> weak_smile_strong_brow = {{"zygomaticus_major_superior_left", 0.6F},
                                                             {"zygomaticus_major_superior_right", 0.6F},
                                                             {"frontalis_medial_left", 1.5F},
                                                             {"frontalis_medial_right", 1.5F}};

TEST_F(Calibrate, FindsStrengthsAndHeldOutExpressionsImprove) {
  const Named smile = {{"zygomaticus_major_superior_left", 0.6F}, {"zygomaticus_major_superior_right", 0.6F}};
  const Named brow = {{"frontalis_medial_left", 0.5F}, {"frontalis_medial_right", 0.5F}};
  Named both = smile;
  both.insert(brow.begin(), brow.end());
  Named open_smile = smile;
  open_smile["jaw_open"] = 0.25F;
  std::vector<CalibrationCase> cases;
  for (const auto& [name, set] :
       {std::pair{"smile", smile}, {"brow", brow}, {"both", both}, {"open smile", open_smile}})
    cases.push_back(seen(name, set, weak_smile_strong_brow));
  CalibrationOptions options;
  options.prior = 1e-4;
  const Calibration found = calibrate(*subject, cases, options);
  EXPECT_NEAR(gain(found, "zygomaticus_major_superior_left"), 0.6, 0.06);
  EXPECT_NEAR(gain(found, "frontalis_medial_right"), 1.5, 0.12);
  EXPECT_NEAR(gain(found, "jaw_open"), 1.0, 0.05);
  EXPECT_EQ(gain(found, "mentalis_left"), 1.0) << "nothing was seen of it";
  EXPECT_LT(found.cases[0].before_share, 0.9) << "the smile alone; the jaw outweighs it in the mean";
  EXPECT_GT(found.after_share, 0.99);
  EXPECT_GT(found.left_out_share, found.before_share + 0.5 * (1.0 - found.before_share))
      << "each expression is judged by gains found from the others";
}

TEST_F(Calibrate, APhysiqueChangesOnlyItsOwnFields) {
  const rig::Rig& own = subject->file().rig;
  const rig::Rig other = with_physique(own, {1.0, 0.8, {1.3, 1.0, 0.7}});
  const rig::TissueLevel &before = own.tissue.levels[0], &after = other.tissue.levels[0];
  EXPECT_FLOAT_EQ(after.spring_stiffness[5], 0.8F * before.spring_stiffness[5]);
  EXPECT_FLOAT_EQ(after.skin_membrane[5], 0.8F * before.skin_membrane[5]);
  EXPECT_EQ(after.fibre_strength, before.fibre_strength);
  EXPECT_EQ(after.rest, before.rest);
  std::map<std::string, float> ratio;
  for (size_t m = 0; m < own.muscles.size(); ++m)
    ratio[own.muscles[m].name] = other.muscles[m].peak_shortening / own.muscles[m].peak_shortening;
  EXPECT_FLOAT_EQ(ratio.at("frontalis_medial_left"), 1.3F);
  EXPECT_FLOAT_EQ(ratio.at("orbicularis_oculi_orbital_lower_left"), 1.0F);
  EXPECT_FLOAT_EQ(ratio.at("mentalis_right"), 0.7F);
  for (size_t f = 0; f < before.fibre_shortest.size(); ++f) {
    if (own.muscles[before.fibre_muscle[f]].name == "mentalis_right") {
      EXPECT_NEAR(1.0F - after.fibre_shortest[f], 0.7F * (1.0F - before.fibre_shortest[f]), 1e-5F);
    }
  }
  for (const rig::Muscle& muscle : with_physique(own, {1.0, 1.0, {9.0, 9.0, 9.0}}).muscles)
    EXPECT_LE(muscle.peak_shortening, 0.5F);
}

/// Muscles of the lower face that shorten more, in softer tissue: gains alone explain less of it than a
/// physique does.
TEST_F(Calibrate, APhysiqueIsFoundAndServesExpressionsLeftOut) {
  const Remake remake = [](const Physique& physique) -> std::unique_ptr<Subject> {
    if (physique.takes_build()) return nullptr;
    rig::RigFile file = subject->file();
    file.rig = with_physique(std::move(file.rig), physique);
    return std::make_unique<Subject>(std::move(file), "low");
  };
  const std::unique_ptr<Subject> person = remake({1.0, 0.75, {1.0, 1.0, 1.35}});
  std::vector<CalibrationCase> cases;
  for (const auto& [name, set] :
       {std::pair<std::string, Named>{
            "smile", {{"zygomaticus_major_superior_left", 0.9F}, {"zygomaticus_major_superior_right", 0.9F}}},
        {"frown", {{"depressor_anguli_oris_left", 0.9F}, {"depressor_anguli_oris_right", 0.9F}}},
        {"chin", {{"mentalis_left", 0.9F}, {"mentalis_right", 0.9F}}},
        {"half a smile",
         {{"zygomaticus_major_superior_left", 0.4F}, {"zygomaticus_major_superior_right", 0.4F}}},
        {"brows", {{"frontalis_medial_left", 0.9F}, {"frontalis_medial_right", 0.9F}}}}) {
    person->pose(values_of(set), false);
    cases.push_back(
        {name,
         {person->displacements(values_of(set)), std::vector<double>(subject->vertex_count(), 1.0)},
         values_of(set)});
  }
  const Calibration gains = calibrate(*subject, cases), all = calibrate(*subject, cases, {}, remake);
  EXPECT_EQ(gains.physique, Physique());
  EXPECT_LT(all.physique.stiffness, 0.95);
  EXPECT_EQ(all.physique.depth, 1.0) << "another depth cannot be made here";
  EXPECT_GT(all.after_share, gains.after_share);
  EXPECT_LT(1.0 - all.left_out_share, 0.9 * (1.0 - gains.left_out_share));
  EXPECT_DOUBLE_EQ(all.before_share, gains.before_share);
}

/// The same muscles weak in one expression and strong in the next: what one says makes the other worse.
TEST_F(Calibrate, GainsThatExpressionsLeftOutContradictAreNotKept) {
  const Named smile = {{"zygomaticus_major_superior_left", 0.5F}, {"zygomaticus_major_superior_right", 0.5F}};
  Named open_smile = smile;
  open_smile["jaw_open"] = 0.3F;
  const Named weak = {{"zygomaticus_major_superior_left", 0.4F}, {"zygomaticus_major_superior_right", 0.4F}};
  const Named strong = {{"zygomaticus_major_superior_left", 2.0F},
                        {"zygomaticus_major_superior_right", 2.0F}};
  CalibrationOptions options;
  options.prior = 1e-6;
  const Calibration found =
      calibrate(*subject, {seen("smile", smile, weak), seen("open smile", open_smile, strong)}, options);
  EXPECT_GE(found.left_out_share, found.before_share - 1e-12);
  EXPECT_LT(found.gains_kept, 1.0);
}

TEST_F(Calibrate, TheAveragePersonIsUnchanged) {
  const Named smile = {{"zygomaticus_major_superior_left", 0.6F}, {"zygomaticus_major_superior_right", 0.6F}};
  const Calibration found = calibrate(*subject, {seen("smile", smile, {})});
  for (const double one : found.gains)
    EXPECT_NEAR(one, 1.0, 0.02);
}

TEST_F(Calibrate, TheToolWritesARigWithTablesOfItsOwn) {
  fs::create_directories(*folder / "scans");
  for (const char* name : {"browInnerUp", "mouthSmileLeft", "mouthSmile_R"}) {
    const std::string member = name == std::string("mouthSmile_R") ? "mouthSmileRight" : name;
    ASSERT_EQ(run("pose " + at("rig.glb") + " --set arkit:" + member + "=0.6 --level low -o " + at("scans") +
                  "/" + name + ".obj --quiet")
                  .code,
              0);
  }
  std::ofstream(at("scans/notes.txt")) << "not a mesh";
  const cli::Outcome done = run("calibrate " + at("rig.glb") + " --scans " + at("scans") +
                                " --adjust gains -o " + at("own.glb") + " --json");
  ASSERT_EQ(done.code, 0) << done.err;
  const json report = json::parse(done.out);
  EXPECT_GT(report["after_share"].get<double>(), report["before_share"].get<double>());
  EXPECT_EQ(report["expressions"].size(), 3u);
  EXPECT_EQ(run("info " + at("own.glb") + " --validate --quiet").code, 0);
  const rig::RigFile before = rig::read(formats::read_bytes(at("rig.glb"))),
                     after = rig::read(formats::read_bytes(at("own.glb")));
  EXPECT_NE(before.rig.actuation.sets[0].weights, after.rig.actuation.sets[0].weights);
  EXPECT_EQ(before.primitives.size(), after.primitives.size());

  EXPECT_TRUE(report["physique"].contains("tissue_depth"));

  // The prior weighs what is seen against the tables.
  const auto farthest_gain = [](const json& from) {
    double most = 0.0;
    for (const auto& [name, gain] : from["gains"].items())
      most = std::max(most, std::abs(gain.get<double>() - 1.0));
    return most;
  };
  const cli::Outcome strict = run("calibrate " + at("rig.glb") + " --scans " + at("scans") +
                                  " --adjust gains --prior 1000 -o " + at("strict.glb") + " --json");
  ASSERT_EQ(strict.code, 0) << strict.err;
  EXPECT_GT(farthest_gain(report), 0.2) << "the scans were made with 0.6";
  EXPECT_LT(farthest_gain(json::parse(strict.out)), 0.01);

  fs::create_directories(*folder / "nothing");
  EXPECT_EQ(run("calibrate " + at("rig.glb") + " --scans " + at("nothing") + " -o " + at("x.glb")).code, 1);
  EXPECT_FALSE(fs::exists(at("x.glb")));
}

TEST_F(Calibrate, MusclesOfAThirdAreBuiltBroader) {
  const std::vector<uint8_t> bytes = formats::read_bytes(at("rig.glb"));
  const rig::RigFile file = rig::read(bytes);
  cli::RebuiltRig rebuilt(bytes, file);
  Physique broad;
  broad.breadth[2] = 1.3;
  EXPECT_TRUE(broad.takes_build());
  const rig::Rig* other = rebuilt.at(broad, "low");
  ASSERT_NE(other, nullptr) << rebuilt.fault();
  EXPECT_EQ(rebuilt.at(broad, "low"), other) << "kept";
  std::map<std::string, float> ratio;
  for (size_t m = 0; m < file.rig.muscles.size(); ++m)
    if (!file.rig.muscles[m].origin_region.empty())
      ratio[file.rig.muscles[m].name] =
          girth(other->muscles[m].origin_region) / girth(file.rig.muscles[m].origin_region);
  EXPECT_GT(ratio.at("depressor_anguli_oris_left"), 1.1F);
  EXPECT_NEAR(ratio.at("frontalis_medial_left"), 1.0F, 1e-3F) << "another third";
  EXPECT_NEAR(ratio.at("masseter_superficial_left"), 1.0F, 1e-3F) << "no mimic muscle";
}

/// The same skin over a skull that lies deeper.
TEST_F(Calibrate, TheToolFindsTheDepthOfTheTissue) {
  fs::create_directories(*folder / "deep");
  ASSERT_EQ(run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
                " --detail low --tissue-scale 1.3 -o " + at("deep.glb") + " --quiet")
                .code,
            0);
  for (const std::string name : {"mouthSmileLeft", "mouthFrownRight", "browInnerUp", "noseSneerLeft"})
    ASSERT_EQ(run("pose " + at("deep.glb") + " --set arkit:" + name + "=1 --level low -o " +
                  at("deep/" + name + ".obj") + " --quiet")
                  .code,
              0);
  const auto calibrated = [&](const std::string& adjust) {
    const cli::Outcome done = run("calibrate " + at("rig.glb") + " --scans " + at("deep") + " -o " +
                                  at("own_depth.glb") + " --adjust " + adjust + " --json");
    EXPECT_EQ(done.code, 0) << done.err;
    return json::parse(done.out);
  };
  const json gains = calibrated("gains"), all = calibrated("all");
  EXPECT_EQ(gains["physique"]["tissue_depth"], 1.0);
  EXPECT_EQ(gains["physique"]["muscle_breadth_lower_face"], 1.0);
  EXPECT_GT(all["physique"]["tissue_depth"], 1.05);
  EXPECT_GE(all["after_share"], gains["after_share"]);
  EXPECT_EQ(run("info " + at("own_depth.glb") + " --validate --quiet").code, 0);
  const auto thickness = [](const rig::RigFile& file) {
    double sum = 0.0;
    for (const rig::Landmark& landmark : file.rig.skull.landmarks)
      sum += static_cast<double>(landmark.depth);
    return sum;
  };
  EXPECT_GT(thickness(rig::read(formats::read_bytes(at("own_depth.glb")))),
            1.03 * thickness(rig::read(formats::read_bytes(at("rig.glb")))));
}

}  // namespace
}  // namespace fascia::fit
