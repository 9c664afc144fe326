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
  if (json) std::cout << object.dump(2) << std::endl;
}

void check_output(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  if (folder.empty()) return;
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  if (!std::filesystem::is_directory(folder))
    throw Error("the folder '" + folder.string() + "' cannot be made");
}

void add_to_come(CLI::App& app) {
  for (const auto& [name, what] :
       {std::pair{"fit", "fitting activations to a target"}, std::pair{"batch", "building many heads"},
        std::pair{"view", "the window"}}) {
    CLI::App* command = app.add_subcommand(name, std::string(what) + " (to come)");
    const auto unread = std::make_shared<std::vector<std::string>>();
    command->add_option("ARGUMENTS", *unread, "Not read yet");
    command->callback([unread, name = std::string(name), what = std::string(what)] {
      throw Error("'fascia " + name + "' is yet to come: " + what + " is not in this version");
    });
  }
}

}  // namespace fascia::cli
