#include <memory>
#include <nlohmann/json.hpp>

#include "cli/common.h"
#include "cli/muscle_sheet.h"
#include "cli/picture.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "view/image.h"
#include "view/video.h"

namespace fascia::cli {

namespace {

struct Request {
  std::filesystem::path rig, output, file;
  std::vector<std::string> set;
  std::string layers = "skin,eyes", muscles, view = "front", solver = "own", level;
  int size = 900;
};

/// Once around: a film for .mp4, eight views on one sheet for .png.
void write_turntable(const view::DrawList& list, const Bounds& box, const Request& request) {
  view::Camera camera = view::named_camera("front", box);
  if (request.output.extension() == ".mp4") {
    const int size = request.size / 2 * 2, frames = 120;
    const view::Renderer renderer(size, size);
    view::Video video(request.output, size, size, 30.0);
    for (int f = 0; f < frames; ++f) {
      camera.yaw = 360.0 * f / frames;
      video.add(renderer.draw(list, camera));
    }
    video.finish();
    return;
  }
  const view::Renderer renderer(request.size / 2, request.size / 2);
  std::vector<view::Tile> tiles;
  for (int k = 0; k < 8; ++k) {
    camera.yaw = 45.0 * k;
    tiles.push_back({renderer.draw(list, camera), std::to_string(45 * k) + " degrees"});
  }
  view::write_png(request.output, view::contact_sheet(tiles, 4));
}

void run(const Common& common, const Request& request) {
  check_output(request.output);
  const std::string extension = request.output.extension().string();
  if (extension != ".png" && !(extension == ".mp4" && request.view == "turntable"))
    throw Error("'" + request.output.string() +
                "': a picture is written as .png, a turntable as .png or .mp4");
  const std::set<std::string> layers = layers_from(request.layers);
  const auto values = activations(request.set, request.file);
  Face face(request.rig, {FASCIA_SPACE_METRES, request.solver, request.level});
  const rig::RigFile file = rig::read(formats::read_bytes(request.rig), request.rig.string());
  for (const auto& [name, value] : values)
    face.set(name, value);
  if (!values.empty()) face.pose();
  const std::vector<std::string> muscles = muscles_from(request.muscles, file.rig);
  if (request.view == "sheet") {
    view::write_png(request.output, muscle_sheet(face, file.rig, muscles, request.size / 2));
    common.say("wrote " + request.output.string());
    common.report({{"output", request.output.string()}, {"view", request.view}, {"muscles", muscles}});
    return;
  }
  const view::DrawList list = draw_face(face, file.rig, layers, muscles);
  const Bounds box = face_box(file.rig);
  if (request.view == "turntable") {
    write_turntable(list, box, request);
  } else {
    const view::Renderer renderer(request.size, request.size);
    view::write_png(request.output, renderer.draw(list, view::named_camera(request.view, box)));
  }
  common.say("wrote " + request.output.string());
  common.report({{"output", request.output.string()}, {"view", request.view}, {"layers", layers}});
}

}  // namespace

void add_render(const Command& tool, Common& common) {
  auto request = std::make_shared<Request>();
  const Command command = tool.command("render", "Draw a rig to a picture, no display needed");
  add_rig_argument(command, request->rig);
  add_set_options(command, request->set, request->file);
  command
      .option("--layers", &request->layers,
              "Any of skin, eyes, teeth, skull, smas, muscles, landmarks, with commas between")
      .value("LAYER,...");
  command.option(
      "--view", &request->view,
      "front, side, right, three-quarter, back, turntable, or sheet: muscles in four views with a legend");
  command
      .option("--muscles", &request->muscles,
              "Draw these muscles only: names of parts or wholes, with a side or without")
      .value("NAME,...")
      .default_text("all");
  add_solver_option(command, request->solver);
  add_level_option(command, request->level);
  command.option("--size", &request->size, "Width and height in pixels").range(16, 4096);
  command.option("-o,--output", &request->output, "Picture to write (.png; a turntable also .mp4)")
      .required();
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
