#include <CLI/CLI.hpp>
#include <memory>

#include "app/application.h"
#include "cli/common.h"

namespace fascia::cli {

namespace {

void run(const Common& common, const app::ApplicationOptions& options) {
  const app::ApplicationReport report = app::run_application(options);
  if (!options.script.empty() || options.monkey) {
    char line[120];
    std::snprintf(line, sizeof line, "%llu frames, the median took %.1f ms, the longest %.0f ms",
                  static_cast<unsigned long long>(report.frames), report.median_frame_ms, report.longest_frame_ms);
    common.say(line);
    for (const std::string& file : report.files)
      common.say("wrote " + file);
  }
  common.report({{"frames", report.frames},
                 {"median_frame_ms", report.median_frame_ms},
                 {"longest_frame_ms", report.longest_frame_ms},
                 {"files", report.files}});
}

}  // namespace

void add_view(CLI::App& app, Common& common) {
  auto options = std::make_shared<app::ApplicationOptions>();
  auto seed = std::make_shared<uint64_t>(0);
  CLI::App* command = app.add_subcommand("view", "Open the window: build, pose, edit and play a face");
  command->add_option("FILE", options->files, "Heads, rigs, recordings or edits to open (default: the start page)");
  command->add_option("--script", options->script,
                      "Drive the window by a file of steps and end with it: see docs/view.md");
  command->add_option("--state", options->state,
                      "Folder to remember things in (default: $XDG_STATE_HOME/fascia; with a script a passing one)");
  command->add_option("--scale", options->scale, "Size of text and widgets (default: as the display says)")
      ->check(CLI::Range(0.5, 4.0));
  CLI::Option* monkey = command->add_option("--monkey", *seed, "Press keys and mouse at random, by this seed");
  command->add_option("--seconds", options->monkey_seconds, "How long the random input lasts")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  command->callback([options, seed, monkey, &common] {
    if (monkey->count() > 0) options->monkey = *seed;
    run(common, *options);
  });
}

}  // namespace fascia::cli
