#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/common.h"
#include "cli/play_file.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

void run(const Common& common, const PlayRequest& request) {
  const PlayFigures figures = play_file(common, request);
  std::vector<std::string> files;
  for (const std::filesystem::path& path : figures.files) {
    files.push_back(path.string());
    const bool is_glb = extension_of(path) == ".glb";
    char error[32];
    std::snprintf(error, sizeof error, "%.3f", figures.largest_error_mm);
    common.say("wrote " + path.string() + ": " + std::to_string(figures.frames) + " frames" +
               (is_glb ? ", " + std::to_string(figures.components) + " morph targets, " +
                             std::to_string(figures.keys) + " keys, largest error " + error + " mm"
                       : ""));
  }
  common.report({{"output", request.output.string()},
                 {"files", files},
                 {"frames", figures.frames},
                 {"seconds", figures.duration},
                 {"start_seconds", figures.start},
                 {"morph_targets", figures.components},
                 {"morph_targets_wanted", figures.wanted},
                 {"keys", figures.keys},
                 {"largest_error_mm", figures.largest_error_mm},
                 {"largest_error_seconds", figures.largest_error_seconds},
                 {"milliseconds_a_frame", figures.milliseconds_a_frame},
                 {"resets", figures.resets},
                 {"matched", figures.matched},
                 {"unmatched", figures.unmatched}});
}

}  // namespace

void add_play(const Command& tool, Common& common) {
  auto request = std::make_shared<PlayRequest>();
  const Command command = tool.command("play", "Simulate a rig along curves and write the animation");
  add_rig_argument(command, request->rig);
  command.option("--curves", &request->curves, "Curves: a table (.csv), .json or .glb").required();
  command.option("--weight", &request->weight, "Factor of what the curves hold").range(0.0, 10.0);
  command
      .option("--layer", &request->layers,
              "More curves, added to the first from the same beginning, times a weight from 0 to 10; may be "
              "repeated")
      .value("FILE[=WEIGHT]")
      .default_text("none");
  command
      .option(
          "--set", &request->set,
          "A value that holds all the time, the curves are added to it; names as in 'fascia pose'; may be "
          "repeated, and overrides --activations")
      .value("NAME=VALUE")
      .default_text("the face at rest");
  command.option("--activations", &request->values, "Values of many that hold all the time (.json)")
      .default_text("none");
  command.option("--fps", &request->frames_per_second, "Frames a second to simulate and write")
      .range(1.0, 1000.0);
  command
      .option("--fps-in", &request->curve_frames_per_second,
              "Frames per second of the curves' rows or timecodes")
      .range(1.0, 1000.0)
      .default_text("as their file says");
  command
      .option("--time-unit", &request->time_unit, "Unit of the curves' times: s, ms, us or seconds per unit")
      .units({{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}})
      .range(1e-9, 3600.0)
      .value("UNIT")
      .default_text("as their file says");
  command.option("--from", &request->from, "Start of the range to play, seconds from the first key")
      .range(0.0, 1e6);
  command.option("--to", &request->to, "Where it ends").default_text("the last key");
  command
      .option("--targets", &request->most_targets,
              "Morph targets a mesh at most; fewer make a smaller file, which is less exact")
      .range(1, 4096);
  command.flag("--head", request->keeps_head,
               "Write the captured rotation of the head as animation of the file's nodes");
  add_solver_option(command, request->solver);
  add_level_option(command, request->level);
  command.option("-o,--output", &request->output, "Animation to write: .glb, or a point cache, .pc2 or .mdd")
      .required();
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
