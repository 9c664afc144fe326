// A user's own landmarks, regions, strengths and muscles, kept in a file over rebuilds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "anatomy/anatomy.h"
#include "builder/rigging/embedded_head.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Edits : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / "fascia_edits_test");
    fs::remove_all(*folder);
    fs::create_directories(*folder);
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    skin = new std::vector<Vec3>();
    const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
    for (const Vec3& p : anatomy.head_object("skin")->mesh.vertices)
      skin->push_back(1e3 * p);
    plain = new json(build(json()));
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
    delete skin;
    delete plain;
  }

  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static Outcome run(const std::string& arguments) { return run_tool(*folder, arguments); }

  /// Builds with the edits; the report.
  static json build(const json& edits, const std::string& more = "", const std::string& out = "rig.glb") {
    std::ofstream(at("edits.json")) << edits.dump(1);
    const Outcome outcome =
        run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") + " --detail low --json -o " +
            at(out) + (edits.is_null() ? "" : " --edits " + at("edits.json")) + " " + more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }

  static void expect_refused(const std::string& edits, const std::string& says) {
    std::ofstream(at("wrong.json")) << edits;
    const Outcome outcome = run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") +
                                " --detail low -o " + at("wrong.glb") + " --edits " + at("wrong.json"));
    EXPECT_EQ(outcome.code, 1) << edits << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << edits << "\n" << outcome.err;
    EXPECT_FALSE(fs::exists(at("wrong.glb"))) << edits;
  }

  /// The place of the skin nearest to (x, y) seen from the front, millimetres.
  static Vec3 front(double x, double y) {
    const Vec3* best = nullptr;
    double nearest = 1e300;
    for (const Vec3& p : *skin) {
      const double off = std::hypot(p[0] - x, p[1] - y) - 0.3 * p[2];  // before what lies behind it
      if (off < nearest) nearest = off, best = &p;
    }
    return *best;
  }
  static json patch(double x, double y, double half) {
    json points = json::array();
    for (const auto& [dx, dy] :
         {std::pair(-half, -half), std::pair(half, -half), std::pair(half, half), std::pair(-half, half)}) {
      const Vec3 p = front(x + dx, y + dy);
      points.push_back({p[0], p[1], p[2]});
    }
    return points;
  }

  static const json* muscle(const json& report, const std::string& name) {
    for (const json& entry : report["muscles"])
      if (entry["name"] == name) return &entry;
    return nullptr;
  }

  /// Ends of the fibres of muscle `name` in a rig, millimetres.
  static std::vector<Vec3> fibre_ends(const std::string& rig, const std::string& name) {
    EXPECT_EQ(run("export " + at(rig) + " --part muscles -o " + at("m.obj")).code, 0);
    std::ifstream file(at("m.obj"));
    std::vector<Vec3> points, ends;
    bool here = false;
    for (std::string word; file >> word;) {
      if (word == "v") {
        Vec3 p;
        file >> p[0] >> p[1] >> p[2];
        points.push_back(p);
      } else if (word == "g") {
        file >> word;
        here = word == name;
      } else if (word == "l") {
        std::string line;
        std::getline(file, line);
        if (here)
          ends.push_back(points[std::stoul(line.substr(line.rfind(' ', line.find_last_not_of(' ')))) - 1]);
      }
    }
    return ends;
  }

  static fs::path* folder;
  static std::vector<Vec3>* skin;
  static json* plain;  ///< the report without edits
};

fs::path* Edits::folder = nullptr;
std::vector<Vec3>* Edits::skin = nullptr;
json* Edits::plain = nullptr;

json example(const json& curve, const json& points, const json& own_origin, const json& own_insertion) {
  return {{"units", "mm"},
          {"muscles",
           {{"zygomaticus_major", {{"strength", 2.0}}},
            {"zygomaticus_major_superior_left", {{"strength", 1.5}, {"peak_shortening", 0.3}}},
            {"risorius_right", {{"present", false}}},
            {"levator_labii_superioris_lateral_left", {{"insertion", {{"curve", curve}}}}},
            {"levator_labii_superioris_lateral_right", {{"insertion", {{"points", points}}}}}}},
          {"new_muscles",
           {{{"name", "cheek_strap_left"},
             {"origin", {{"on", "smas"}, {"points", own_origin}}},
             {"insertion", {{"on", "smas"}, {"curve", own_insertion}}},
             {"cross_section_mm2", 20}}}}};
}

TEST_F(Edits, SurviveARebuild) {
  const json edits = example(patch(30, -20, 3), patch(-30, -20, 3), patch(45, -30, 4), patch(20, -50, 4));
  const json first = build(edits);
  ASSERT_TRUE(first.is_object());
  EXPECT_EQ(first["edits"]["added"], json::array({"cheek_strap_left"}));
  EXPECT_EQ(first["edits"]["absent"], json::array({"risorius_right"}));
  const auto strength = [](const json& report, const char* name) {
    return (*muscle(report, name))["strength_n"].get<double>();
  };
  for (const char* name : {"zygomaticus_major_superior_right", "zygomaticus_major_inferior_left"})
    EXPECT_NEAR(strength(first, name) / strength(*plain, name), 2.0, 1e-9) << name;
  // What is said of a part comes on top of what is said of the whole.
  EXPECT_NEAR(strength(first, "zygomaticus_major_superior_left") /
                  strength(*plain, "zygomaticus_major_superior_left"),
              3.0, 1e-9);
  EXPECT_EQ(muscle(first, "risorius_right"), nullptr);
  EXPECT_NE(muscle(first, "risorius_left"), nullptr);
  ASSERT_NE(muscle(first, "cheek_strap_left"), nullptr);
  EXPECT_GT((*muscle(first, "cheek_strap_left"))["fibres"], 2);
  // Untouched muscles stay as they were.
  EXPECT_EQ(*muscle(*plain, "mentalis_left"), *muscle(first, "mentalis_left"));

  // Again, with other depths under the skin and a landmark moved: the fibres still end in what was drawn.
  json again = edits;
  again["landmarks"] = {{"glabella", patch(0, 50, 0)[0]}};
  const json second = build(again, "--tissue-scale 1.2", "again.glb");
  EXPECT_EQ(second["edits"]["landmarks"], 1);
  EXPECT_EQ(second["edits"]["changed"], first["edits"]["changed"]);
  for (const char* rig : {"rig.glb", "again.glb"})
    for (const double side : {1.0, -1.0}) {
      const std::vector<Vec3> ends = fibre_ends(
          rig, side > 0 ? "levator_labii_superioris_lateral_left" : "levator_labii_superioris_lateral_right");
      ASSERT_GE(ends.size(), 3u);
      const Vec3 middle = front(30 * side, -20);
      double reach = 0.0;
      for (const json& p : patch(30 * side, -20, 3))
        reach = std::max(reach, std::hypot(p[0].get<double>() - middle[0], p[1].get<double>() - middle[1]));
      for (const Vec3& end : ends)
        EXPECT_LT((end - middle).head<2>().norm(), reach + 4.0)
            << rig;  // through the fat, aslant; 17 without edits
    }
  // The new muscle has a channel like any other.
  const Outcome posed =
      run("pose " + at("rig.glb") + " --set cheek_strap_left=1 --json -o " + at("posed.obj"));
  EXPECT_EQ(posed.code, 0) << posed.err;
  EXPECT_NE(text_of(at("posed.obj")), text_of(at("head.obj")));
}

TEST_F(Edits, WrongOnesAreRefusedWithAReason) {
  expect_refused("", "is not JSON");
  expect_refused("[]", "JSON object");
  expect_refused("{}", "it changes nothing");
  expect_refused(R"({"muscels":{}})", "\"muscels\" is not known here");
  expect_refused(R"({"units":"feet","muscles":{}})", "units");
  expect_refused(R"({"muscles":{"zygomaticus_mayor_left":{}}})", "did you mean 'zygomaticus_major_left'");
  expect_refused(R"({"muscles":{"risorius_left":{"strenght":2}}})", "\"strenght\" is not known here");
  expect_refused(R"({"muscles":{"risorius_left":{"strength":-1}}})", "a factor from 0 to 100");
  expect_refused(R"({"muscles":{"risorius_left":{"variant":"threefold"}}})",
                 "there is no variant 'threefold'");
  expect_refused(R"({"muscles":{"risorius_left":{"origin":{"curve":[]}}}})", "needs three points or more");
  expect_refused(R"({"muscles":{"risorius_left":{"origin":{"points":[[1,2],[3,4],[5,6]]}}}})",
                 "three numbers");
  expect_refused(R"({"muscles":{"risorius_left":{"origin":{}}}})", "\"points\"");
  expect_refused(R"({"muscles":{"zygomaticus_major":{"waypoints":[[1,2,3]]}}})",
                 "stands for several muscles");
  expect_refused(R"({"landmarks":{"nose_tip":[0,0,0]}})", "there is no landmark 'nose_tip'");
  expect_refused(
      R"({"new_muscles":[{"name":"jaw_open","origin":{"on":"smas","points":[[1,2,3],[1,2,4],[1,3,3]]},"insertion":{"on":"smas","points":[[1,2,3],[1,2,4],[1,3,3]]}}]})",
      "jaw_open");
  expect_refused(
      R"({"new_muscles":[{"name":"mine_left","origin":{"on":"moon","points":[[1,2,3],[1,2,4],[1,3,3]]},"insertion":{"on":"smas","points":[[1,2,3],[1,2,4],[1,3,3]]}}]})",
      "\"on\" must be");
  const Outcome missing =
      run("build " + at("head.obj") + " -o " + at("wrong.glb") + " --edits " + at("nowhere.json"));
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.err.find("does not exist"), std::string::npos) << missing.err;
}

TEST_F(Edits, RegionsOffTheHeadAreRefused) {
  json off = patch(30, -20, 3);
  off[2][2] = off[2][2].get<double>() + 30.0;
  expect_refused(json{{"muscles", {{"risorius_left", {{"insertion", {{"curve", off}}}}}}}}.dump(),
                 "point 3 lies");
}

TEST_F(Edits, VariantsDensityAndMuscleFilesAreOptions) {
  // In the form of anatomy/data/muscles.json, on the generic head: both sides come of one entry.
  std::ofstream(at("more.json"))
      << R"({"units":"mm","frame":"generic head","muscles":[{"name":"malaris","title":"Malaris","group":"mimic",
    "kind":"sheet","origin":{"on":"smas","polygon":[[50,20,70],[55,20,65],[55,26,62],[50,26,68]]},
    "insertion":{"on":"smas","polygon":[[40,-20,85],[45,-20,80],[45,-14,80],[40,-14,86]]},"depth_fraction":[0.5],"layer":"F1",
    "peak_shortening":0.2,"cross_section_mm2":10,"action_units":[6],"source":"test"}]})";
  const json report = build(json(),
                            "--variant risorius=absent --variant zygomaticus_major=bifid --fibre-spacing 1 "
                            "--least-prevalence 0.5 --muscles " +
                                at("more.json"));
  EXPECT_EQ(muscle(report, "risorius_left"), nullptr);
  EXPECT_EQ(muscle(report, "risorius_right"), nullptr);
  ASSERT_NE(muscle(report, "malaris_left"), nullptr);
  ASSERT_NE(muscle(report, "malaris_right"), nullptr);
  const auto figure = [](const json& from, const char* name, const char* key) {
    return (*muscle(from, name))[key].get<double>();
  };
  for (const char* name :
       {"frontalis_medial_left", "depressor_anguli_oris_right", "orbicularis_oris_peripheral_upper_left"})
    EXPECT_GT(figure(report, name, "fibres"), 1.5 * figure(*plain, name, "fibres")) << name;
  // The lower slip of a bifid muscle inserts lower.
  EXPECT_GT(figure(report, "zygomaticus_major_inferior_left", "length_mm"),
            figure(*plain, "zygomaticus_major_inferior_left", "length_mm") + 1.5);
  EXPECT_NE(muscle(report, "zygomaticus_major_superior_left"), nullptr);
  EXPECT_EQ(muscle(report, "zygomaticus_minor_left"), nullptr) << "fewer than half of the people have it";
  EXPECT_EQ(run("build " + at("head.obj") + " -o " + at("x.glb") + " --variant risorius").code, 1);
  EXPECT_EQ(run("build " + at("head.obj") + " -o " + at("x.glb") + " --muscles " + at("nowhere.json")).code,
            1);
}

TEST_F(Edits, SchemaTakesWhatTheToolTakes) {
  const json document = json::parse(text_of(FASCIA_EDITS_SCHEMA));
  using Adapter = valijson::adapters::NlohmannJsonAdapter;
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(Adapter(document), schema);
  const auto takes = [&](const json& edits) {
    valijson::Validator validator;
    return validator.validate(schema, Adapter(edits), nullptr);
  };
  const json edits = example(patch(30, -20, 3), patch(-30, -20, 3), patch(45, -30, 4), patch(20, -50, 4));
  EXPECT_TRUE(takes(edits));
  EXPECT_FALSE(takes(json::object()));
  json wrong = edits;
  wrong["muscles"]["zygomaticus_major"]["strength"] = -1;
  EXPECT_FALSE(takes(wrong));
  wrong = edits;
  wrong["muscles"]["levator_labii_superioris_lateral_left"]["insertion"]["points"] = patch(0, 0, 1);
  EXPECT_FALSE(takes(wrong)) << "points and curve at once";
  wrong = edits;
  wrong["muscels"] = json::object();
  EXPECT_FALSE(takes(wrong));
}

}  // namespace
}  // namespace fascia::cli
