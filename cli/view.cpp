#include "cli/view.h"

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/application.h"

namespace fascia::cli {

namespace {

void run(const Common& common, const app::ApplicationOptions& options) {
  const app::ApplicationReport report = app::run_application(options);
  if (!options.script.empty() || options.monkey) {
    char line[120];
    std::snprintf(line, sizeof line, "%llu frames, the median took %.1f ms, the longest %.0f ms",
                  static_cast<unsigned long long>(report.frames), report.median_frame_ms,
                  report.longest_frame_ms);
    common.say(line);
    for (const std::string& file : report.files)
      common.say("wrote " + file);
  }
  common.report({{"frames", report.frames},
                 {"median_frame_ms", report.median_frame_ms},
                 {"longest_frame_ms", report.longest_frame_ms},
                 {"longest_update_ms", report.longest_update_ms},
                 {"files", report.files}});
}

}  // namespace

void add_view(const Command& tool, Common& common) {
  struct Request {
    app::ApplicationOptions options;
    std::optional<double> seed;
  };
  auto request = std::make_shared<Request>();
  app::ApplicationOptions& options = request->options;
  const Command command =
      tool.command("view", "Open the graphical application: build, pose, edit and play a face");
  command.positional("FILE", &options.files, "Heads, rigs, recordings or edits to open")
      .default_text("the start page");
  command.option("--script", &options.script, "Run a script of steps, then exit; see docs/view.md")
      .default_text("the mouse and the keyboard");
  command.flag("--real-time", options.is_real_time,
               "Run a script by the clock and draw every frame, as for a user: how fast the window is");
  command.option("--state", &options.state, "Folder for settings and recovery")
      .value("DIR")
      .default_text("$XDG_STATE_HOME/fascia; temporary for a script");
  command.option("--scale", &options.scale, "Size of text and widgets, 0.5 to 4")
      .range(0.0, 4.0)
      .default_text("as the display says");
  command.option("--monkey", &request->seed, "Generate random keyboard and mouse input with this seed")
      .value("SEED")
      .default_text("not");
  command.option("--seconds", &options.monkey_seconds, "How long the random input lasts").range(0.1, 86400.0);
  command.run([request, &common] {
    if (request->seed) request->options.monkey = static_cast<uint64_t>(std::max(*request->seed, 0.0));
    run(common, request->options);
  });
}

}  // namespace fascia::cli
