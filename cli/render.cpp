#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/common.h"
#include "cli/muscle_sheet.h"
#include "cli/picture.h"
#include "cli/progress.h"
#include "cli/render_request.h"
#include "cli/take/performance.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "view/image.h"
#include "view/video.h"

namespace fascia::cli {

namespace {

/// One run of the command: the face, and how it is looked at.
class Picture {
 public:
  Picture(const RenderRequest& request, const Common& common)
      : request_(request),
        common_(common),
        size_(size_from(request.size)),
        look_(look_from(request)),
        file_(rig::read(formats::read_bytes(request.rig), request.rig.string())),
        face_(request.rig, {FASCIA_SPACE_METRES, request.solver, request.level}),
        box_(face_box(file_.rig)) {
    what_.layers = layers_from(request.layers);
    muscles_ = muscles_from(request.muscles, file_.rig);
    what_.muscles = muscles_;
    what_.tells_muscles_apart = request.colours == "names";
    what_.has_textures = !request.is_plain;
    what_.reveal = reveal_from(request.reveal, box_);
  }

  void write() {
    const bool is_film = view::is_film(request_.output);
    if (!request_.curves.empty() && !request_.at && is_film) return film_take();
    pose();
    if (request_.view == "turntable") return is_film ? film_turntable() : write_turntable();
    if (is_film)
      throw Error("'" + request_.output.string() +
                  "': a film needs --curves or --view turntable; a picture is .png");
    if (request_.view == "sheet")
      return view::write_png(request_.output, muscle_sheet(face_, file_.rig, muscles_, size_.width / 2));
    write_views();
  }

 private:
  view::DrawList list() const { return draw_face(face_, file_.rig, what_); }
  view::Camera camera(const std::string& view) const { return camera_for(view, request_, box_, size_); }

  view::Image shot(const view::Renderer& renderer, const view::Camera& camera,
                   const view::DrawList& list) const {
    view::Image image = renderer.draw_with(list, camera, look_);
    if (what_.layers.count("strain")) view::add_legend(image, what_.scale);
    return image;
  }

  /// Brings the face to what is asked: by activations at balance, or along a take up to a time.
  void pose() {
    if (request_.curves.empty()) {
      const auto values = activations(request_.set, request_.file);
      set_all(common_, face_, values);
      if (!values.empty()) face_.pose();
      return;
    }
    const Curves curves(request_.curves);
    const double at = request_.at.value_or(0.0);
    if (at < 0.0 || at > curves.duration() + 1e-9)
      throw Error("--at " + std::to_string(at) + ": the take lasts " + std::to_string(curves.duration()) +
                  " seconds");
    match(common_, curves, face_, request_.curves);
    curves.apply(0.0, face_);
    face_.pose();
    const double step = 1.0 / 60.0;
    const int count = static_cast<int>(std::lround(at / step));
    for (int f = 1; f <= count; ++f) {
      curves.apply(std::min(at, f * step), face_);
      face_.step(step);
    }
  }

  void write_views() const {
    const std::vector<std::string> views = views_from(request_.view);
    const view::Renderer renderer(size_.width, size_.height);
    std::vector<view::Tile> tiles;
    const view::DrawList now = list();
    std::optional<view::DrawList> rest;
    if (request_.is_beside_rest) rest = draw_face(face_.sibling(), file_.rig, what_);
    for (const std::string& view : views) {
      if (rest)
        tiles.push_back(
            {shot(renderer, camera(view), *rest), views.size() > 1 ? view + ", at rest" : "at rest"});
      tiles.push_back(
          {shot(renderer, camera(view), now), rest ? views.size() > 1 ? view + ", posed" : "posed" : view});
    }
    view::write_png(request_.output,
                    tiles.size() == 1
                        ? tiles[0].image
                        : view::contact_sheet(tiles, std::min<int>(4, static_cast<int>(tiles.size()))));
  }

  void write_turntable() const {
    const PictureSize half = {std::max(16, size_.width / 2), std::max(16, size_.height / 2)};
    const view::Renderer renderer(half.width, half.height);
    const view::DrawList now = list();
    std::vector<view::Tile> tiles;
    for (int k = 0; k < 8; ++k) {
      view::Camera turned = camera("front");
      turned.yaw += 45.0 * k;
      tiles.push_back({shot(renderer, turned, now), std::to_string(45 * k) + "°"});
    }
    view::write_png(request_.output, view::contact_sheet(tiles, 4));
  }

  /// Films have even sides, as their colours are stored in squares of four pixels.
  PictureSize film_size() const { return {size_.width / 2 * 2, size_.height / 2 * 2}; }

  void film_turntable() const {
    const PictureSize size = film_size();
    const view::Renderer renderer(size.width, size.height);
    view::Video video(request_.output, size.width, size.height, request_.frames_per_second);
    const view::DrawList now = list();
    const int frames = static_cast<int>(std::lround(4.0 * request_.frames_per_second));
    Progress progress(common_, "filming", static_cast<size_t>(frames));
    for (int f = 0; f < frames; ++f) {
      view::Camera turned = camera("front");
      turned.yaw += 360.0 * f / frames;
      video.add(shot(renderer, turned, now));
      progress.step();
    }
    video.finish();
  }

  void film_take() {
    const Curves curves(request_.curves);
    match(common_, curves, face_, request_.curves);
    const Take take{curves, request_.frames_per_second};
    const PictureSize size = film_size();
    const view::Renderer renderer(size.width, size.height);
    view::Video video(request_.output, size.width, size.height, request_.frames_per_second);
    Progress progress(common_, "filming", take.frames());
    const view::Camera from = camera(views_from(request_.view).front());
    perform(take, face_, progress, [&](size_t) { video.add(shot(renderer, from, list())); });
    video.finish();
  }

  const RenderRequest& request_;
  const Common& common_;
  PictureSize size_;
  view::Look look_;
  rig::RigFile file_;
  Face face_;
  Bounds box_;
  view::FaceView what_;
  std::vector<std::string> muscles_;
};

void run(const Common& common, const RenderRequest& request) {
  check_output(request.output, {request.rig, request.file, request.curves});
  const std::string extension = extension_of(request.output);
  if (extension != ".png" && !view::is_film(request.output))
    throw Error("'" + request.output.string() +
                "': a picture is written as .png, a film as .mp4, .gif or .webp");
  if (request.at && request.curves.empty()) throw UsageError("--at needs --curves");
  if (!request.curves.empty() && (!request.set.empty() || !request.file.empty()))
    throw UsageError("--curves and --set (or --activations) exclude each other");
  Picture(request, common).write();
  common.say("wrote " + request.output.string());
  common.report(
      {{"output", request.output.string()}, {"view", request.view}, {"layers", layers_from(request.layers)}});
}

}  // namespace

void add_render(const Command& tool, Common& common) {
  auto request = std::make_shared<RenderRequest>();
  const Command command = tool.command("render", "Render a rig to a picture or a film, without a display");
  add_rig_argument(command, request->rig);
  add_set_options(command, request->set, request->file);
  command.option("--curves", &request->curves, "A take: one picture with --at, otherwise a film")
      .value("FILE")
      .default_text("none");
  command.option("--at", &request->at, "Seconds into the take, simulated from its beginning")
      .value("SECONDS")
      .default_text("the beginning");
  command
      .option("--layers", &request->layers,
              "Any of skin, eyes, teeth, skull, fat, smas, muscles, ligaments, lattice, landmarks, strain, "
              "with commas between")
      .value("LAYER,...");
  command.option(
      "--view", &request->view,
      "front, side, right, three-quarter or back, or several separated by commas; turntable; or sheet: "
      "muscles in four views with a legend");
  command
      .option("--camera", &request->camera,
              "Relative to the view: degrees to the subject's left, degrees up, magnification")
      .value("YAW,PITCH[,ZOOM]")
      .default_text("0,0,1");
  command
      .option("--look-at", &request->look_at,
              "The point the camera looks at and its distance, metres in the rig's axes")
      .value("X,Y,Z,DISTANCE")
      .default_text("the whole face");
  command
      .option("--reveal", &request->reveal,
              "Remove the skin on one half (the subject's left or right, top or bottom), so that deeper "
              "layers show")
      .value("HALF")
      .default_text("none");
  command
      .option("--muscles", &request->muscles,
              "Draw only these muscles: names of parts or groups, with or without a side")
      .value("NAME,...")
      .default_text("all");
  command.option("--colours", &request->colours, "Muscle colours: flesh, or names (one colour per muscle)")
      .one_of({"flesh", "names"});
  command.flag("--plain", request->is_plain, "Ignore the head's own textures and colours");
  command.flag("--beside-rest", request->is_beside_rest, "The face at rest beside the pose");
  command.option("--light", &request->light, "Light")
      .one_of({"studio", "soft", "dramatic", "outdoor", "flat"});
  command.option("--background", &request->background, "studio (a lit wall), white, black or #RRGGBB")
      .value("COLOUR");
  command.option("--samples", &request->samples, "Samples per pixel: 1, 2, or a multiple of four")
      .range(1, 64)
      .default_text("8, for films 2");
  add_solver_option(command, request->solver);
  add_level_option(command, request->level);
  command.option("--size", &request->size, "Width and height in pixels: 900 or 1280x720").value("WxH");
  command.option("--fps", &request->frames_per_second, "Frames a second of films").range(1.0, 240.0);
  command.option("-o,--output", &request->output, "Picture (.png) or film (.mp4, .gif, .webp) to write")
      .required();
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
