#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "app/scene/scene_list.h"
#include "app/workspace.h"
#include "tests/app/workspace_fixture.h"

namespace fascia::app {
namespace {

/// The value of a channel after the face has taken up what the timeline holds now.
double channel_now(Workspace& work, const std::string& name) {
  work.update(1.0 / 60.0);
  return static_cast<double>(work.frame->values[static_cast<size_t>(work.rig->asset->channel(name))]);
}

TEST_F(WorkspaceTest, ATakePlaysToItsEndOrInALoop) {
  open();
  work_->load_take(folder_ / "smile.csv");
  work_->wait_for_files();
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
  work_->wait_for_files();
  ASSERT_TRUE(work_->take);
  EXPECT_EQ(work_->take->names(), std::vector<std::string>{"jaw_open"});
  EXPECT_NEAR(work_->take->duration(), 29.0 / 60.0, 1e-6);
  EXPECT_TRUE(work_->state().pose.empty());
}

TEST_F(WorkspaceTest, ARecordingIsReadWithoutStandingStill) {
  // A pipe gives its bytes when somebody writes them: until then the window goes on.
  const fs::path pipe = folder_ / "pipe.csv";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  Workspace work({folder_ / "state", "/bin/true"}, Simulation::Pace::real_time);
  work.open(folder_ / "tiny.glb");
  settle(work);
  ASSERT_TRUE(work.rig);
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    std::ofstream(pipe) << "time,jaw_open\n0,0\n1,1\n";
  });
  work.load_take(pipe);
  EXPECT_FALSE(work.take);
  EXPECT_TRUE(work.is_busy());
  work.update(1.0 / 60.0);
  EXPECT_FALSE(work.take);
  writer.join();
  work.wait_for_files();
  ASSERT_TRUE(work.take);
  EXPECT_EQ(work.take->duration(), 1.0);
}

TEST_F(WorkspaceTest, UndoBringsBackTheRecordingThatWasThere) {
  open();
  std::ofstream(folder_ / "jaw.csv") << "time,jaw_open\n0,0\n2,1\n";
  for (const char* name : {"smile.csv", "jaw.csv"}) {
    work_->load_take(folder_ / name);
    work_->wait_for_files();
  }
  ASSERT_TRUE(work_->take);
  EXPECT_EQ(work_->take->duration(), 2.0);
  work_->undo();
  run(1);
  ASSERT_TRUE(work_->take);
  EXPECT_EQ(work_->take->duration(), 1.0);
  work_->redo();
  run(1);
  EXPECT_EQ(work_->take->duration(), 2.0);
}

TEST_F(WorkspaceTest, LayersAddUpByTheirWeightsUnlessTheyAreMuted) {
  open();
  std::ofstream(folder_ / "one.csv") << "time,jaw_open\n0,0.5\n1,0.5\n";
  std::ofstream(folder_ / "two.csv") << "time,jaw_open\n0,0.25\n2,0.25\n";
  work_->load_take(folder_ / "one.csv");
  work_->wait_for_files();
  work_->load_layer(folder_ / "two.csv");
  work_->wait_for_files();
  ASSERT_EQ(work_->state().take.layers.size(), 1U);
  work_->playback.is_playing = false;
  work_->playback.time = 0.5;
  EXPECT_EQ(work_->timeline_length(), 2.0);
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.75, 1e-6);
  work_->weigh_layer(0, 0.5);
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.625, 1e-6);
  work_->mute_layer(-1, true);
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.125, 1e-6);
  work_->mute_layer(0, true);
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.0, 1e-6);
  for (int i = 0; i < 3; ++i)
    work_->undo();
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.75, 1e-6);
  // A crash loses none of it.
  EXPECT_EQ(state_from_text(to_text(work_->state()), "x"), work_->state());
  work_->remove_layer(-1);
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.25, 1e-6);
  EXPECT_TRUE(work_->state().take.layers.empty());
  work_->undo();
  work_->wait_for_files();
  EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.75, 1e-6);
  work_->remove_layer(0);
  work_->remove_layer(-1);
  EXPECT_FALSE(work_->take);
}

TEST_F(WorkspaceTest, SlidersMovedOverATakeBecomeALayerThatLooksTheSame) {
  open();
  std::ofstream(folder_ / "one.csv") << "time,jaw_open\n0,0.25\n1,0.25\n";
  work_->load_take(folder_ / "one.csv");
  work_->wait_for_files();
  DocumentState next = work_->state();
  next.take.begin = 0.5;
  work_->commit(next, "trim");
  work_->start_recording();
  std::vector<double> seen;
  for (int i = 0; i < 200 && work_->playback.is_recording; ++i) {
    work_->set_value("jaw_open", 0.5 * work_->playback.time, true);
    seen.push_back(0.25 + 0.5 * work_->playback.time);
    work_->update(1.0 / 60.0);
  }
  EXPECT_FALSE(work_->playback.is_recording) << "it ends with the recording";
  EXPECT_LT(seen.size(), 40U) << "half a second";
  work_->wait_for_files();
  ASSERT_EQ(work_->state().take.layers.size(), 1U);
  EXPECT_TRUE(work_->state().pose.empty());
  work_->playback.is_playing = false;
  for (const double time : {0.6, 0.75, 0.9}) {
    work_->playback.time = time;
    EXPECT_NEAR(channel_now(*work_, "jaw_open"), 0.25 + 0.5 * time, 0.02) << time;
  }
  // What is set while it plays is in the command.
  work_->set_value("jaw_open", 0.125, false);
  const std::string command = work_->present_command().text;
  EXPECT_NE(command.find("--layer "), std::string::npos) << command;
  EXPECT_NE(command.find("--set jaw_open=0.125"), std::string::npos) << command;
  EXPECT_NE(command.find("--from 0.5"), std::string::npos) << command;
}

}  // namespace
}  // namespace fascia::app
