// What a terminal is told while a job runs.
#include "cli/progress.h"

#include <gtest/gtest.h>

#include "builder/rigging/embedded_head.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

TEST(Progress, ShowsPercentAndTimeLeft) {
  EXPECT_EQ(progress_line("build: tissue", 0.0, 0.0), "build: tissue  0 %") << "too early to tell";
  EXPECT_EQ(progress_line("build: tissue", 0.25, 1.0), "build: tissue  25 %, 3 s left");
  EXPECT_EQ(progress_line("play", 0.1, 100.0), "play  10 %, 15 min left");
  EXPECT_EQ(progress_line("play", 1.2, 10.0), "play  100 %, 0 s left");
}

TEST(Progress, JobsWithinJobsAreRegisteredAndGoInOrder) {
  Common common;
  common.quiet = true;
  {
    Progress outer(common, "demo", {{"build", 1.0}, {"film", 3.0}});
    EXPECT_EQ(Progress::innermost(), &outer);
    {
      Progress inner(common, "frame", 10);
      EXPECT_EQ(Progress::innermost(), &inner);
      inner.step();
    }
    EXPECT_EQ(Progress::innermost(), &outer);
    outer.begin("nothing of that name");
  }
  EXPECT_EQ(Progress::innermost(), nullptr);
}

/// `script` gives the tool a terminal; what it shows there ends up in the file.
TEST(Progress, IsShownOnTerminalsOnly) {
  if (std::system("command -v script >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs script(1) of bsdutils";
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "fascia_progress_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string head = (folder / "head.obj").string(), rig = (folder / "rig.glb").string();
  rigging::write_embedded_head(head, folder / "landmarks.json");
  const std::string build = "build " + head + " --detail low -o " + rig;
  ASSERT_EQ(std::system(("script -qec '" + test::tool().string() + " " + build + "' /dev/null >" +
                         (folder / "seen.txt").string() + " </dev/null")
                            .c_str()),
            0);
  const std::string seen = text_of(folder / "seen.txt");
  EXPECT_NE(seen.find("build: tissue  "), std::string::npos) << seen;
  EXPECT_NE(seen.find(" %"), std::string::npos) << seen;
  EXPECT_LT(seen.find("build: landmarks"), seen.find("build: tissue"));
  const Outcome piped = run_tool(folder, build);
  ASSERT_EQ(piped.code, 0) << piped.err;
  EXPECT_EQ(piped.err.find(" %"), std::string::npos) << piped.err;
  const Outcome quiet = run_tool(folder, build + " --quiet");
  EXPECT_EQ(quiet.err + quiet.out, "");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace fascia::cli
