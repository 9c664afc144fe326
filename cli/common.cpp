#include "cli/common.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <vector>

#include "geometry/error.h"

namespace fascia::cli {

void Common::progress(const std::string& what) const {
  if (!quiet && isatty(fileno(stderr))) std::fprintf(stderr, "  %s\n", what.c_str());
}

void Common::say(const std::string& line) const {
  if (!quiet && !json) std::printf("%s\n", line.c_str());
}

void Common::warn(const std::string& line) const {
  if (!quiet) std::fprintf(stderr, "warning: %s\n", line.c_str());
}

void Common::report(const nlohmann::ordered_json& object) const {
  if (!json) return;
  // Names and paths need not be UTF-8; JSON has to be.
  std::cout << object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
  if (!std::cout) throw Error("standard output cannot be written: it is closed or its disk is full");
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

void add_to_come(CLI::App& app) {
  for (const auto& [name, what] :
       {std::pair{"batch", "building many heads"}, std::pair{"view", "the window"}}) {
    CLI::App* command = app.add_subcommand(name, std::string(what) + " (to come)");
    const auto unread = std::make_shared<std::vector<std::string>>();
    command->add_option("ARGUMENTS", *unread, "Not read yet");
    command->callback([unread, name = std::string(name), what = std::string(what)] {
      throw Error("'fascia " + name + "' is yet to come: " + what + " is not in this version");
    });
  }
}

}  // namespace fascia::cli
