// `fascia fit` by its options, and takes that come in several files, on the embedded head at low detail.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/scene.h"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class FitTool : public EmbeddedSubject {
 protected:
  static void SetUpTestSuite() {
    EmbeddedSubject::SetUpTestSuite();
    must("pose " + at("rig.glb") + " --set zygomaticus_minor_left=0.7 --set jaw_open=0.3 -o " +
         at("posed.obj"));
    std::ofstream(at("take.csv")) << "time,zygomaticus_minor_left,jaw_open,eye_yaw_left\n"
                                     "0,0,0,0\n0.2,0.6,0.3,0.25\n0.4,0.6,0.3,0.25\n";
  }

  static cli::Outcome must(const std::string& arguments) {
    const cli::Outcome done = run(arguments);
    EXPECT_EQ(done.code, 0) << arguments << "\n" << done.err;
    return done;
  }
  static std::string fitting(const std::string& target, const std::string& more, const std::string& out) {
    return "fit " + at("rig.glb") + " --target " + at(target) + " " + more + " -o " + at(out) + " --json";
  }
  static json fit(const std::string& target, const std::string& more = "",
                  const std::string& out = "a.json") {
    const cli::Outcome done = must(fitting(target, more, out));
    return done.code == 0 ? json::parse(done.out) : json();
  }
  /// What a fit of one target found, 0 for what it left at rest.
  static double value(const json& report, const std::string& channel) {
    return report["activations"].value(channel, 0.0);
  }
  static double largest(const json& report) {
    double most = 0.0;
    for (const auto& [name, found] : report["activations"].items())
      most = std::max(most, std::abs(found.get<double>()));
    return most;
  }
  static json curves(const std::string& name) {
    std::ifstream file(at(name));
    return json::parse(file);
  }
  static void play(const std::string& out) {
    must("play " + at("rig.glb") + " --curves " + at("take.csv") + " --fps 30 --level low -o " + at(out));
  }
};

/// `play` writes a cache for each of a head's meshes; any of them stands for all, and so does their name.
TEST_F(FitTool, CachesOfAllMeshesAreOneTake) {
  ASSERT_GT(subject->file().primitives.size(), 3U);
  for (const std::string kind : {"pc2", "mdd"}) {
    const std::string common = "all." + kind;
    play(common);
    ASSERT_FALSE(fs::exists(at(common)));
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(*folder))
      if (const std::string name = entry.path().filename().string();
          name.rfind("all.", 0) == 0 && name.ends_with(kind))
        files.push_back(name);
    ASSERT_GT(files.size(), 2U);
    std::sort(files.begin(), files.end());
    for (const std::string& target : {common, files.front(), files.back()}) {
      const json report = fit(target, "--fps 30 --smoothness 0", "curves.json");
      EXPECT_GT(report["share"].get<double>(), 0.99) << target;
      EXPECT_TRUE(report["converged"].get<bool>()) << target;
      const json found = curves("curves.json");
      ASSERT_EQ(found["jaw_open"]["values"].size(), 13U) << target;
      EXPECT_NEAR(found["jaw_open"]["values"].back().get<double>(), 0.3, 0.01) << target;
      EXPECT_NEAR(found["zygomaticus_minor_left"]["values"].back().get<double>(), 0.6, 0.03) << target;
      EXPECT_NEAR(found["eye_yaw_left"]["values"].back().get<double>(), 0.25, 0.001)
          << target << ": by the mesh of the eye, which is in another file than the jaw's teeth";
      EXPECT_NEAR(found["jaw_open"]["times"].back().get<double>(), 0.4, 1e-5) << target;
    }
  }
}

TEST_F(FitTool, CachesOfAnotherTakeAreNotMixedIn) {
  play("mixed.pc2");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(*folder))
    if (entry.path().filename().string().rfind("mixed.", 0) == 0) files.push_back(entry.path());
  ASSERT_GT(files.size(), 2U);
  std::sort(files.begin(), files.end());
  const fs::path last = files.back();
  fs::rename(last, last.string() + ".away");
  const cli::Outcome fewer = must(fitting("mixed.pc2", "", "b.csv"));
  EXPECT_NE(fewer.err.find(last.filename().string()), std::string::npos) << fewer.err;

  // The missing file with a frame less.
  std::ifstream whole(last.string() + ".away", std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  ASSERT_EQ(bytes[28], 13);
  bytes[28] = 12;
  std::ofstream(last, std::ios::binary) << bytes;
  const cli::Outcome refused = run(fitting("mixed.pc2", "", "c.csv"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("one take"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find(last.filename().string()), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(at("c.csv")));
}

TEST_F(FitTool, HeadPoseIsTakenOutOrKept) {
  std::ifstream posed(at("posed.obj"));
  std::ofstream moved(at("moved.obj"));
  const Mat4 to_metres = subject->file().rig.input_to_metres.cast<double>();
  const double shift = 0.004 / to_metres.topLeftCorner<3, 1>().norm();
  for (std::string line; std::getline(posed, line);) {
    std::istringstream words(line);
    std::string kind;
    double x = 0, y = 0, z = 0;
    if (line.rfind("v ", 0) == 0 && words >> kind >> x >> y >> z)
      moved << "v " << x + shift << ' ' << y << ' ' << z << '\n';
    else
      moved << line << '\n';
  }
  moved.close();
  const json free = fit("moved.obj"), fixed = fit("moved.obj", "--head-pose fixed");
  EXPECT_NEAR(value(free, "zygomaticus_minor_left"), 0.7, 0.03);
  EXPECT_NEAR(value(free, "jaw_open"), 0.3, 0.01);
  EXPECT_LT(free["rms_mm"].get<double>(), 0.1);
  EXPECT_GT(fixed["rms_mm"].get<double>(), 1.5) << "no muscle moves the head by 4 mm";
}

TEST_F(FitTool, AsTellsWhatAFileIs) {
  play("take.glb");
  const json take = fit("take.glb", "--as take", "take.json");
  EXPECT_EQ(take["targets"].size(), curves("take.json")["jaw_open"]["times"].size());
  EXPECT_NEAR(curves("take.json")["jaw_open"]["values"].back().get<double>(), 0.3, 0.02);
  EXPECT_EQ(curves("take.json"), [] {
    fit("take.glb", "", "auto.json");
    return curves("auto.json");
  }()) << "with an animation, it is one by itself";
  const json mesh = fit("take.glb", "--as mesh");
  EXPECT_LT(largest(mesh), 0.01) << "the file's base is the face at rest";
  const json shapes = fit("take.glb", "--as shapes", "shapes.csv");
  ASSERT_TRUE(shapes.contains("targets"));
  EXPECT_LT(shapes["targets"].size(), take["targets"].size()) << "a few components make the whole take";
  const json scan = fit("posed.obj", "--as scan");
  EXPECT_TRUE(scan.contains("matched_share"));
  EXPECT_NEAR(value(scan, "jaw_open"), 0.3, 0.05);
  EXPECT_FALSE(fit("posed.obj").contains("matched_share"));
  const cli::Outcome refused = run(fitting("posed.obj", "--as take", "x.csv"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("morph"), std::string::npos) << refused.err;
}

/// The penalties by what they do at their ends.
TEST_F(FitTool, RidgeAndSparsityDrawToRest) {
  const json usual = fit("posed.obj"), ridge = fit("posed.obj", "--ridge 1000"),
             some = fit("posed.obj", "--ridge 0.1"), sparse = fit("posed.obj", "--sparsity 1000");
  EXPECT_NEAR(value(usual, "zygomaticus_minor_left"), 0.7, 0.03);
  EXPECT_LT(value(ridge, "zygomaticus_minor_left"), 0.01);
  EXPECT_LT(value(ridge, "jaw_open"), 0.1) << "which moves more, and so is dearer to miss";
  EXPECT_GT(largest(ridge), 0.0) << "a square is nothing near 0";
  EXPECT_GT(value(some, "zygomaticus_minor_left"), 0.1);
  EXPECT_LT(value(some, "zygomaticus_minor_left"), 0.65);
  EXPECT_EQ(largest(sparse), 0.0) << "a size is not";
}

TEST_F(FitTool, SmoothnessHoldsFromFrameToFrame) {
  play("smooth.pc2");
  const auto span = [&](const std::string& smoothness) {
    fit("smooth.pc2", "--fps 30 --smoothness " + smoothness, "smooth.json");
    const json found = curves("smooth.json");
    if (!found.contains("zygomaticus_minor_left")) return 0.0;
    const json& values = found["zygomaticus_minor_left"]["values"];
    return values.back().get<double>() - values.front().get<double>();
  };
  EXPECT_NEAR(span("0"), 0.6, 0.03);
  EXPECT_LT(span("1000"), 0.05);
}

}  // namespace
}  // namespace fascia::fit
