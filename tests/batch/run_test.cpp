// Heads built by a stand-in for the tool that crashes, hangs, eats memory or is killed: whatever happens to
// one, the others are built, each once, and nothing half-written is left.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>

#include "batch/run.h"
#include "geometry/error.h"

namespace fascia::batch {
namespace {

namespace fs = std::filesystem;

/// Does what the head's content says. Every build is noted, so that a test can count them.
constexpr const char* stand_in = R"sh(#!/bin/bash
folder="$(dirname "$0")"
case "$1" in
  check) echo '{"rows": [{"name": "lips", "ok": true}, {"name": "lids", "ok": false}], "failed": 1}'; exit 4;;
  render) while [ "$1" != -o ]; do shift; done; echo picture > "$2"; exit 0;;
esac
head="$2"; out="$4"
echo "$(basename "$head")" >> "$folder/builds"
case "$(cat "$head")" in
  good) ;;
  slow) sleep 0.3 ;;
  poisoned) echo half > "$out"; kill -SEGV $$;;
  killed) echo half > "$out"; kill -KILL $$;;
  once) if [ ! -e "$folder/tried" ]; then touch "$folder/tried"; kill -KILL $$; fi;;
  hungry) exec python3 -c 'x = bytearray(4 << 30)' ;;
  thirsty) echo '{"error": "out of memory: the input is too large for this machine", "exit": 1}'; exit 1;;
  hanging) sleep 60 & wait ;;
  stubborn) trap '' TERM; while :; do sleep 0.1; done;;
  refused) echo "{\"error\": \"'$head': no face was found in 12 views; give landmarks\", \"exit\": 1}"; exit 1;;
  broken) echo "fascia: internal error: index 7" >&2; exit 3;;
  empty) exit 0 ;;
  full) echo "{\"error\": \"'$out' cannot be written: No space left on device; check the folder\", \"exit\": 1}"; exit 1;;
  large) echo "fascia: '$out' cannot be written: File too large; check the folder" >&2; exit 1;;
  silent) exit 1;;
esac
echo "rig of $(basename "$head")" > "$out"
echo '{"warnings": ["one thing"]}'
)sh";

class Batch : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("fascia_batch_" + std::to_string(getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder / "out");
    std::ofstream(folder / "tool") << stand_in;
    fs::permissions(folder / "tool", fs::perms::owner_all);
    options.tool = folder / "tool";
    options.version = "1";
    options.output = folder / "out";
    options.jobs = 4;
    options.limits.seconds = 20.0;
  }
  void TearDown() override { fs::remove_all(folder); }

  void add(const std::string& id, const std::string& kind) {
    std::ofstream(folder / id) << kind;
    heads.push_back({id, folder / id, "", "", {}});
  }
  Report run() { return run_all(heads, options, stop, {}); }
  const Record& of(const Report& report, const std::string& id) {
    for (const Record& record : report.records)
      if (record.id == id) return record;
    ADD_FAILURE() << id;
    return report.records[0];
  }
  std::string text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  size_t builds(const std::string& id) {
    std::ifstream file(folder / "builds");
    size_t count = 0;
    for (std::string line; std::getline(file, line);)
      count += line == id;
    return count;
  }
  void expect_whole(const std::string& id) {
    EXPECT_EQ(text(options.output / id / "rig.glb"), "rig of " + id + "\n");
    for (const char* file : {"job.json", "build.json", "check.json", "thumbnail.png"})
      EXPECT_TRUE(fs::exists(options.output / id / file)) << id << file;
  }
  void expect_no_leftovers() {
    EXPECT_TRUE(fs::is_empty(options.output / ".work"));
    for (const auto& entry : fs::directory_iterator(options.output))
      if (entry.path().filename().string()[0] != '.') {
        for (const auto& file : fs::directory_iterator(entry.path())) {
          EXPECT_TRUE(
              std::set<std::string>({"rig.glb", "job.json", "build.json", "check.json", "thumbnail.png"})
                  .count(file.path().filename().string()))
              << file.path();
        }
      }
  }

  fs::path folder;
  std::vector<Head> heads;
  Options options;
  std::atomic<bool> stop = false;
};

TEST_F(Batch, BuildsChecksAndDrawsEveryHeadOnce) {
  for (int i = 0; i < 9; ++i)
    add("head" + std::to_string(i), "good");
  const Report report = run();
  for (const Record& record : report.records) {
    EXPECT_TRUE(record.is_done);
    EXPECT_EQ(record.attempts, 1);
    EXPECT_EQ(record.checks, 2);
    EXPECT_EQ(record.failed_checks, (std::vector<std::string>{"lids"}));
    EXPECT_EQ(record.warnings, (std::vector<std::string>{"one thing"}));
    expect_whole(record.id);
    EXPECT_EQ(builds(record.id), 1U);
  }
  expect_no_leftovers();
  EXPECT_EQ(all_records(options.output).size(), 9U);
}

TEST_F(Batch, ResultsAreThereWhileTheyAreReplaced) {
  add("a", "good");
  run();
  std::atomic<bool> has_ended = false;
  size_t looks = 0, gaps = 0;
  std::thread reader([&] {
    const std::string rig = (options.output / "a" / "rig.glb").string();
    for (; !has_ended; ++looks)
      gaps += access(rig.c_str(), R_OK) != 0;
  });
  for (int version = 2; version < 12; ++version) {
    options.version = std::to_string(version);
    run();
  }
  has_ended = true;
  reader.join();
  EXPECT_GT(looks, 1000U);
  EXPECT_EQ(gaps, 0U);
  expect_whole("a");
  expect_no_leftovers();
}

TEST_F(Batch, ResumesAndRebuildsChangedHeads) {
  add("a", "good");
  add("b", "good");
  add("c", "refused");
  run();
  Report report = run();
  EXPECT_EQ(report.fates, (std::vector<Fate>(3, Fate::kept)));
  EXPECT_EQ(builds("a") + builds("b") + builds("c"), 3U);

  std::ofstream(folder / "a") << "slow";         // the head has changed
  fs::remove(options.output / "b" / "rig.glb");  // somebody took the rig away
  report = run();
  EXPECT_EQ(report.fates, (std::vector<Fate>{Fate::done, Fate::done, Fate::kept}));
  options.retries_failed = true;
  EXPECT_EQ(run().fates[2], Fate::failed);
  EXPECT_EQ(builds("c"), 2U);
  options.version = "2";  // another tool
  EXPECT_EQ(run().fates, (std::vector<Fate>{Fate::done, Fate::done, Fate::failed}));
}

TEST_F(Batch, ReplacesNothingButResults) {
  add("a", "good");
  const fs::path result = options.output / "a";
  const auto expect_refused = [&](const std::string& says) {
    try {
      run();
      ADD_FAILURE() << says;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
    EXPECT_EQ(builds("a"), 0U) << says;
  };
  for (const char* kind : {"good", "refused"}) {
    std::ofstream(folder / "a") << kind;
    std::ofstream(result) << "a file";
    expect_refused("no result of a batch");
    EXPECT_EQ(text(result), "a file");
    fs::remove(result);
    fs::create_directories(result);
    std::ofstream(result / "precious.txt") << "mine";
    expect_refused("no result of a batch");
    std::ofstream(result / "job.json") << "{\"id\": ";  // half a record
    expect_refused("no result of a batch");
    Record record;
    write_record(result, record);
    expect_refused("precious.txt");
    EXPECT_EQ(text(result / "precious.txt"), "mine");
    fs::remove_all(result);
    fs::create_directory_symlink(folder, result);
    expect_refused("no result of a batch");
    fs::remove(result);
  }
}

TEST_F(Batch, AFailingHeadDoesNotAffectOthers) {
  options.limits = {2.0, 1024};
  for (const char* kind : {"poisoned", "killed", "once", "hungry", "thirsty", "hanging", "stubborn",
                           "refused", "broken", "empty"})
    add(kind, kind);
  for (int i = 0; i < 6; ++i)
    add("good" + std::to_string(i), "good");
  const Report report = run();
  for (int i = 0; i < 6; ++i)
    expect_whole("good" + std::to_string(i));
  EXPECT_EQ(of(report, "poisoned").cause, "ended by signal 11 (Segmentation fault)");
  EXPECT_EQ(of(report, "poisoned").attempts, 2);
  EXPECT_EQ(of(report, "killed").cause, "ended by signal 9 (Killed)");
  EXPECT_TRUE(of(report, "once").is_done);
  EXPECT_EQ(of(report, "once").attempts, 2);
  EXPECT_FALSE(of(report, "hungry").is_done);
  EXPECT_LT(of(report, "hungry").megabytes, 1024.0);
  EXPECT_EQ(of(report, "thirsty").cause, "limit of memory");
  EXPECT_EQ(of(report, "hanging").cause, "limit of time");
  EXPECT_EQ(of(report, "stubborn").cause, "limit of time");
  EXPECT_EQ(of(report, "stubborn").attempts, 1);
  EXPECT_LT(of(report, "stubborn").seconds, 10.0);
  // What differs from head to head is no part of a cause.
  EXPECT_EQ(of(report, "refused").cause, "no face was found in # views");
  EXPECT_NE(of(report, "refused").message.find("give landmarks"), std::string::npos);
  EXPECT_EQ(of(report, "broken").cause.rfind("internal error", 0), 0U);
  EXPECT_EQ(of(report, "empty").cause, "no rig was written");
  for (const Record& record : report.records)
    EXPECT_EQ(fs::exists(options.output / record.id / "rig.glb"), record.is_done) << record.id;
  expect_no_leftovers();
}

TEST_F(Batch, WhatAKilledStepLeftIsReplaced) {
  add("a", "good");
  run();
  for (const char* name :
       {"rig.glb.0123456789abcdef.part", "thumbnail.png.0123456789abcdef.part", "stderr.txt"})
    std::ofstream(options.output / "a" / name) << "half";
  options.version = "2";
  EXPECT_EQ(run().fates[0], Fate::done);
  expect_whole("a");
  expect_no_leftovers();
}

TEST_F(Batch, AFaultOfTheMachineIsTriedAgain) {
  const std::vector<std::string> kinds = {"full", "large", "silent", "refused"};
  for (const std::string& kind : kinds)
    add(kind, kind);
  Report report = run();
  for (const std::string& kind : kinds) {
    EXPECT_FALSE(of(report, kind).is_done) << kind;
    EXPECT_EQ(of(report, kind).is_lasting, kind == "refused") << kind;
  }
  report = run();
  for (const std::string& kind : kinds)
    EXPECT_EQ(builds(kind), kind == "refused" ? 1U : 2U) << kind;
  EXPECT_EQ(report.fates, (std::vector<Fate>{Fate::failed, Fate::failed, Fate::failed, Fate::kept}));
}

TEST_F(Batch, AFileThatIsNotThereFailsAlone) {
  add("good", "good");
  heads.push_back({"missing", folder / "nothing.obj", "", "", {}});
  const Report report = run();
  EXPECT_TRUE(of(report, "good").is_done);
  EXPECT_FALSE(of(report, "missing").is_done);
  EXPECT_NE(of(report, "missing").message.find("nothing.obj"), std::string::npos);
  add("missing_too", "good");
  heads.back().landmarks = folder / "no_landmarks.json";
  run();
}

TEST_F(Batch, TwoAtOnceShareTheWork) {
  for (int i = 0; i < 12; ++i)
    add("head" + std::to_string(i), "slow");
  Report first, second;
  std::thread other([&] { second = run_all(heads, options, stop, {}); });
  first = run();
  other.join();
  for (const Head& head : heads) {
    expect_whole(head.id);
    EXPECT_EQ(builds(head.id), 1U) << head.id;
  }
  expect_no_leftovers();
}

TEST_F(Batch, StopsSoonWithoutPartialFiles) {
  for (int i = 0; i < 40; ++i)
    add("head" + std::to_string(i), "slow");
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    stop = true;
  });
  const Report report = run();
  stopper.join();
  size_t done = 0;
  for (const Record& record : all_records(options.output)) {
    expect_whole(record.id);
    ++done;
  }
  EXPECT_LT(done, 40U);
  expect_no_leftovers();
  stop = false;
  run();
  for (const Head& head : heads)
    expect_whole(head.id);
}

TEST_F(Batch, AKilledBatchIsResumed) {
  for (int i = 0; i < 12; ++i)
    add("head" + std::to_string(i), "slow");
  const pid_t child = fork();
  if (child == 0) {
    run_all(heads, options, stop, {});
    _exit(0);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // its workers end with it
  const std::vector<Record> before = all_records(options.output);
  for (const Record& record : before)
    expect_whole(record.id);
  run();
  for (const Head& head : heads)
    expect_whole(head.id);
  for (const Record& record : before)
    EXPECT_EQ(builds(record.id), 1U) << record.id;
  expect_no_leftovers();
}

TEST_F(Batch, ReadOnlyFoldersAreSaid) {
  add("a", "good");
  options.output = "/proc/nowhere";
  EXPECT_THROW(run(), Error);
  options.output = folder / "out";
  options.tool = folder / "no_tool";
  const Report report = run();
  EXPECT_EQ(of(report, "a").cause, "the tool cannot be started");
  options.tool = folder / "tool";
  EXPECT_EQ(run().fates[0], Fate::done);
}

}  // namespace
}  // namespace fascia::batch
