#include <tbb/global_control.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>

#include "cli/batch.h"
#include "cli/calibrate.h"
#include "cli/check.h"
#include "cli/common.h"
#include "cli/face.h"
#include "cli/fit.h"
#include "cli/snapshot.h"
#include "cli/version.h"
#include "cli/view.h"
#include "formats/partial.h"
#include "geometry/error.h"

namespace {

constexpr int exit_input = 1, exit_usage = 2, exit_internal = 3, exit_interrupted = 130;

/// Leaves at once, and no half-written file behind.
void on_interrupt(int) {
  fascia::formats::remove_partial_files();
  _exit(exit_interrupted);
}

/// Where no exception can be caught any more: destructors of JSON values need memory. Ends as documented,
/// with nothing half-written left.
[[noreturn]] void on_terminate() {
  fascia::formats::remove_partial_files();
  const char* message = "fascia: internal error; please report it\n";
  int code = exit_internal;
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    message = "fascia: out of memory: the input is too large for this machine\n";
    code = exit_input;
  } catch (...) {
  }
  if (write(STDERR_FILENO, message, std::strlen(message)) < 0) code = exit_internal;
  _exit(code);
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

/// The options of every command, and all commands in the order in which help lists them.
void declare(const fascia::cli::Command& tool, fascia::cli::Common& common) {
  using namespace fascia::cli;
  tool.flag("--json", common.json, "Print one JSON object on stdout, and nothing else there");
  tool.flag("--quiet", common.quiet, "Print errors only");
  tool.option("--threads", &common.threads, "Threads to use")
      .range(1, 1024)
      .default_text("all the machine has");
  add_build(tool, common);
  add_info(tool, common);
  add_export(tool, common);
  add_pose(tool, common);
  add_play(tool, common);
  add_bake(tool, common);
  add_render(tool, common);
  add_check(tool, common);
  add_demo(tool, common);
  add_calibrate(tool, common);
  add_face(tool, common);
  add_fit(tool, common);
  add_snapshot(tool, common);
  add_batch(tool, common);
  add_view(tool, common);
  add_manual(tool);
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(on_terminate);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, on_interrupt);
  // A file that grows too large or a reader that has gone is an error of writing, not an end without a word.
  for (const int signal : {SIGXFSZ, SIGPIPE})
    std::signal(signal, SIG_IGN);
  fascia::cli::Common common;
  using namespace fascia::cli;
  const Command tool("fascia", "Fascia: anatomical face rigs for any head, simulated in real time",
                     version_text());
  std::unique_ptr<tbb::global_control> limit;
  try {
    declare(tool, common);
    const std::function<void()> action = tool.parse(argc, argv);
    if (common.threads > 0)
      limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<size_t>(common.threads));
    if (action) action();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fascia::cli::fail_at_stdout();
  } catch (const Exit& end) {
    return end.code;
  } catch (const UsageError& error) {
    return fail(common, error.what(), exit_usage);
  } catch (const fascia::Error& error) {
    return fail(common, error.what(), exit_input);
  } catch (const std::bad_alloc&) {
    return fail(common, "out of memory: the input is too large for this machine", exit_input);
  } catch (const std::exception& error) {
    return fail(common, std::string("internal error: ") + error.what() + "; please report it", exit_internal);
  }
  return 0;
}
