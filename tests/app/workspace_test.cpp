#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "app/workspace.h"
#include "tests/rig/tiny_rig.h"

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// A workspace in a folder of its own, with the tiny rig opened.
class WorkspaceTest : public testing::Test {
 protected:
  WorkspaceTest() : folder_(fs::temp_directory_path() / ("fascia_workspace_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const auto bytes = test::tiny_rig_file();
    std::ofstream(folder_ / "tiny.glb", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    std::ofstream(folder_ / "smile.csv") << "time,arkit:mouthSmileLeft,unknown\n0,0,1\n0.5,1,1\n1,0,1\n";
    renew();
  }
  ~WorkspaceTest() override {
    work_.reset();
    fs::remove_all(folder_);
  }

  void renew() {
    work_.reset();
    work_ = std::make_unique<Workspace>(Workspace::Places{folder_ / "state", "/bin/true"},
                                        Simulation::Pace::lockstep);
    work_->rebuilds_by_itself = false;
  }
  void open() {
    work_->open(folder_ / "tiny.glb");
    for (int i = 0; i < 2000 && work_->is_building(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      work_->update(1.0 / 60.0);
    }
    ASSERT_TRUE(work_->rig) << (work_->notices.empty() ? "" : work_->notices.back().text);
  }
  void run(int frames) {
    for (int i = 0; i < frames; ++i)
      work_->update(1.0 / 60.0);
  }
  double distance_from_rest() const {
    double largest = 0.0;
    const auto& part = work_->rig->asset->parts[0];
    for (size_t i = 0; i < part.rest.size(); ++i)
      largest =
          std::max(largest, std::abs(static_cast<double>(work_->frame->positions[0][i] - part.rest[i])));
    return largest;
  }

  fs::path folder_;
  std::unique_ptr<Workspace> work_;
};

TEST_F(WorkspaceTest, AValueMovesTheFaceAndUndoBringsItBack) {
  open();
  EXPECT_LT(distance_from_rest(), 1e-7);
  work_->settings.is_symmetric = true;
  work_->set_value("zygomaticus_major_left", 1.0, false);
  EXPECT_EQ(work_->value("zygomaticus_major_right"), 1.0);
  run(60);
  EXPECT_GT(distance_from_rest(), 1e-3);
  work_->undo();
  EXPECT_EQ(work_->value("zygomaticus_major_left"), 0.0);
  run(300);
  EXPECT_LT(distance_from_rest(), 1e-4);
  work_->redo();
  EXPECT_EQ(work_->value("zygomaticus_major_right"), 1.0);
}

TEST_F(WorkspaceTest, OneSideAloneAndOutOfRange) {
  open();
  work_->settings.is_symmetric = false;
  work_->set_value("zygomaticus_major_left", 7.0, false);
  EXPECT_EQ(work_->value("zygomaticus_major_left"), 1.0);
  EXPECT_EQ(work_->value("zygomaticus_major_right"), 0.0);
  work_->set_value("zygomaticus_major_left", std::nan(""), false);
  EXPECT_EQ(work_->value("zygomaticus_major_left"), 1.0);
}

TEST_F(WorkspaceTest, TheMousePullsTheSkinAndLetsItGo) {
  open();
  run(2);
  const Vec3 middle(0, work_->orbit.camera().target[1], 0);
  SkinHit hit = nearest_skin(*work_->rig->asset, *work_->frame, middle + Vec3(0, 0, 0.2));
  work_->poke(hit);
  ASSERT_TRUE(work_->held());
  work_->pull(hit.position + Vec3(0, 0, 0.01));
  run(60);
  const double pulled = distance_from_rest();
  EXPECT_GT(pulled, 2e-4);
  EXPECT_LT(pulled, 0.03);
  work_->let_go();
  run(400);
  EXPECT_LT(distance_from_rest(), 0.2 * pulled);
}

TEST_F(WorkspaceTest, ATakePlaysToItsEndOrInALoop) {
  open();
  work_->load_take(folder_ / "smile.csv");
  ASSERT_TRUE(work_->take);
  EXPECT_TRUE(work_->playback.is_playing);
  DocumentState next = work_->state();
  next.take.loops = false;
  next.take.begin = 0.25;
  work_->commit(next, "once");
  work_->playback.time = 0.25;
  run(30);
  EXPECT_GT(distance_from_rest(), 1e-4);
  run(60);
  EXPECT_FALSE(work_->playback.is_playing);
  EXPECT_DOUBLE_EQ(work_->playback.time, 1.0);
  next.take.loops = true;
  work_->commit(next, "loop");
  work_->playback.is_playing = true;
  run(90);
  EXPECT_TRUE(work_->playback.is_playing);
  EXPECT_GE(work_->playback.time, 0.25);
}

TEST_F(WorkspaceTest, WhatSlidersDoIsRecordedAsATake) {
  open();
  work_->start_recording();
  for (int i = 0; i < 30; ++i) {
    work_->set_value("jaw_open", i / 30.0, true);
    work_->update(1.0 / 60.0);
  }
  work_->stop_recording();
  ASSERT_TRUE(work_->take);
  EXPECT_EQ(work_->take->names(), std::vector<std::string>{"jaw_open"});
  EXPECT_NEAR(work_->take->duration(), 29.0 / 60.0, 1e-6);
  EXPECT_TRUE(work_->state().pose.empty());
}

TEST_F(WorkspaceTest, ComparesWithRestAndRefusesOtherMeshes) {
  open();
  work_->compare_with(Reference::rest);
  EXPECT_EQ(work_->reference_positions.size(), work_->rig->asset->parts.size());
  std::ofstream(folder_ / "other.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  work_->compare_with(Reference::file, (folder_ / "other.obj").string());
  EXPECT_EQ(work_->comparison.reference, Reference::none);
  ASSERT_FALSE(work_->notices.empty());
  EXPECT_EQ(work_->notices.back().kind, Notice::Kind::error);
}

TEST_F(WorkspaceTest, ReportsInvalidFilesAndKeepsTheOpenRig) {
  open();
  std::ofstream(folder_ / "empty.obj");
  std::ofstream(folder_ / "nonsense.csv") << "nothing at all";
  for (const char* name : {"missing.glb", "empty.obj", "nonsense.csv"}) {
    work_->notices.clear();
    work_->open(folder_ / name);
    for (int i = 0; i < 2000 && work_->is_building(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      work_->update(1.0 / 60.0);
    }
    ASSERT_FALSE(work_->notices.empty()) << name;
    EXPECT_EQ(work_->notices.back().kind, Notice::Kind::error) << name;
    EXPECT_TRUE(work_->rig) << name;
  }
}

TEST_F(WorkspaceTest, ASessionThatEndedInACrashIsOfferedAgain) {
  open();
  work_->set_value("jaw_open", 0.5, false);
  run(120);
  // A crash: nothing is tidied up.
  fs::copy_file(folder_ / "state/autosave.json", folder_ / "kept.json");
  work_.reset();
  EXPECT_FALSE(fs::exists(folder_ / "state/autosave.json"));
  fs::copy_file(folder_ / "kept.json", folder_ / "state/autosave.json");
  renew();
  ASSERT_TRUE(work_->left_behind);
  EXPECT_EQ(work_->left_behind->pose.at("jaw_open"), 0.5);
  work_->restore(*work_->left_behind);
  for (int i = 0; i < 2000 && work_->is_building(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    work_->update(1.0 / 60.0);
  }
  ASSERT_TRUE(work_->rig);
  EXPECT_EQ(work_->value("jaw_open"), 0.5);
}

TEST(ToolJob, ReportsItsResultAndCanBeCancelled) {
  const auto wait = [](ToolJob& job) {
    for (int i = 0; i < 1000 && !job.poll(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  ToolJob good("/bin/sh", {"-c", "echo out; echo err >&2; exit 4"}, "good");
  wait(good);
  EXPECT_TRUE(good.is_done());
  EXPECT_EQ(good.exit_code(), 4);
  EXPECT_EQ(good.output(), "out\n");
  EXPECT_EQ(good.message(), "err\n");
  ToolJob slow("/bin/sleep", {"100"}, "slow");
  EXPECT_FALSE(slow.poll());
  slow.cancel();
  wait(slow);
  EXPECT_TRUE(slow.was_cancelled());
  EXPECT_NE(slow.exit_code(), 0);
}

}  // namespace
}  // namespace fascia::app
