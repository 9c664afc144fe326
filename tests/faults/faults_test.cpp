// Every call that writes fails once, and allocations here and there (as SQLite tests itself): the tool says
// so with its exit code, an output that was there stays whole, and nothing is left beside it.
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <sstream>

#include "tests/faults/workplace.h"

namespace fascia::testing {
namespace {

using cli::Outcome;
using cli::run_tool;
using cli::text_of;

class Faults : public Workplace {
 protected:
  /// Kinds of the shim without memory. Every output needs those of `needed`.
  static constexpr const char* kinds[] = {"read",   "open",      "write", "fsync",  "rename", "close",
                                          "fchmod", "renameat2", "mkdir", "linkat", "unlink"};
  static constexpr size_t needed = 7;

  /// Runs a command with the `number`-th call of `kind` failing; the calls of each kind in `counts`.
  Outcome run_with_fault(const std::string& words, const std::string& kind, long number,
                         std::map<std::string, long>* counts = nullptr) {
    const std::filesystem::path logs = folder.string() + "_logs";
    std::filesystem::create_directories(logs);
    const std::string log = (logs / "calls").string();
    const std::string command = "env LD_PRELOAD=" FASCIA_FAULT_SHIM " FASCIA_FAULT=" + kind + ":" +
                                std::to_string(number) + " FASCIA_FAULT_LOG=" + log +
                                " FASCIA_FAULT_FOLDER=" + folder.string() + " " + test::tool().string() +
                                " " + words;
    const std::string out = (logs / "out").string(), err = (logs / "err").string();
    const int status = std::system((command + " --threads 1 >" + out + " 2>" + err + " </dev/null").c_str());
    const Outcome outcome = {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
    if (counts) {
      std::istringstream lines(text_of(log));
      std::string name;
      for (long calls = 0; lines >> name >> calls;)
        (*counts)[name] = calls;
    }
    std::filesystem::remove_all(logs);
    return outcome;
  }

  /// The command with the fault, over an output that is there already.
  void expect_nothing_lost(const Job& job, const std::string& kind, long number) {
    const std::string before = "what was there before";
    std::ofstream(at(job.output)) << before;
    const std::set<std::string> names_before = names();
    const Outcome outcome = run_with_fault(job.words + at(job.output), kind, number);
    const std::string now = text_of(at(job.output)), where = job.words + kind + " " + std::to_string(number);
    EXPECT_EQ(names(), names_before) << where;
    if (outcome.code == 0) {  // the call was one the tool can do without
      EXPECT_NE(now, before) << where;
    } else {
      EXPECT_EQ(outcome.code, 1) << where << "\n" << outcome.err;
      EXPECT_EQ(now, before) << where;
      EXPECT_FALSE(outcome.err.empty()) << where;
    }
    std::filesystem::remove(at(job.output));
  }
  static bool is_thorough() { return std::getenv("FASCIA_THOROUGH") != nullptr; }

  /// Numbers of calls to fail: many of one kind are alike, so the first, the last and `between` of the
  /// others.
  static std::vector<long> some_of(long calls, long between = 5) {
    std::set<long> numbers;
    for (long k = 0; k <= between + 1 && calls > 0; ++k)
      numbers.insert(1 + k * (calls - 1) / (between + 1));
    return {numbers.begin(), numbers.end()};
  }

  /// Of every kind of call some fail. A command of seconds is tried less often, but for a thorough run.
  void expect_calls_may_fail(const Job& job) {
    std::map<std::string, long> counts;
    const Outcome outcome = run_with_fault(job.words + at(job.output), "none", 0, &counts);
    ASSERT_EQ(outcome.code, 0) << job.words << outcome.err;
    std::filesystem::remove(at(job.output));
    for (size_t k = 0; k < std::size(kinds); ++k) {
      EXPECT_TRUE(counts[kinds[k]] > 0 || k >= needed) << job.words << kinds[k];
      for (const long number : some_of(counts[kinds[k]], job.takes_seconds && !is_thorough() ? 0 : 5))
        expect_nothing_lost(job, kinds[k], number);
    }
  }
  /// The command with `runs` of its allocations refused in turn.
  void expect_allocations_may_fail(const Job& job, long runs) {
    std::map<std::string, long> counts;
    ASSERT_EQ(run_with_fault(job.words + at(job.output), "malloc", 0, &counts).code, 0);
    const long calls = counts["malloc"];
    std::filesystem::remove(at(job.output));
    EXPECT_GT(calls, 1000);
    // Before main the loader and the standard library allocate; there is nobody to say anything yet.
    for (long k = 0; k < runs; ++k)
      expect_nothing_lost(job, "malloc", 1 + calls / 50 + k * (calls - calls / 50) / runs);
  }
};

TEST_F(Faults, EveryCallThatWritesMayFail) {
  std::vector<Job> all = jobs();
  for (const Job& job : picture_jobs())
    all.push_back(job);
  all.push_back(build_job());
  all.push_back(calibrate_job());
  all.push_back(face_job());
  for (const Job& job : all)
    expect_calls_may_fail(job);
}

TEST_F(Faults, TheDemonstrationIsThereAsAWholeOrNotAtAll) {
  if (!is_thorough()) GTEST_SKIP() << "takes minutes: set FASCIA_THOROUGH";
  const std::string words = "demo --out " + at("demo");
  const std::set<std::string> before = names();
  std::map<std::string, long> counts;
  ASSERT_EQ(run_with_fault(words, "none", 0, &counts).code, 0);
  for (size_t k = 0; k < needed; ++k)
    for (const long number : some_of(counts[kinds[k]], 1)) {
      std::filesystem::remove_all(at("demo"));
      const Outcome outcome = run_with_fault(words, kinds[k], number);
      if (outcome.code == 0) continue;
      EXPECT_EQ(outcome.code, 1) << kinds[k] << number << outcome.err;
      EXPECT_EQ(names(), before) << kinds[k] << number;
    }
}

TEST_F(Faults, ASequenceIsThereAsAWholeOrNotAtAll) {
  const std::string words =
      "bake " + at("rig.glb") + " --shapes arkit --format obj-sequence -o " + at("shapes");
  const std::set<std::string> before = names();
  std::map<std::string, long> counts;
  ASSERT_EQ(run_with_fault(words, "none", 0, &counts).code, 0);
  const auto whole = std::distance(std::filesystem::directory_iterator(at("shapes")), {});
  for (const char* kind : {"open", "write", "fsync", "rename", "close", "fchmod", "mkdir"}) {
    EXPECT_GT(counts[kind], 0) << kind;
    for (long number = 1; number <= counts[kind]; ++number) {
      std::filesystem::remove_all(at("shapes"));
      const Outcome outcome = run_with_fault(words, kind, number);
      if (outcome.code == 0) {
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(at("shapes")), {}), whole)
            << kind << number;
      } else {
        EXPECT_EQ(outcome.code, 1) << kind << number << outcome.err;
        EXPECT_EQ(names(), before) << kind << number;
      }
    }
  }
}

/// A batch's own calls: the tools that it starts are not the shim's.
TEST_F(Faults, ABatchKeepsItsResultsAndIsResumed) {
  std::ofstream(at("none.obj")) << "v 0 0 0\n";
  std::ofstream(at("heads.jsonl")) << R"({"head": "none.obj", "id": "none"})"
                                   << "\n";
  const std::string words = "batch " + at("heads.jsonl") + " -o " + at("heads") + " --jobs 1 --retry-failed",
                    record = at("heads/none/job.json");
  for (const bool has_results : {false, true}) {
    std::map<std::string, long> counts;
    ASSERT_EQ(run_with_fault(words, "none", 0, &counts).code, 1);
    ASSERT_NE(text_of(record).find("\"done\": false"), std::string::npos);
    for (const char* kind : kinds)
      for (const long number : some_of(counts[kind])) {
        const std::string where = kind + std::string(" ") + std::to_string(number);
        if (!has_results) std::filesystem::remove_all(at("heads"));
        const Outcome outcome = run_with_fault(words, kind, number);
        EXPECT_EQ(outcome.code, 1) << where << outcome.err;
        EXPECT_EQ(outcome.err.find("internal error"), std::string::npos) << where << outcome.err;
        EXPECT_TRUE(std::filesystem::exists(record) || !has_results) << where;
        const Outcome again = run_with_fault(words, "none", 0);
        EXPECT_NE(again.out.find("1 failed"), std::string::npos) << where << again.out << again.err;
        EXPECT_NE(text_of(record).find("no triangles"), std::string::npos) << where << text_of(record);
        EXPECT_TRUE(std::filesystem::is_empty(at("heads/.work"))) << where;
      }
  }
}

TEST_F(Faults, AllocationsMayFail) {
  for (const Job& job : jobs())
    expect_allocations_may_fail(job, is_thorough() ? 400 : 10);
  expect_allocations_may_fail(build_job(), is_thorough() ? 60 : 5);
  if (is_thorough()) expect_allocations_may_fail(face_job(), 60);
}

TEST_F(Faults, AFullStandardOutputIsReported) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const int status = std::system(
      (test::tool().string() + " info " + at("rig.glb") + " --json >/dev/full 2>/dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

TEST_F(Faults, AFileSizeLimitIsReported) {
  for (const Job& job : jobs()) {
    if (job.output == "found.json") continue;  // a few hundred bytes
    const std::set<std::string> before = names();
    const int status = std::system(
        ("ulimit -f 1; " + test::tool().string() + " " + job.words + at(job.output) + " --quiet 2>/dev/null")
            .c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << job.words;
    EXPECT_EQ(names(), before) << job.words;
  }
}

}  // namespace
}  // namespace fascia::testing
