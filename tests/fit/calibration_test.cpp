// A person whose muscles are known to be stronger and weaker than the tables', on the embedded head at low
// detail.
#include "fit/calibration.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

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

TEST_F(Calibrate, TheTablesOwnPersonStaysAsTheyAre) {
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
  const cli::Outcome done =
      run("calibrate " + at("rig.glb") + " --scans " + at("scans") + " -o " + at("own.glb") + " --json");
  ASSERT_EQ(done.code, 0) << done.err;
  const json report = json::parse(done.out);
  EXPECT_GT(report["after_share"].get<double>(), report["before_share"].get<double>());
  EXPECT_EQ(report["expressions"].size(), 3u);
  EXPECT_EQ(run("info " + at("own.glb") + " --validate --quiet").code, 0);
  const rig::RigFile before = rig::read(formats::read_bytes(at("rig.glb"))),
                     after = rig::read(formats::read_bytes(at("own.glb")));
  EXPECT_NE(before.rig.actuation.sets[0].weights, after.rig.actuation.sets[0].weights);
  EXPECT_EQ(before.primitives.size(), after.primitives.size());

  fs::create_directories(*folder / "nothing");
  EXPECT_EQ(run("calibrate " + at("rig.glb") + " --scans " + at("nothing") + " -o " + at("x.glb")).code, 1);
  EXPECT_FALSE(fs::exists(at("x.glb")));
}

}  // namespace
}  // namespace fascia::fit
