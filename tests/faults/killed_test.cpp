// Processes that end at any moment, and two that write one file.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <iterator>
#include <random>
#include <sstream>
#include <thread>

#include "tests/faults/started.h"
#include "tests/faults/workplace.h"

namespace fascia::testing {
namespace {

using cli::text_of;

class Killed : public Workplace {
 protected:
  std::vector<std::string> words_of(const Job& job) const {
    std::istringstream text(job.words);
    std::vector<std::string> words{std::istream_iterator<std::string>(text), {}};
    words.push_back(at(job.output));
    words.push_back("--threads");
    words.push_back("1");
    return words;
  }
};

TEST_F(Killed, NoPartialFileAtAnyMoment) {
  rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
  const std::vector<std::string> build = {"build",    at("head.obj"), "--landmarks", at("landmarks.json"),
                                          "--detail", "low",          "-o",          at("built.glb")};
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_EQ(wait_for(start(build)), 0);
  const double whole = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  const std::string good = text_of(at("built.glb"));
  const std::set<std::string> usual = names();
  std::mt19937 random(7);
  for (int k = 0; k < 6; ++k) {
    const int signal = std::vector<int>{SIGINT, SIGTERM, SIGKILL}[static_cast<size_t>(k % 3)];
    const pid_t child = start(build);
    std::this_thread::sleep_for(std::chrono::duration<double>(whole * (random() % 1000) / 1000.0));
    kill(child, signal);
    const int status = wait_for(child);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;  // it was faster
    if (signal == SIGKILL) {
      EXPECT_TRUE(WIFSIGNALED(status));
    } else {
      // In its first moments the tool does not catch signals yet.
      EXPECT_TRUE((WIFEXITED(status) && WEXITSTATUS(status) == 130) ||
                  (WIFSIGNALED(status) && WTERMSIG(status) == signal))
          << signal << " " << status;
    }
    EXPECT_EQ(text_of(at("built.glb")), good);
    for (const std::string& name : names())
      if (!usual.count(name)) {
        EXPECT_EQ(signal, SIGKILL)
            << name;  // only then may a file of the writer's be left, and it says what it is
        EXPECT_NE(name.find(".part"), std::string::npos) << name;
        std::filesystem::remove_all(at(name));
      }
  }
}

/// The same of what is written on a rig: the words of a command and its output.
TEST_F(Killed, OutputsFromARigAreCompleteOrAbsent) {
  std::mt19937 random(11);
  for (const Job& job : jobs()) {
    const std::vector<std::string> words = words_of(job);
    const auto begun = std::chrono::steady_clock::now();
    ASSERT_EQ(wait_for(start(words)), 0) << job.words;
    const double whole = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    const std::string good = text_of(at(job.output));
    const std::set<std::string> usual = names();
    for (const int signal : {SIGKILL, SIGTERM, SIGKILL, SIGINT}) {
      const pid_t child = start(words);
      // Writing is what comes last.
      std::this_thread::sleep_for(
          std::chrono::duration<double>(whole * (0.5 + 0.6 * (random() % 1000) / 1000.0)));
      kill(child, signal);
      wait_for(child);
      EXPECT_EQ(text_of(at(job.output)), good) << job.words;
      for (const std::string& name : names())
        if (!usual.count(name)) {
          EXPECT_EQ(signal, SIGKILL) << job.words << name;
          EXPECT_NE(name.find(".part"), std::string::npos) << job.words << name;
          std::filesystem::remove_all(at(name));
        }
    }
  }
}

/// ffmpeg outlives the tool for a moment and ends what it was writing.
TEST_F(Killed, AFilmIsCompleteOrAbsent) {
  if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  const std::set<std::string> usual = names();
  const std::vector<std::string> film = {"render", at("rig.glb"), "--view", "turntable",
                                         "--size", "320",         "-o",     at("film.mp4")};
  for (const int signal : {SIGINT, SIGKILL})
    for (const int milliseconds : {200, 500, 900}) {
      const pid_t child = start(film);
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      kill(child, signal);
      wait_for(child);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      std::set<std::string> there = names();
      there.erase("film.mp4");  // it was faster
      EXPECT_EQ(there, usual) << signal << " after " << milliseconds << " ms";
    }
}

TEST_F(Killed, ConcurrentWritersLeaveOneCompleteOutput) {
  const std::vector<std::string> smile = {"pose", at("rig.glb"), "--set", "zygomaticus_major_left=1",
                                          "-o",   at("out.glb")};
  const std::vector<std::string> open_mouth = {"pose",       at("rig.glb"), "--set",
                                               "jaw_open=1", "-o",          at("out.glb")};
  ASSERT_EQ(wait_for(start(smile)), 0);
  const std::string first = text_of(at("out.glb"));
  ASSERT_EQ(wait_for(start(open_mouth)), 0);
  const std::string second = text_of(at("out.glb"));
  ASSERT_NE(first, second);
  for (int k = 0; k < 8; ++k) {
    const pid_t a = start(smile), b = start(open_mouth);
    EXPECT_EQ(wait_for(a), 0);
    EXPECT_EQ(wait_for(b), 0);
    const std::string now = text_of(at("out.glb"));
    EXPECT_TRUE(now == first || now == second) << k;
  }
  EXPECT_EQ(names(), (std::set<std::string>{"rig.glb", "curves.csv", "out.glb", "smile.ply"}));
}

TEST_F(Killed, ConcurrentRunsOfOneCommandLeaveACompleteOutput) {
  for (const Job& job : jobs()) {
    const std::vector<std::string> words = words_of(job);
    ASSERT_EQ(wait_for(start(words)), 0) << job.words;
    const std::string good = text_of(at(job.output));
    const std::set<std::string> usual = names();
    // A snapshot that is there is renewed with a reason only: the slower of two is refused.
    const bool is_snapshot = job.output == "snapshot.json";
    std::ofstream(at(job.output)) << "what was there before";
    for (int k = 0; k < 2; ++k) {
      if (is_snapshot) std::filesystem::remove(at(job.output));
      const pid_t a = start(words), b = start(words);
      const int first = wait_for(a), second = wait_for(b);
      EXPECT_TRUE(first == 0 || second == 0) << job.words;
      EXPECT_TRUE(is_snapshot || (first == 0 && second == 0)) << job.words;
      EXPECT_EQ(text_of(at(job.output)), good) << job.words;
      EXPECT_EQ(names(), usual) << job.words;
    }
  }
}

}  // namespace
}  // namespace fascia::testing
