#include <gtest/gtest.h>
#include <sys/stat.h>
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

TEST_F(WorkspaceTest, ComparesWithRestAndRefusesOtherMeshes) {
  open();
  work_->compare_with(Reference::rest);
  run(1);
  ASSERT_TRUE(work_->reference_frame);
  EXPECT_EQ(work_->reference_frame->positions[0], work_->rig->asset->parts[0].rest);
  std::ofstream(folder_ / "other.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  work_->compare_with(Reference::file, (folder_ / "other.obj").string());
  run(1);
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
    settle(*work_);
    ASSERT_FALSE(work_->notices.empty()) << name;
    EXPECT_EQ(work_->notices.back().kind, Notice::Kind::error) << name;
    EXPECT_TRUE(work_->rig) << name;
  }
}

/// The folders of open windows and of those that crashed.
std::vector<fs::path> sessions_in(const fs::path& state) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(state / "sessions"))
    if (entry.is_directory()) folders.push_back(entry.path());
  return folders;
}

TEST_F(WorkspaceTest, ASessionThatEndedInACrashIsOfferedAgain) {
  open();
  work_->set_value("jaw_open", 0.5, false);
  run(120);
  const auto folders = sessions_in(folder_ / "state");
  ASSERT_EQ(folders.size(), 1U);
  // A crash: nothing is tidied up, and the lock is let go.
  fs::copy(folders[0], folder_ / "kept", fs::copy_options::recursive);
  work_.reset();
  EXPECT_TRUE(sessions_in(folder_ / "state").empty());
  fs::create_directories(folder_ / "kept/built/1");
  fs::copy(folder_ / "kept", folder_ / "state/sessions/window-crashed", fs::copy_options::recursive);
  renew();
  ASSERT_TRUE(work_->left_behind());
  EXPECT_EQ(work_->left_behind()->pose.at("jaw_open"), 0.5);
  EXPECT_FALSE(fs::exists(folder_ / "state/sessions/window-crashed/built"));
  // Another window does not offer it too.
  Workspace second({folder_ / "state", "/bin/true"}, Simulation::Pace::lockstep);
  EXPECT_FALSE(second.left_behind());
  work_->restore();
  EXPECT_TRUE(fs::exists(folder_ / "state/sessions/window-crashed/autosave.json"));
  settle(*work_);
  ASSERT_TRUE(work_->rig);
  EXPECT_EQ(work_->value("jaw_open"), 0.5);
  EXPECT_FALSE(work_->left_behind());
  EXPECT_FALSE(fs::exists(folder_ / "state/sessions/window-crashed"));
}

TEST_F(WorkspaceTest, OfCrashedSessionsTheNewestIsOfferedAndUselessOnesAreRemoved) {
  const fs::path sessions = folder_ / "state/sessions";
  DocumentState state;
  for (const char* name : {"old", "new"}) {
    fs::create_directories(sessions / name);
    state.head = std::string(name) + ".obj";
    std::ofstream(sessions / name / "autosave.json") << to_text(state);
  }
  fs::last_write_time(sessions / "old/autosave.json",
                      fs::file_time_type::clock::now() - std::chrono::hours(2));
  fs::create_directories(sessions / "empty/built");
  fs::create_directories(sessions / "torn");
  std::ofstream(sessions / "torn/autosave.json") << "{\"head\":";
  renew();
  ASSERT_TRUE(work_->left_behind());
  EXPECT_EQ(work_->left_behind()->head, "new.obj");
  EXPECT_FALSE(fs::exists(sessions / "empty"));
  EXPECT_FALSE(fs::exists(sessions / "torn"));
  work_->forget_left_behind();
  EXPECT_FALSE(fs::exists(sessions / "new"));
  renew();
  ASSERT_TRUE(work_->left_behind());
  EXPECT_EQ(work_->left_behind()->head, "old.obj");
  // A window that closes without having taken it over leaves it for the next.
  renew();
  EXPECT_TRUE(work_->left_behind());
}

TEST_F(WorkspaceTest, TwoWindowsKeepTheirBuildsAndAutosavesApart) {
  open();
  Workspace second({folder_ / "state", "/bin/true"}, Simulation::Pace::lockstep);
  second.rebuilds_by_itself = false;
  fs::copy_file(folder_ / "tiny.glb", folder_ / "other.glb");
  second.open(folder_ / "other.glb");
  settle(second);
  ASSERT_TRUE(second.rig);
  EXPECT_NE(work_->rig->head, second.rig->head);
  EXPECT_TRUE(fs::exists(work_->rig->head)) << "the second window has not taken the first for a crashed one";
  work_->set_value("jaw_open", 0.25, false);
  second.set_value("jaw_open", 0.75, false);
  run(120);
  for (int i = 0; i < 120; ++i)
    second.update(1.0 / 60.0);
  std::vector<std::string> heads;
  for (const fs::path& folder : sessions_in(folder_ / "state"))
    if (const auto saved = Autosave(folder / "autosave.json").left_behind()) {
      heads.push_back(fs::path(saved->head).filename().string());
      EXPECT_EQ(saved->pose.at("jaw_open"), heads.back() == "tiny.glb" ? 0.25 : 0.75);
    }
  std::sort(heads.begin(), heads.end());
  EXPECT_EQ(heads, (std::vector<std::string>{"other.glb", "tiny.glb"}));
}

TEST_F(WorkspaceTest, TheCopiedCommandNamesFilesThatAreThere) {
  open();
  const std::string head = (folder_ / "tiny.glb").string();
  work_->set_value("jaw_open", 0.5, false);
  EXPECT_EQ(work_->copy_command(), "fascia pose " + head + " --set jaw_open=0.5 -o tiny_posed.glb");

  DocumentState next = work_->state();
  set_muscle_number(next, "zygomaticus_major_left", "strength", 2.0, 1.0);
  work_->commit(next, "stronger");
  std::string command = work_->copy_command();
  const std::string begin = "fascia build " + head + " -o tiny_rig.glb --edits ";
  ASSERT_EQ(command.rfind(begin, 0), 0U) << command;
  const size_t end = command.find(" && fascia pose tiny_rig.glb --set jaw_open=0.5 -o tiny_posed.glb");
  ASSERT_NE(end, std::string::npos) << command;
  const fs::path edits = command.substr(begin.size(), end - begin.size());
  ASSERT_TRUE(fs::exists(edits));
  EXPECT_EQ(read_edits_file(edits), next.edits);

  ASSERT_TRUE(work_->save_edits(folder_ / "mine.json"));
  command = work_->copy_command();
  EXPECT_NE(command.find("--edits " + (folder_ / "mine.json").string() + " "), std::string::npos) << command;
}

TEST_F(WorkspaceTest, ExportsShowWhatIsSeen) {
  open();
  work_->orbit.turn(20.0, -10.0);
  work_->load_take(folder_ / "smile.csv");
  work_->wait_for_files();
  work_->playback.is_playing = false;
  work_->playback.time = 0.5;
  run(60);
  // The recording moves muscles that no slider does.
  const auto pose = work_->standing_pose();
  EXPECT_GT(pose.at("zygomaticus_major_left"), 0.1);
  work_->draw_picture(folder_ / "picture.png", 1.5);
  ASSERT_EQ(work_->jobs().size(), 1U);
  const auto& words = work_->jobs().front()->arguments();
  const auto after = [&](const std::string& option) {
    const auto found = std::find(words.begin(), words.end(), option);
    return found == words.end() || found + 1 == words.end() ? "" : *(found + 1);
  };
  EXPECT_EQ(after("--camera"), "20,-10");
  EXPECT_EQ(after("--size"), "2400x1600");
  double x = 0, y = 0, z = 0, distance = 0;
  ASSERT_EQ(std::sscanf(after("--look-at").c_str(), "%lf,%lf,%lf,%lf", &x, &y, &z, &distance), 4);
  EXPECT_LT((Vec3(x, y, z) - work_->orbit.camera().target).norm(), 1e-5);
  EXPECT_NEAR(distance, work_->orbit.camera().distance, 1e-5);
}

TEST_F(WorkspaceTest, AtRestNothingIsContracted) {
  open();
  work_->set_value("zygomaticus_major_left", 1.0, false);
  work_->compare_with(Reference::rest);
  run(60);
  const int channel = work_->rig->asset->channel("zygomaticus_major_left");
  EXPECT_GT(work_->frame->values[static_cast<size_t>(channel)], 0.9F);
  EXPECT_EQ(work_->reference_frame->values[static_cast<size_t>(channel)], 0.0F);
  EXPECT_NE(work_->frame->fibre_points, work_->reference_frame->fibre_points);
  EXPECT_FALSE(work_->reference_frame->nodes.empty());
}

TEST_F(WorkspaceTest, ComparesTwoHeadsInOnePose) {
  open();
  fs::copy_file(folder_ / "tiny.glb", folder_ / "other.glb");
  work_->set_value("jaw_open", 1.0, false);
  work_->compare_with(Reference::other, (folder_ / "other.glb").string());
  EXPECT_FALSE(work_->is_divided());
  settle(*work_);
  run(400);
  ASSERT_TRUE(work_->reference_frame);
  EXPECT_TRUE(work_->is_divided());
  EXPECT_EQ(work_->reference_rig()->file, folder_ / "other.glb");
  const auto apart = distances_between(*work_->frame, work_->reference_frame->positions);
  EXPECT_GT(distance_from_rest(), 5e-3);
  EXPECT_LT(*std::max_element(apart[0].begin(), apart[0].end()), 1e-4F);
  work_->compare_with(Reference::other, (folder_ / "smile.csv").string());
  work_->notices.clear();
  settle(*work_);
  EXPECT_EQ(work_->comparison.reference, Reference::none);
  EXPECT_FALSE(work_->notices.empty());
}

/// A circle on the skin about the vertex that is nearest to a point, metres at rest.
std::vector<Vec3> circle_on_skin(const Workspace& work, const Vec3& about, double radius) {
  const SkinHit middle = nearest_skin(*work.rig->asset, *work.frame, about);
  std::vector<Vec3> stroke;
  for (int i = 0; i <= 40; ++i) {
    const double angle = 2.0 * EIGEN_PI * i / 40.0;
    stroke.push_back(middle.position + radius * Vec3(std::cos(angle), std::sin(angle), 0.0));
  }
  return stroke;
}

TEST_F(WorkspaceTest, ARegionDrawnOnTheSkinIsOneStepOfTheEdits) {
  open();
  run(2);
  work_->settings.is_symmetric = true;
  const std::vector<Vec3> stroke = circle_on_skin(*work_, Vec3(0.03, 0.0, 0.2), 0.006);
  EXPECT_EQ(work_->sketch_region("zygomaticus_major_left", MuscleEnd::insertion, stroke), "");
  EXPECT_EQ(count_sketches(work_->state()), 2U);
  EXPECT_TRUE(work_->has_unbuilt_edits());
  const std::vector<SkinHit> drawn = work_->sketch_now("zygomaticus_major_left", MuscleEnd::insertion);
  EXPECT_GE(drawn.size(), 8U);
  EXPECT_EQ(work_->sketch_now("zygomaticus_major_right", MuscleEnd::insertion).size(), drawn.size());
  // On the other side of the face.
  EXPECT_LT(drawn.front().rest[0] *
                work_->sketch_now("zygomaticus_major_right", MuscleEnd::insertion).front().rest[0],
            0.0);
  ASSERT_TRUE(work_->save_edits(folder_ / "edits.json"));
  EXPECT_EQ(read_edits_file(folder_ / "edits.json"), work_->state().edits);

  work_->undo();
  EXPECT_EQ(count_sketches(work_->state()), 0U);
  work_->redo();
  EXPECT_EQ(count_sketches(work_->state()), 2U);
  work_->settings.is_symmetric = false;
  work_->clear_sketch("zygomaticus_major_left", MuscleEnd::insertion);
  EXPECT_EQ(count_sketches(work_->state()), 1U);
}

TEST_F(WorkspaceTest, WhatIsNoRegionChangesNothingAndIsTold) {
  open();
  run(2);
  const std::string fault = work_->sketch_region("zygomaticus_major_left", MuscleEnd::origin, {});
  EXPECT_NE(fault.find("beside the skin"), std::string::npos);
  EXPECT_EQ(count_sketches(work_->state()), 0U);
  ASSERT_FALSE(work_->notices.empty());
  EXPECT_NE(work_->notices.back().text.find("origin of Zygomaticus major, left"), std::string::npos);
}

}  // namespace
}  // namespace fascia::app
