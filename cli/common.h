#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace fascia::cli {

/// What every command understands.
struct Common {
  bool json = false;
  bool quiet = false;
  int threads = 0;  ///< 0: as many as the machine has

  /// Says that a stage begins; on stderr, when that is a terminal and nobody asked for quiet.
  void progress(const std::string& what) const;

  /// One line for people, on stdout; nothing with --json or --quiet.
  void say(const std::string& line) const;

  /// A warning, on stderr; nothing with --quiet.
  void warn(const std::string& line) const;

  /// The command's JSON object, on stdout, when --json asks for it.
  void report(const nlohmann::ordered_json& object) const;
};

/// Adds a command with its options and what it does to `app`. `run` is called after parsing.
void add_build(CLI::App& app, Common& common);
void add_info(CLI::App& app, Common& common);
void add_export(CLI::App& app, Common& common);
void add_pose(CLI::App& app, Common& common);
void add_play(CLI::App& app, Common& common);
void add_bake(CLI::App& app, Common& common);
void add_render(CLI::App& app, Common& common);
void add_demo(CLI::App& app, Common& common);
void add_manual(CLI::App& app);

/// Commands that are yet to come: they say so and exit with 1.
void add_to_come(CLI::App& app);

/// Throws fascia::Error when the folder of `path` is not there, or when `path` is one of `inputs`, which it
/// would destroy.
void check_output(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs = {});

}  // namespace fascia::cli
