#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "app/model/command_line.h"
#include "app/model/document.h"
#include "app/model/input_script.h"
#include "app/model/names.h"
#include "app/model/orbit.h"
#include "app/model/settings.h"
#include "app/model/sketch.h"
#include "builder/rigging/edits.h"
#include "geometry/error.h"

namespace fascia::app {
namespace {

TEST(History, UndoBringsBackExactlyWhatWas) {
  History<DocumentState> history;
  DocumentState next;
  set_pose(next, "jaw_open", 0.5);
  history.commit(next, "Jaw open");
  set_landmark(next, "nasion", Vec3(1, 2, 3));
  history.commit(next, "Move nasion");
  EXPECT_EQ(history.undo_label(), "Move nasion");
  EXPECT_TRUE(history.undo());
  EXPECT_FALSE(landmark_edit(history.state(), "nasion"));
  EXPECT_EQ(history.redo_label(), "Move nasion");
  EXPECT_TRUE(history.undo());
  EXPECT_TRUE(history.state() == DocumentState());
  EXPECT_FALSE(history.undo());
  EXPECT_TRUE(history.redo());
  EXPECT_TRUE(history.redo());
  EXPECT_TRUE(history.state() == next);
  EXPECT_FALSE(history.redo());
}

TEST(History, ADragIsOneStepAndTheNextDragAnother) {
  History<int> history(0);
  for (const int value : {1, 2, 3})
    history.commit(value, "drag", "slider");
  EXPECT_EQ(history.steps(), 1U);
  history.seal();
  history.commit(4, "drag", "slider");
  EXPECT_EQ(history.steps(), 2U);
  history.commit(5, "other", "another slider");
  EXPECT_EQ(history.steps(), 3U);
  history.undo();
  history.undo();
  EXPECT_EQ(history.state(), 3);
  history.undo();
  EXPECT_EQ(history.state(), 0);
}

TEST(History, EmptyChangesAddNoStepAndNewStepsDropUndoneOnes) {
  History<int> history(7);
  history.commit(7, "nothing");
  EXPECT_FALSE(history.can_undo());
  history.commit(8, "a");
  history.undo();
  history.commit(9, "b");
  EXPECT_FALSE(history.can_redo());
  EXPECT_EQ(history.state(), 9);
}

TEST(History, KeepsNoMoreThanItsLimit) {
  History<int> history(0, 10);
  for (int i = 1; i < 100; ++i)
    history.commit(i, "step");
  EXPECT_LT(history.steps(), 11U);
  while (history.undo()) {
  }
  EXPECT_GT(history.state(), 80);
}

TEST(Document, EditsAreWhatTheBuilderReads) {
  DocumentState state;
  state.edits["units"] = "mm";  // of a file that was loaded: to be kept
  set_landmark(state, "cheilion_left", Vec3(26.1, -35, 101.2));
  set_muscle_number(state, "zygomaticus_major_superior_left", "strength", 1.4, 1.0);
  set_muscle_present(state, "procerus_right", false);
  set_muscle_variant(state, "frontalis_lateral_left", "wide");
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "fascia_app_edits.json";
  write_edits_file(file, state.edits);
  const rigging::Edits edits = rigging::read_edits(file);
  EXPECT_EQ(edits.units, "mm");
  EXPECT_NEAR((edits.landmarks.at("cheilion_left") - Vec3(26.1, -35, 101.2)).norm(), 0.0, 1e-12);
  EXPECT_EQ(edits.muscles.at("zygomaticus_major_superior_left").strength, 1.4);
  EXPECT_EQ(edits.muscles.at("procerus_right").is_present, false);
  EXPECT_EQ(edits.muscles.at("frontalis_lateral_left").variant, "wide");
  EXPECT_EQ(read_edits_file(file), state.edits);
  std::filesystem::remove(file);
}

TEST(Document, TakingBackTheLastEditLeavesNoTrace) {
  DocumentState state;
  set_landmark(state, "nasion", Vec3(1, 2, 3));
  set_muscle_number(state, "procerus_left", "width", 2.0, 1.0);
  set_muscle_present(state, "procerus_left", false);
  clear_landmark(state, "nasion");
  set_muscle_number(state, "procerus_left", "width", 1.0, 1.0);
  set_muscle_present(state, "procerus_left", true);
  EXPECT_TRUE(state == DocumentState());
}

TEST(Document, SurvivesBeingWrittenAndNonsenseIsRefused) {
  DocumentState state;
  state.head = "/heads/an na.obj";
  set_pose(state, "arkit:jawOpen", 0.25);
  set_landmark(state, "nasion", Vec3(0.1, 1e-17, -3));
  state.take = {"take.csv", 0.5, 2.0, false};
  EXPECT_TRUE(state_from_text(to_text(state), "x") == state);
  for (const char* text :
       {"", "[]", "{}", "{\"head\": 3}", "{\"head\":\"a\",\"edits\":[],\"pose\":{},\"take\":{}}"})
    EXPECT_THROW(state_from_text(text, "x"), Error) << text;
}

TEST(Names, SidesComeOffAndOn) {
  EXPECT_EQ(title_of("zygomaticus_major_left"), "Zygomaticus major");
  EXPECT_EQ(full_title("zygomaticus_major_left"), "Zygomaticus major, left");
  EXPECT_EQ(title_of("arkit:mouthSmileLeft"), "Mouth smile");
  EXPECT_EQ(title_of("au:L12"), "AU 12");
  EXPECT_EQ(mirrored("zygomaticus_major_left"), "zygomaticus_major_right");
  EXPECT_EQ(mirrored("arkit:mouthSmileRight"), "arkit:mouthSmileLeft");
  EXPECT_EQ(mirrored("au:R12"), "au:L12");
  for (const char* name : {"jaw_open", "arkit:jawOpen", "au:12", "viseme:PP", "nasion", "arkit:jawLeft"})
    EXPECT_EQ(mirrored(name), name);
  for (const char* name : {"frontalis_medial_left", "arkit:browDownRight", "au:L4"})
    EXPECT_EQ(mirrored(mirrored(name)), name);
}

TEST(Names, SearchTakesWordsInAnyOrder) {
  EXPECT_TRUE(matches("Zygomaticus major", "maj zyg"));
  EXPECT_TRUE(matches("Zygomaticus major", ""));
  EXPECT_TRUE(matches("Zygomaticus major", "  MAJOR "));
  EXPECT_FALSE(matches("Zygomaticus major", "minor"));
}

TEST(CommandLine, IsWhatAShellTakes) {
  DocumentState state;
  state.head = "/tmp/it's a head.obj";
  set_pose(state, "jaw_open", 0.5);
  EXPECT_EQ(shell_text(build_command(state, "", "rig.glb")),
            "fascia build '/tmp/it'\\''s a head.obj' -o rig.glb");
  EXPECT_EQ(shell_text(pose_command(state.pose, "rig.glb", "out.obj")),
            "fascia pose rig.glb --set jaw_open=0.5 -o out.obj");
  EXPECT_EQ(shell_text(play_command({"a.csv", 0.123456, 2.0, true}, {}, "rig.glb", 30, "o.glb")),
            "fascia play rig.glb --curves a.csv --fps 30 --from 0.123456 --to 2 -o o.glb");
  TakeChoice layered = {"a.csv", 0.0, -1.0, true, 0.5, false, {{"b.csv", 0.25, false}, {"c.csv", 1.0, true}}};
  EXPECT_EQ(shell_text(play_command(layered, state.pose, "rig.glb", 30, "o.glb")),
            "fascia play rig.glb --curves a.csv --weight 0.5 --layer b.csv=0.25 --layer c.csv=0 --set "
            "jaw_open=0.5 --fps 30 -o o.glb");
}

TEST(Orbit, ARayThroughAPointsPixelMeetsThePoint) {
  Orbit orbit;
  orbit.frame({Vec3(-0.1, -0.12, -0.1), Vec3(0.1, 0.12, 0.1)});
  for (const double yaw : {0.0, 38.0, -120.0}) {
    orbit.turn(yaw, 11.0);
    for (const Vec3& point : {Vec3(0.03, 0.05, 0.08), Vec3(-0.07, -0.02, 0.01)}) {
      const auto pixel = orbit.pixel(point, 900, 600);
      ASSERT_TRUE(pixel);
      const Ray ray = orbit.ray((*pixel)[0], (*pixel)[1], 900, 600);
      const Vec3 to = point - ray.origin;
      EXPECT_LT((to - to.dot(ray.direction) * ray.direction).norm(), 1e-12);
    }
  }
}

TEST(Orbit, GlidesToItsGoalAndStops) {
  Orbit orbit;
  orbit.frame({Vec3(-0.1, -0.12, -0.1), Vec3(0.1, 0.12, 0.1)});
  orbit.go_to("left");
  int frames = 0;
  while (orbit.advance(1.0 / 60.0, false))
    ASSERT_LT(++frames, 200);
  EXPECT_GT(frames, 5);
  EXPECT_DOUBLE_EQ(orbit.camera().yaw, 90.0);
}

TEST(Script, IsReadAndFaultsNameTheirLine) {
  const auto steps =
      parse_script("# a tour\nopen \"my head.obj\"  # with a comment\n\nset jaw_open 0.5\n", "tour");
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].words[0], "my head.obj");
  EXPECT_EQ(steps[1].line, 4);
  for (const auto& [text, what] : {std::pair("\nfly away", "tour:2: 'fly'"),
                                   {"set jaw_open", "tour:1: use set"},
                                   {"open \"a", "tour:1: a quotation mark"},
                                   {"undo 3", "tour:1: use undo"}})
    try {
      parse_script(text, "tour");
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind(what, 0), 0U) << error.what();
    }
}

TEST(Settings, ComeBackAndNonsenseIsTakenAsDefault) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "fascia_app_settings";
  Settings settings;
  settings.is_light = true;
  settings.panel_width = 444;
  settings.favourites = {"jaw_open"};
  settings.layers = layers_of("skin,muscles");
  for (const char* file : {"a", "b", "a"})
    settings.remember(file);
  write_settings(folder / "view.json", settings);
  const Settings read = read_settings(folder / "view.json");
  EXPECT_TRUE(read.is_light);
  EXPECT_EQ(read.panel_width, 444);
  EXPECT_EQ(read.recent, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(read.favourites, settings.favourites);
  EXPECT_TRUE(read.layers == settings.layers);
  std::ofstream(folder / "view.json") << R"({"width": "wide", "height": -4, "scale": 1e9, "recent": 7})";
  const Settings mended = read_settings(folder / "view.json");
  EXPECT_EQ(mended.width, Settings().width);
  EXPECT_EQ(mended.height, 480);
  EXPECT_EQ(mended.scale, 4.0);
  std::ofstream(folder / "view.json") << "nonsense";
  EXPECT_EQ(read_settings(folder / "view.json").panel, Settings().panel);
  std::filesystem::remove_all(folder);
}

TEST(Layers, AreNamedAsTheToolNamesThem) {
  for (const char* names :
       {"skin,eyes", "skin,eyes,skull,fat,smas,muscles,ligaments,lattice,landmarks", "muscles", "eyes"})
    EXPECT_EQ(names_of(layers_of(names)), names);
  EXPECT_LT(layers_of("skin,fat").skin_opacity, 0.5) << "what lies beneath shows through";
  EXPECT_EQ(layers_of("skin,landmarks").skin_opacity, 1.0);
}

std::vector<Vec3> ring_stroke(double radius, double from, double to, int count) {
  std::vector<Vec3> stroke;
  for (int i = 0; i < count; ++i) {
    const double angle = from + (to - from) * i / (count - 1);
    stroke.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.1);
  }
  return stroke;
}

TEST(Sketches, AStrokeBecomesAClosedCurveOfEvenSteps) {
  const double radius = 0.01;
  const std::vector<Vec3> curve = closed_curve(ring_stroke(radius, 0.0, 2.0 * EIGEN_PI, 50));
  // Two millimetres a step on a circumference of 62.8.
  ASSERT_EQ(curve.size(), 32U);
  for (size_t i = 0; i < curve.size(); ++i) {
    EXPECT_NEAR((curve[(i + 1) % curve.size()] - curve[i]).norm(), 0.00196, 2e-5) << i;
    EXPECT_NEAR(curve[i].head<2>().norm(), radius, 5e-5);
  }
  EXPECT_EQ(sketch_fault(curve), "");
  // However long, an edits file stays readable.
  EXPECT_EQ(closed_curve(ring_stroke(0.1, 0.0, 2.0 * EIGEN_PI, 400)).size(), 64U);
  EXPECT_EQ(closed_curve({Vec3::Zero()}).size(), 1U);
}

TEST(Sketches, AHandThatEndsBeyondItsBeginningClosesTheCurve) {
  // It spirals inwards and crosses its beginning.
  std::vector<Vec3> stroke = ring_stroke(0.01, 0.0, 2.4 * EIGEN_PI, 80);
  for (size_t i = 0; i < stroke.size(); ++i)
    stroke[i].head<2>() *= 1.0 + 0.1 * std::sin(0.08 * static_cast<double>(i));
  EXPECT_EQ(sketch_fault(closed_curve(stroke)), "");
}

TEST(Sketches, WhatIsNoRegionIsToldWithTheReason) {
  std::vector<Vec3> eight;
  for (int i = 0; i < 60; ++i) {
    const double t = 2.0 * EIGEN_PI * (i + 0.5) / 60.0;
    eight.emplace_back(0.02 * std::sin(t), 0.01 * std::sin(2.0 * t), 0.1);
  }
  EXPECT_NE(sketch_fault(closed_curve(eight)).find("crosses itself"), std::string::npos);
  EXPECT_NE(sketch_fault({Vec3::Zero(), Vec3(0.01, 0, 0)}).find("three or more"), std::string::npos);
  EXPECT_NE(sketch_fault(closed_curve(ring_stroke(0.0003, 0.0, 6.2, 20))).find("wide"), std::string::npos);
}

TEST(Sketches, StandInTheEditsInTheirAxesAndUnits) {
  Mat4 to_metres = Mat4::Identity();
  to_metres.topLeftCorner<3, 3>() *= 0.01;  // a head in centimetres
  to_metres(1, 3) = 0.5;
  const std::vector<Vec3> curve = {Vec3(0.02, 0.51, 0.03), Vec3(0.03, 0.51, 0.03), Vec3(0.02, 0.52, 0.03)};
  for (const auto& [units, unit] :
       {std::pair<nlohmann::ordered_json, double>(nullptr, 100.0), {"mm", 1000.0}, {0.1, 10.0}}) {
    DocumentState state;
    if (!units.is_null()) state.edits["units"] = units;
    set_muscle_sketch(state, "risorius_left", MuscleEnd::insertion, curve, to_metres);
    const auto& first = state.edits["muscles"]["risorius_left"]["insertion"]["curve"][0];
    EXPECT_NEAR(first[0].get<double>(), 0.02 * unit, 1e-9) << units;
    EXPECT_NEAR(first[1].get<double>(), 0.01 * unit, 1e-9) << units;
    const std::vector<Vec3> back = muscle_sketch(state, "risorius_left", MuscleEnd::insertion, to_metres);
    ASSERT_EQ(back.size(), 3U);
    for (size_t i = 0; i < 3; ++i)
      EXPECT_LT((back[i] - curve[i]).norm(), 1e-12);
    EXPECT_TRUE(muscle_sketch(state, "risorius_left", MuscleEnd::origin, to_metres).empty());
    EXPECT_EQ(count_sketches(state), 1U);
    set_muscle_sketch(state, "risorius_left", MuscleEnd::insertion, {}, to_metres);
    EXPECT_EQ(count_sketches(state), 0U);
    EXPECT_FALSE(state.edits.contains("muscles"));
  }
}

}  // namespace
}  // namespace fascia::app
