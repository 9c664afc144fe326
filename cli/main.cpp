#include <tbb/global_control.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <new>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/fit.h"
#include "cli/snapshot.h"
#include "formats/partial.h"
#include "geometry/error.h"

namespace {

constexpr int exit_input = 1, exit_usage = 2, exit_internal = 3, exit_interrupted = 130;

/// Leaves at once, and no half-written file behind.
void on_interrupt(int) {
  fascia::formats::remove_partial_files();
  _exit(exit_interrupted);
}

/// With --json the failure is the one object on stdout as well.
int fail(const fascia::cli::Common& common, const std::string& message, int code) {
  if (common.json)
    std::cout << nlohmann::ordered_json{{"error", message}, {"exit", code}}.dump(
                     2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << std::endl;
  std::fprintf(stderr, "fascia: %s\n", message.c_str());
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, on_interrupt);
  // A file that grows too large or a reader that has gone is an error of writing, not an end without a word.
  for (const int signal : {SIGXFSZ, SIGPIPE})
    std::signal(signal, SIG_IGN);
  fascia::cli::Common common;
  CLI::App app{"Fascia: anatomical face rigs for any head, simulated in real time", "fascia"};
  app.set_version_flag("--version", "fascia " FASCIA_VERSION_TEXT);
  app.require_subcommand(1);
  app.fallthrough();
  app.add_flag("--json", common.json, "Print one JSON object on stdout");
  app.add_flag("--quiet", common.quiet, "Print errors only");
  app.add_option("--threads", common.threads, "Threads to use (default: all)")->check(CLI::Range(1, 1024));
  std::unique_ptr<tbb::global_control> limit;
  app.parse_complete_callback([&] {
    if (common.threads > 0)
      limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<size_t>(common.threads));
  });
  using namespace fascia::cli;
  add_build(app, common);
  add_info(app, common);
  add_export(app, common);
  add_pose(app, common);
  add_play(app, common);
  add_bake(app, common);
  add_render(app, common);
  add_check(app, common);
  add_demo(app, common);
  add_fit(app, common);
  add_snapshot(app, common);
  add_to_come(app);
  add_manual(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : exit_usage;
  } catch (const fascia::Error& error) {
    return fail(common, error.what(), exit_input);
  } catch (const std::bad_alloc&) {
    return fail(common, "out of memory: the input is too large for this machine", exit_input);
  } catch (const std::exception& error) {
    return fail(common, std::string("internal error: ") + error.what() + "; please report it", exit_internal);
  }
  return 0;
}
