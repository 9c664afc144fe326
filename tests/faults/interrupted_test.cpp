// Ctrl-C in any stage, folders that may not be written, clocks that jump.
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <thread>

#include "tests/faults/started.h"
#include "tests/faults/workplace.h"

namespace fascia::testing {
namespace {

using cli::text_of;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

class Interrupted : public Workplace {
 protected:
  /// Commands that take a while, without an output that could be the input of another.
  std::vector<std::vector<std::string>> long_commands() {
    write_long_curves();
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    std::ofstream(at("heads.jsonl"))
        << R"({"head": "head.obj", "landmarks": "landmarks.json", "detail": "low"})"
        << "\n";
    return {{"build", at("head.obj"), "--landmarks", at("landmarks.json"), "--detail", "low", "-o",
             at("built.glb")},
            {"play", at("rig.glb"), "--curves", at("long.csv"), "-o", at("long.glb")},
            {"bake", at("rig.glb"), "--shapes", "arkit,muscles", "-o", at("baked.glb")},
            {"fit", at("rig.glb"), "--target", at("smile.ply"), "-o", at("found.json")},
            {"render", at("rig.glb"), "-o", at("picture.png")},
            {"check", at("built.glb"), "--sheet", at("sheet.png")},
            {"batch", at("heads.jsonl"), "-o", at("heads")}};
  }

  void write_long_curves() const {
    std::ofstream file(at("long.csv"));
    file << "time,zygomaticus_major_left\n";
    for (int k = 0; k <= 40; ++k)
      file << 0.5 * k << "," << k % 2 << "\n";
  }

  /// Seconds from SIGINT to the end of a command that is interrupted after `delay`; 0 when it was faster.
  double seconds_to_end(const std::vector<std::string>& words, double delay) {
    const pid_t child = start(words);
    std::this_thread::sleep_for(std::chrono::duration<double>(delay));
    const auto begun = Clock::now();
    kill(child, SIGINT);
    const int status = wait_for(child);
    const double seconds = seconds_since(begun);
    if (WIFEXITED(status) && WEXITSTATUS(status) != 130) {
      // It was done before; a check of so small a rig fails.
      EXPECT_TRUE(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 4) << words[0] << WEXITSTATUS(status);
      return 0.0;
    }
    return seconds;
  }
};

TEST_F(Interrupted, EveryStageEndsAtOnce) {
  constexpr double longest = 0.2;
  for (const std::vector<std::string>& words : long_commands()) {
    const auto begun = Clock::now();
    wait_for(start(words));
    const double whole = seconds_since(begun);
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      double seconds = 1e9;
      for (int k = 0; k < 5 && seconds > longest; ++k)  // the machine may be busy
        seconds = std::min(seconds, seconds_to_end(words, share * whole));
      EXPECT_LE(seconds, longest) << words[0] << " at " << share;
    }
  }
  for (const std::string& name : names())
    EXPECT_EQ(name.find(".part"), std::string::npos) << name;
}

TEST_F(Interrupted, NoEmptyFolderIsLeft) {
  rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
  const std::set<std::string> before = names();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"build", at("head.obj"), "-o", at("built.glb"), "--report", at("pages")},
        std::vector<std::string>{"fit", at("rig.glb"), "--target", at("smile.ply"), "-o", at("found.json"),
                                 "--report", at("pages")}})
    for (const int milliseconds : {20, 60, 200}) {
      const pid_t child = start(words);
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      kill(child, SIGINT);
      const int status = wait_for(child);
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
        std::filesystem::remove_all(at("pages"));  // it was faster
      std::filesystem::remove(at("found.json"));   // which is whole before the pages are begun
      EXPECT_EQ(names(), before) << words[0] << milliseconds;
    }
}

TEST_F(Interrupted, AFolderThatMayNotBeWrittenIsSaid) {
  const std::string locked = at("locked");
  std::filesystem::create_directories(locked);
  chmod(folder.c_str(), 0755);
  chmod(locked.c_str(), 0555);
  for (const Job& job : jobs()) {
    const std::string command = test::tool().string() + " " + job.words + locked + "/" + job.output;
    const pid_t child = fork();
    if (child == 0) {
      constexpr uid_t nobody = 65534;
      if (geteuid() == 0 && (setgid(nobody) != 0 || setuid(nobody) != 0)) _exit(99);
      execl("/bin/sh", "sh", "-c", (command + " >/dev/null 2>&1").c_str(), nullptr);
      _exit(99);
    }
    const int status = wait_for(child);
    EXPECT_EQ(WEXITSTATUS(status), 1) << job.words;
    EXPECT_TRUE(std::filesystem::is_empty(locked)) << job.words;
  }
}

TEST_F(Interrupted, AClockThatJumpsChangesNothing) {
  for (const Job& job : jobs()) {
    const std::string command =
        test::tool().string() + " " + job.words + at(job.output) + " --quiet --threads 1";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    const std::string usual = text_of(at(job.output));
    std::filesystem::remove(at(job.output));
    const std::string jumping = "env LD_PRELOAD=" FASCIA_FAULT_SHIM " FASCIA_CLOCK_JUMP=100000000 " + command;
    ASSERT_EQ(std::system(jumping.c_str()), 0) << command;
    EXPECT_EQ(text_of(at(job.output)), usual) << job.words;
    std::filesystem::remove(at(job.output));
  }
}

}  // namespace
}  // namespace fascia::testing
