#include "cli/picture.h"
#include "cli/posing.h"
#include "cli/report.h"
#include "formats/scene.h"
#include "rig/read/read.h"
#include "view/renderer.h"

namespace fascia::cli {

namespace {

constexpr int report_picture_size = 460;  // pixels

/// A small cross on the skin for each landmark, in three colours: given, found, found with low confidence.
void add_crosses(view::DrawList& list, const rig::Rig& rig, const rigging::BuildReport& report) {
  const double arm = 0.0022;  // m
  std::map<std::string, const rigging::BuildReport::LandmarkFigures*> known;
  for (const auto& figures : report.landmarks)
    known[figures.name] = &figures;
  view::DrawLines lines[3];
  lines[0].colour = Vec3(0.10, 0.65, 0.20);
  lines[1].colour = Vec3(0.05, 0.35, 0.85);
  lines[2].colour = Vec3(0.90, 0.25, 0.10);
  for (const auto& landmark : rig.skull.landmarks) {
    const auto at = known.find(landmark.name);
    const int kind = at == known.end() || at->second->given ? 0 : at->second->confidence < 0.5 ? 2 : 1;
    const Vec3 p = landmark.skin.cast<double>();
    for (int axis = 0; axis < 3; ++axis)
      lines[kind].lines.push_back({p - arm * Vec3::Unit(axis), p + arm * Vec3::Unit(axis)});
  }
  for (view::DrawLines& one : lines) {
    one.width = 2.5;
    if (!one.lines.empty()) list.lines.push_back(std::move(one));
  }
}

}  // namespace

std::vector<StagePictures> stage_pictures(const std::filesystem::path& path,
                                          const rigging::BuildReport& report) {
  const Face face(path, {FASCIA_SPACE_METRES, "own", ""});
  const rig::RigFile file = rig::read(formats::read_bytes(path), path.string());
  const view::Renderer renderer(report_picture_size, report_picture_size);
  const Bounds box = face_box(file.rig);
  std::vector<StagePictures> all;
  const auto add = [&](const char* title, const char* caption, const view::DrawList& list) {
    StagePictures stage{title, caption, {}};
    for (const char* view : {"front", "three-quarter", "side"})
      stage.views.push_back(renderer.draw(list, view::named_camera(view, box)));
    all.push_back(std::move(stage));
  };
  view::DrawList skin = draw_face(face, file.rig, {"skin", "eyes"});
  add_crosses(skin, file.rig, report);
  add("Landmarks on the skin", "Green: given. Blue: found. Orange: found with a confidence below 0.5.", skin);
  add("Skull in the skin", "Rods join each landmark of the skin to its bone.",
      draw_face(face, file.rig, {"skin", "skull", "teeth", "landmarks"}));
  add("Skull", "Cranium, mandible and teeth as fitted.", draw_face(face, file.rig, {"skull", "teeth"}));
  add("SMAS", "The sheet on which the mimic muscles lie, over the skull.",
      draw_face(face, file.rig, {"skull", "smas"}));
  add("Muscles", "Every fibre, a colour a muscle.", draw_face(face, file.rig, {"skull", "muscles"}));
  return all;
}

}  // namespace fascia::cli
