// The command line: what it reads, what it refuses and what it says of itself.
#include "cli/options.h"

#include <gtest/gtest.h>

#include "cli/help.h"
#include "cli/render_request.h"
#include "geometry/error.h"

namespace fascia::cli {
namespace {

/// A tool of one command with an option of every kind.
struct Tool {
  bool json = false, keeps = true;
  int count = 3;
  size_t targets = 64;
  double fps = 60.0, unit = 0.0;
  std::optional<double> spacing;
  std::string level, solver = "own";
  std::filesystem::path rig, output;
  std::vector<std::string> set, shapes = {"arkit"};
  std::vector<std::filesystem::path> files;
  int runs = 0;
  Command tool{"tool", "What it is", "tool 1.2.3"};

  Tool() {
    tool.flag("--json", json, "Print JSON");
    const Command play = tool.command("play", "Plays");
    play.positional("RIG", &rig, "Rig").required();
    play.option("-o,--output", &output, "Output").required();
    play.option("--count", &count, "Count").range(1, 10);
    play.option("--targets", &targets, "Targets");
    play.option("--fps", &fps, "Frames a second").range(1.0, 1000.0);
    play.option("--unit", &unit, "Unit").units({{"ms", 1e-3}}).range(1e-9, 10.0).default_text("by the file");
    play.option("--spacing", &spacing, "Spacing").default_text("by the edits");
    play.option("--level", &level, "Level").default_text("the finest");
    play.option("--solver", &solver, "Solver").one_of({"own", "bullet"});
    play.option("--set", &set, "Values").default_text("rest");
    play.option("--shapes", &shapes, "Shapes").separated_by_commas();
    play.option("--file", &files, "Files").default_text("none");
    play.flag("--keep", keeps, "Keep", true);
    play.run([this] { ++runs; });
    tool.command("pose", "Poses").run([] {});
  }

  void parse(const std::vector<std::string>& words) {
    std::vector<const char*> arguments = {"tool"};
    for (const std::string& word : words)
      arguments.push_back(word.c_str());
    if (const auto action = tool.parse(static_cast<int>(arguments.size()), arguments.data())) action();
  }

  std::string refusal(const std::vector<std::string>& words) {
    try {
      parse(words);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }
};

TEST(Options, ReachTheirVariables) {
  Tool tool;
  tool.parse({"play",      "a.glb",    "-o",           "b.glb",  "--count", "4",          "--targets=9",
              "--fps",     "23.5",     "--spacing",    "0.5",    "--set",   "jaw_open=1", "--set",
              "au:12=-.5", "--shapes", "arkit,viseme", "--file", "x",       "--file",     "y",
              "--no-keep", "--json",   "--solver",     "bullet"});
  EXPECT_EQ(tool.runs, 1);
  EXPECT_EQ(tool.rig, "a.glb");
  EXPECT_EQ(tool.output, "b.glb");
  EXPECT_EQ(tool.count, 4);
  EXPECT_EQ(tool.targets, 9u);
  EXPECT_EQ(tool.fps, 23.5);
  EXPECT_EQ(tool.spacing, 0.5);
  EXPECT_EQ(tool.set, (std::vector<std::string>{"jaw_open=1", "au:12=-.5"}));
  EXPECT_EQ(tool.shapes, (std::vector<std::string>{"arkit", "viseme"}));
  EXPECT_EQ(tool.files, (std::vector<std::filesystem::path>{"x", "y"}));
  EXPECT_FALSE(tool.keeps);
  EXPECT_TRUE(tool.json) << "the tool's own options may stand behind the command";
  EXPECT_EQ(tool.solver, "bullet");
}

TEST(Options, KeepTheirDefaults) {
  Tool tool;
  tool.parse({"play", "a.glb", "-o", "b.glb"});
  EXPECT_EQ(tool.count, 3);
  EXPECT_EQ(tool.shapes, (std::vector<std::string>{"arkit"}));
  EXPECT_FALSE(tool.spacing);
  EXPECT_TRUE(tool.keeps);
}

TEST(Options, AValueOfAListDoesNotSwallowWhatFollows) {
  Tool tool;
  tool.parse({"play", "--set", "jaw_open=1", "a.glb", "-o", "b.glb"});
  EXPECT_EQ(tool.rig, "a.glb");
}

TEST(Options, UnitsAreWordsOrNumbers) {
  Tool tool;
  tool.parse({"play", "a", "-o", "b", "--unit", "ms"});
  EXPECT_EQ(tool.unit, 1e-3);
  tool.parse({"play", "a", "-o", "b", "--unit", "0.25"});
  EXPECT_EQ(tool.unit, 0.25);
  EXPECT_NE(tool.refusal({"play", "a", "-o", "b", "--unit", "fortnight"}).find("fortnight"),
            std::string::npos);
}

TEST(Options, RefusalsNameTheFaultAndTheNearest) {
  Tool tool;
  const auto says = [&](const std::vector<std::string>& words, const std::string& what) {
    const std::string message = tool.refusal(words);
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  says({}, "no command is given");
  says({"paly"}, "no command 'paly' (did you mean 'play'?)");
  says({"play", "a", "-o", "b", "--levl", "low"}, "no option '--levl' (did you mean '--level'?)");
  says({"play", "a", "--outptu", "b"}, "no option '--outptu' (did you mean '--output'?)");
  says({"--jsn", "play"}, "'--jsn'");
  says({"play", "a", "b", "-o", "c"}, "no further argument: 'b'");
  says({"play", "-o", "c"}, "RIG is required");
  says({"play", "a", "-o", "b", "--count", "11"}, "'11' is not a number from 1 to 10");
  says({"play", "a", "-o", "b", "--count", "many"}, "many");
  says({"play", "a", "-o", "b", "--fps", "nan"}, "nan");
  says({"play", "a", "-o", "b", "--spacing", "inf"}, "inf");
  says({"play", "a", "-o", "b", "--solver", "bulet"},
       "'bulet' is none of own, bullet (did you mean 'bullet'?)");
  EXPECT_EQ(tool.runs, 0);
}

TEST(Options, AnOptionWithoutADefaultIsAFaultOfOurs) {
  const Command tool("tool", "What it is", "1");
  std::string level;
  tool.command("pose", "Poses").option("--level", &level, "Level");
  const char* const words[] = {"tool", "pose"};
  EXPECT_THROW(tool.parse(2, words), std::logic_error);
}

TEST(Options, HelpStatesEveryDefault) {
  const Tool tool;
  const std::string help = command_help(tool.tool, tool.tool.commands()[0]);
  for (const char* part : {"Usage: tool play RIG -o FILE [options]", "-o, --output FILE", "(required)",
                           "(default: 3)", "--solver own|bullet", "(default: the finest)", "(default: arkit)",
                           "--keep, --no-keep", "(default: yes)", "--json"})
    EXPECT_NE(help.find(part), std::string::npos) << part << "\n" << help;
}

TEST(RenderCamera, LooksWhereItIsAsked) {
  const Bounds box{Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0.1, 0.1)};
  RenderRequest request;
  request.look_at = "0.01,0.02,0.03,0.5";
  request.camera = "20,-10";
  for (const PictureSize size : {PictureSize{1600, 900}, PictureSize{450, 900}}) {
    const view::Camera camera = camera_for("front", request, box, size);
    EXPECT_LT((camera.target - Vec3(0.01, 0.02, 0.03)).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(camera.distance, 0.5);
    EXPECT_DOUBLE_EQ(camera.yaw, 20.0);
    EXPECT_DOUBLE_EQ(camera.pitch, -10.0);
  }
  for (const char* wrong : {"1,2,3", "0,0,0,-1", "0,0,0,0", "a,b,c,d", "1,2,3,4,5"}) {
    request.look_at = wrong;
    EXPECT_THROW(camera_for("front", request, box, {900, 900}), Error) << wrong;
  }
}

}  // namespace
}  // namespace fascia::cli
