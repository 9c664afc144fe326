#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "anatomy/anatomy.h"
#include "builder/rigging/embedded_head.h"
#include "cli/bake_file.h"
#include "cli/common.h"
#include "cli/demo_curves.h"
#include "cli/picture.h"
#include "cli/play_file.h"
#include "cli/progress.h"
#include "cli/rig_build.h"
#include "cli/take/curves.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "view/image.h"
#include "view/video.h"

namespace fascia::cli {

namespace {

/// Prints how long each part of the demonstration took.
class Clock {
 public:
  explicit Clock(const Common& common) : common_(common) {}
  void say(const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    char line[160];
    std::snprintf(line, sizeof line, "%6.2f s  %s", std::chrono::duration<double>(now - last_).count(),
                  what.c_str());
    common_.say(line);
    last_ = std::chrono::steady_clock::now();
  }

 private:
  const Common& common_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct SheetPose {
  const char* caption;
  const char* view;
  const char* layers;
  std::vector<std::pair<const char*, double>> values;
};

std::vector<SheetPose> sheet_poses() {
  return {
      {"rest", "front", "skin,eyes", {}},
      {"rest", "three-quarter", "skin,eyes", {}},
      {"skull under the skin", "front", "skin,skull,eyes", {}},
      {"skull", "three-quarter", "skull", {}},
      {"SMAS", "front", "smas,eyes", {}},
      {"muscles", "front", "skull,muscles", {}},
      {"muscles", "three-quarter", "skull,muscles", {}},
      {"muscles under the skin", "side", "skin,muscles,skull", {}},
      {"smile",
       "front",
       "skin,eyes",
       {{"arkit:mouthSmileLeft", 1},
        {"arkit:mouthSmileRight", 1},
        {"arkit:cheekSquintLeft", 0.6},
        {"arkit:cheekSquintRight", 0.6}}},
      {"smile",
       "three-quarter",
       "skin,eyes",
       {{"arkit:mouthSmileLeft", 1},
        {"arkit:mouthSmileRight", 1},
        {"arkit:cheekSquintLeft", 0.6},
        {"arkit:cheekSquintRight", 0.6}}},
      {"frown",
       "front",
       "skin,eyes",
       {{"arkit:mouthFrownLeft", 1},
        {"arkit:mouthFrownRight", 1},
        {"arkit:browDownLeft", 1},
        {"arkit:browDownRight", 1}}},
      {"surprise",
       "front",
       "skin,eyes",
       {{"arkit:browInnerUp", 1},
        {"arkit:browOuterUpLeft", 1},
        {"arkit:browOuterUpRight", 1},
        {"arkit:eyeWideLeft", 1},
        {"arkit:eyeWideRight", 1},
        {"arkit:jawOpen", 0.5}}},
      {"jaw open", "front", "skin,eyes", {{"jaw_open", 1}}},
      {"jaw open", "side", "skin,skull", {{"jaw_open", 1}}},
      {"blink", "front", "skin,eyes", {{"arkit:eyeBlinkLeft", 1}, {"arkit:eyeBlinkRight", 1}}},
      {"pucker", "front", "skin,eyes", {{"arkit:mouthPucker", 1}}},
      {"sneer", "front", "skin,eyes", {{"arkit:noseSneerLeft", 1}, {"arkit:noseSneerRight", 1}}},
      {"left smile only", "front", "skin,eyes", {{"zygomaticus_major_left", 1}}},
      {"brow raise",
       "front",
       "skin,eyes",
       {{"arkit:browInnerUp", 1}, {"arkit:browOuterUpLeft", 1}, {"arkit:browOuterUpRight", 1}}},
      {"lower lip down",
       "front",
       "skin,eyes",
       {{"arkit:mouthLowerDownLeft", 1}, {"arkit:mouthLowerDownRight", 1}}},
  };
}

view::Look studio_look(int samples) {
  view::Look look;
  look.samples = samples;
  look.background = {52, 56, 62};
  look.has_backdrop = true;
  return look;
}

/// The rig once loaded, and what draws it: the sheet and the film share them.
struct Studio {
  const rig::Rig& rig;
  Face face;
  view::Renderer renderer;

  Studio(const std::filesystem::path& path, const rig::Rig& read_rig)
      : rig(read_rig), face(path, {FASCIA_SPACE_METRES, "own", ""}), renderer(16, 16) {}
};

view::Image contact_sheet(const Common& common, Studio& with) {
  auto& [rig, face, renderer] = with;
  renderer.resize(440, 440);
  std::vector<view::Tile> tiles;
  Progress progress(common, "pose", sheet_poses().size());
  for (const SheetPose& pose : sheet_poses()) {
    progress.step();
    face.clear();
    face.reset();
    for (const auto& [name, value] : pose.values)
      face.set(name, value);
    face.pose();
    tiles.push_back({renderer.draw_with(draw_face(face, rig, layers_from(pose.layers)),
                                        view::named_camera(pose.view, face_box(rig), 0.98), studio_look(4)),
                     pose.caption});
  }
  return view::contact_sheet(tiles, 4);
}

void film(const Common& common, Studio& with, const std::filesystem::path& curves_path,
          const std::filesystem::path& output) {
  auto& [rig, face, renderer] = with;
  const Curves curves(curves_path);
  const int size = 540, frames_per_second = 24;
  renderer.resize(size, size);
  face.clear();
  face.reset();
  view::Video video(output, size, size, frames_per_second);
  const std::set<std::string> layers = layers_from("skin,eyes");
  const view::Look look = studio_look(2);
  const int count = static_cast<int>(curves.duration() * frames_per_second) + 1;
  Progress progress(common, "frame", static_cast<size_t>(count));
  for (int f = 0; f < count; ++f) {
    progress.step();
    const double time = static_cast<double>(f) / frames_per_second;
    curves.apply(time, face);
    face.step(1.0 / frames_per_second);
    view::Camera camera = view::named_camera("front", face_box(rig), 0.98);
    camera.yaw = 28.0 * std::sin(0.45 * time);
    video.add(renderer.draw_with(draw_face(face, rig, layers), camera, look));
  }
  video.finish();
}

void run(const Common& common, const std::filesystem::path& folder,
         const std::filesystem::path& anatomy_folder) {
  formats::PartialGroup together;
  make_output_folder(folder, &together);
  Clock clock(common);
  Progress progress(common, "demo",
                    {{"build", 2.0}, {"play", 1.0}, {"bake", 1.0}, {"sheet", 4.0}, {"film", 20.0}});
  progress.begin("build");
  const std::filesystem::path head = folder / "head.obj", landmarks = folder / "head_landmarks.json",
                              rig_path = folder / "rig.glb", curves = folder / "curves.csv";
  rigging::write_embedded_head(anatomy_for(anatomy_folder), head, landmarks);
  BuildRequest request;
  request.head = head;
  request.anatomy = anatomy_folder;
  request.landmarks = landmarks;
  request.output = rig_path;
  const rigging::BuildReport report = build_file(common, request);
  for (const std::string& warning : report.warnings)
    common.warn(warning);
  for (const auto& stage : report.stages) {
    char line[96];
    std::snprintf(line, sizeof line, "  %6.3f s  %s", stage.seconds, stage.name.c_str());
    common.say(line);
  }
  clock.say("built " + rig_path.string() + ": " + std::to_string(report.muscles.size()) +
            " muscles, skull, SMAS, tissue");
  progress.begin("play");
  write_demo_curves(curves);
  PlayRequest play;
  play.rig = rig_path;
  play.curves = curves;
  play.output = folder / "play.glb";
  play.frames_per_second = 30.0;
  play.level = "low";
  const PlayFigures played = play_file(common, play);
  clock.say("played ten seconds into " + play.output.string() + " (" +
            std::to_string(played.milliseconds_a_frame).substr(0, 5) + " ms a frame)");
  progress.begin("bake");
  BakeRequest bake;
  bake.rig = rig_path;
  bake.output = folder / "arkit.glb";
  bake.level = "low";
  bake_file(common, bake);
  clock.say("baked the ARKit shapes into " + (folder / "arkit.glb").string());
  const rig::RigFile file = rig::read(formats::read_bytes(rig_path), rig_path.string());
  progress.begin("sheet");
  Studio studio(rig_path, file.rig);
  view::write_png(folder / "contact_sheet.png", contact_sheet(common, studio));
  clock.say("drew " + (folder / "contact_sheet.png").string());
  progress.begin("film");
  film(common, studio, curves, folder / "demo.mp4");
  clock.say("filmed " + (folder / "demo.mp4").string());
  common.say("look at " + (folder / "contact_sheet.png").string() + " and " + (folder / "demo.mp4").string() +
             " first; open " + (folder / "play.glb").string() + " in any glTF viewer");
  together.keep();
  common.report({{"out", folder.string()},
                 {"muscles", report.muscles.size()},
                 {"milliseconds_a_frame", played.milliseconds_a_frame}});
}

}  // namespace

void add_demo(const Command& tool, Common& common) {
  auto folder = std::make_shared<std::filesystem::path>("out");
  auto anatomy_folder = std::make_shared<std::filesystem::path>();
  const Command command = tool.command("demo", "The embedded head, end to end");
  command.option("--out", folder.get(), "Folder for the results").value("DIR");
  add_anatomy_option(command, *anatomy_folder);
  command.run([=, &common] { run(common, *folder, *anatomy_folder); });
}

}  // namespace fascia::cli
