#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "cli/common.h"
#include "cli/play_file.h"
#include "geometry/error.h"

namespace fascia::cli {

void add_play(CLI::App& app, Common& common) {
  auto request = std::make_shared<PlayRequest>();
  CLI::App* command = app.add_subcommand("play", "Simulate a rig along curves and write the animation");
  command->add_option("RIG", request->rig, "Rig (.glb)")->required();
  command->add_option("--curves", request->curves, "Curves: .csv, .json or .glb")->required();
  command->add_option("--fps", request->frames_per_second, "Frames a second")->check(CLI::Range(1.0, 1000.0));
  command->add_option("--solver", request->solver, "Solver")
      ->check(CLI::IsMember({"own", "reference", "bullet"}));
  command->add_option("--level", request->level, "Level of detail: low, medium or high");
  command->add_option("-o,--output", request->output, "Animation to write (.glb)")->required();
  command->callback([request, &common] {
    const PlayFigures figures = play_file(common, *request);
    common.say("wrote " + request->output.string() + ": " + std::to_string(figures.frames) + " frames, " +
               std::to_string(figures.components) + " morph targets, largest error " +
               std::to_string(figures.largest_error_mm).substr(0, 5) + " mm");
    common.report({{"output", request->output.string()},
                   {"frames", figures.frames},
                   {"seconds", figures.duration},
                   {"morph_targets", figures.components},
                   {"largest_error_mm", figures.largest_error_mm},
                   {"milliseconds_a_frame", figures.milliseconds_a_frame},
                   {"resets", figures.resets},
                   {"matched", figures.matched},
                   {"unmatched", figures.unmatched}});
  });
}

}  // namespace fascia::cli
