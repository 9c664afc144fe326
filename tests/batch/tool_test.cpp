// `fascia batch` as a user runs it, on two heads and one that is none.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "builder/rigging/embedded_head.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class BatchTool : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / "fascia_batch_tool_test");
    fs::remove_all(*folder);
    fs::create_directories(*folder / "heads");
    rigging::write_embedded_head(*folder / "heads/first.obj", *folder / "landmarks.json");
    std::ofstream(at("heads/none.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ofstream(at("heads.jsonl")) << "{\"head\": \"heads/first.obj\", \"landmarks\": \"landmarks.json\", "
                                        "\"detail\": \"low\", \"id\": \"one\"}\n"
                                     << "{\"head\": \"heads/none.obj\", \"id\": \"none\"}\n";
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
  }
  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static Outcome run(const std::string& arguments) { return run_tool(*folder, arguments); }
  static fs::path* folder;
};
fs::path* BatchTool::folder = nullptr;

TEST_F(BatchTool, BuildsReportsAndTakesUp) {
  const Outcome outcome = run("batch " + at("heads.jsonl") + " -o " + at("out") + " --jobs 2 --json");
  EXPECT_EQ(outcome.code, 1) << outcome.err;  // one of them is no head
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["built"], 1);
  EXPECT_EQ(report["failed"], 1);
  EXPECT_EQ(report["failures"][0]["id"], "none");
  EXPECT_TRUE(fs::exists(at("out/one/rig.glb")));
  EXPECT_TRUE(fs::exists(at("out/one/thumbnail.png")));
  EXPECT_GT(json::parse(text_of(at("out/one/job.json")))["checks"].get<int>(), 5);
  EXPECT_FALSE(fs::exists(at("out/none/rig.glb")));

  const json again = json::parse(run("batch " + at("heads.jsonl") + " -o " + at("out") + " --json").out);
  EXPECT_EQ(again["built"], 0);
  EXPECT_EQ(again["kept"], 1);  // each head is counted once
  EXPECT_EQ(again["failed"], 1);
  const Outcome task =
      run("batch " + at("heads.jsonl") + " -o " + at("out") + " --task-index 0 --task-count 2 --json");
  EXPECT_EQ(task.code, 0) << task.out;
  EXPECT_EQ(json::parse(task.out)["kept"], 1);

  const Outcome page = run("batch report " + at("out") + " --json");
  EXPECT_EQ(page.code, 0) << page.err;
  const json figures = json::parse(page.out);
  EXPECT_EQ(figures["heads"], 2);
  EXPECT_EQ(figures["done"], 1);
  EXPECT_EQ(figures["causes"].size(), 1U);
  EXPECT_GT(figures["seconds"]["p50"].get<double>(), 0.0);
  const std::string html = text_of(at("out/report.html"));
  EXPECT_NE(html.find("one/thumbnail.png"), std::string::npos);
  EXPECT_NE(html.find("2 heads: 1 rigs, 1 failures"), std::string::npos) << html.substr(0, 2000);
}

TEST_F(BatchTool, WritesASlurmScript) {
  const Outcome outcome = run("batch submit " + at("heads.jsonl") + " -o " + at("queue") +
                              " --dry-run --task-count 2 --partition short --no-check --json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string script = text_of(at("queue/batch.sbatch"));
  EXPECT_NE(script.find("#SBATCH --array=0-1\n"), std::string::npos) << script;
  EXPECT_NE(script.find("#SBATCH --partition=short\n"), std::string::npos);
  EXPECT_NE(script.find("'--no-check'"), std::string::npos);
  EXPECT_EQ(std::system(("bash -n " + at("queue/batch.sbatch")).c_str()), 0);
}

TEST_F(BatchTool, KeepsWhatItDidNotMake) {
  fs::create_directories(at("own/a"));
  for (const char* name : {"own/a.obj", "own/a/head.obj", "own/a/precious.txt"})
    std::ofstream(at(name)) << "mine";
  std::ofstream(at("own.jsonl")) << "{\"head\": \"own/a/head.obj\", \"id\": \"a\"}\n";
  for (const char* words : {"batch ", "batch submit --dry-run "})
    for (const char* source : {"own", "own.jsonl"}) {
      const Outcome outcome = run(words + at(source) + " -o " + at("own"));
      EXPECT_EQ(outcome.code, 1);
      EXPECT_NE(outcome.err.find("-o"), std::string::npos) << outcome.err;
      EXPECT_EQ(std::distance(fs::directory_iterator(at("own")), {}), 2) << words;
    }
  for (const char* name : {"own/a.obj", "own/a/head.obj", "own/a/precious.txt"})
    EXPECT_EQ(text_of(at(name)), "mine") << name;
}

TEST_F(BatchTool, SaysWhatIsMissing) {
  EXPECT_EQ(run("batch").code, 2);
  EXPECT_EQ(run("batch " + at("heads.jsonl")).code, 2);
  EXPECT_EQ(run("batch " + at("nothing.jsonl") + " -o " + at("out2")).code, 1);
  EXPECT_EQ(run("batch report " + at("heads")).code, 1);
  EXPECT_EQ(run("batch " + at("heads.jsonl") + " -o " + at("out") + " --task-index 2 --task-count 2").code,
            2);
  EXPECT_EQ(run("batch " + at("heads.jsonl") + " -o " + at("no/such/folder")).code, 1);
}

}  // namespace
}  // namespace fascia::cli
