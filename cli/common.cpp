#include "cli/common.h"

#include <tbb/parallel_for.h>

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/progress.h"
#include "geometry/error.h"

namespace fascia::cli {

void Common::progress(const std::string& stage) const {
  if (Progress* job = Progress::innermost())
    job->begin(stage);
  else if (!quiet && isatty(fileno(stderr)) != 0)
    std::fprintf(stderr, "  %s\n", stage.c_str());
}

void Common::say(const std::string& line) const {
  if (quiet || json) return;
  if (const Progress* job = Progress::innermost()) job->wipe();
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Common::warn(const std::string& line) const {
  if (quiet) return;
  if (const Progress* job = Progress::innermost()) job->wipe();
  std::fprintf(stderr, "warning: %s\n", line.c_str());
}

void Common::report(const nlohmann::ordered_json& object) const {
  if (!json) return;
  // Names and paths need not be UTF-8; JSON has to be.
  std::cout << object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
  if (!std::cout) fail_at_stdout();
}

void fail_at_stdout() {
  throw Error("standard output cannot be written: it is closed or its disk is full");
}

ForEach on_all_threads() {
  return [](size_t count, const std::function<void(size_t)>& part) {
    tbb::parallel_for(size_t{0}, count, part);
  };
}

void check_output(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs) {
  std::error_code status;
  const std::filesystem::path folder = path.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, status))
    throw Error("the folder '" + folder.string() + "' is not there; make it, or write elsewhere");
  for (const std::filesystem::path& input : inputs)
    if (std::filesystem::is_regular_file(path, status) && std::filesystem::equivalent(path, input, status))
      throw Error("'" + path.string() + "' is the input as well as the output: give another name with -o");
}

void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs) {
  std::error_code status;
  std::vector<std::filesystem::path> places;
  for (const std::filesystem::path& output : outputs) {
    if (output.empty()) continue;
    check_output(output, inputs);
    const std::filesystem::path place = std::filesystem::weakly_canonical(output, status);
    for (const std::filesystem::path& other : places)
      if (place == other || (std::filesystem::is_regular_file(place, status) &&
                             std::filesystem::equivalent(place, other, status)))
        throw Error("'" + output.string() + "' is named for two outputs: give each another name");
    places.push_back(place);
  }
}

void make_output_folder(const std::filesystem::path& folder, formats::PartialGroup* together) {
  std::error_code status;
  std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();  // written with a slash at the end
  check_output(whole);
  if (std::filesystem::is_directory(folder, status)) return;
  if (together) together->add(whole);
  bool is_made = false;
  {
    const formats::MakingPartial making;
    is_made = std::filesystem::create_directory(whole, status);
  }
  if (!is_made)
    throw Error("the folder '" + folder.string() +
                "' cannot be made: " + (status ? status.message() : "a file bears its name"));
}

void add_rig_argument(const Command& command, std::filesystem::path& rig) {
  command.positional("RIG", &rig, "Rig (.glb)").required();
}

void add_set_options(const Command& command, std::vector<std::string>& set,
                     std::filesystem::path& activations) {
  command
      .option("--set", &set,
              "One channel's or shape's value: an actuator, arkit:NAME, au:N or viseme:NAME; may be "
              "repeated, and "
              "overrides --activations")
      .value("NAME=VALUE")
      .default_text("the face at rest");
  command.option("--activations", &activations, "Values of many (.json)").default_text("none");
}

void add_solver_option(const Command& command, std::string& solver) {
  command.option("--solver", &solver, "Solver").one_of({"own", "reference", "bullet"});
}

void add_outside_option(const Command& command, bool& is_allowed) {
  command.flag("--allow-outside", is_allowed, "Open files that inputs reference outside their folders");
}

formats::ReadOptions reading_options(bool is_allowed) {
  return {is_allowed ? formats::Outside::allowed : formats::Outside::refused_by_default};
}

void add_level_option(const Command& command, std::string& level) {
  command.option("--level", &level, "Level of detail: low, medium or high, if the rig has it")
      .default_text("the rig's finest");
}

}  // namespace fascia::cli
