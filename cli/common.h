#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/options.h"
#include "formats/files.h"
#include "formats/partial.h"
#include "geometry/for_each.h"

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

/// Throws fascia::Error that says that standard output cannot be written.
[[noreturn]] void fail_at_stdout();

/// Runs independent parts on the threads that the tool may use.
ForEach on_all_threads();

/// Each adds a command to the tool: its options and what it does.
void add_build(const Command& tool, Common& common);
void add_info(const Command& tool, Common& common);
void add_export(const Command& tool, Common& common);
void add_pose(const Command& tool, Common& common);
void add_play(const Command& tool, Common& common);
void add_bake(const Command& tool, Common& common);
void add_render(const Command& tool, Common& common);
void add_demo(const Command& tool, Common& common);
/// `tool` must outlive the run of the command, which prints what all commands say of themselves.
void add_manual(const Command& tool);

/// Throws fascia::Error when the folder of `path` is not there, or when `path` is one of `inputs`, which it
/// would destroy.
void check_output(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs = {});

/// The same of every output of one command; empty ones are skipped. Throws fascia::Error, too, when two are
/// one file.
void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs);

/// The options several commands share, worded alike.
void add_rig_argument(const Command& command, std::filesystem::path& rig);
void add_set_options(const Command& command, std::vector<std::string>& set,
                     std::filesystem::path& activations);
void add_solver_option(const Command& command, std::string& solver);
void add_outside_option(const Command& command, bool& is_allowed);
/// How to read inputs, by what `--allow-outside` says.
formats::ReadOptions reading_options(bool is_allowed);
void add_level_option(const Command& command, std::string& level);

/// Makes `folder` for a command's results unless it is there, as one of `together` where that is given.
/// Throws fascia::Error when the folder it would lie in is not there, or when a file bears its name.
void make_output_folder(const std::filesystem::path& folder, formats::PartialGroup* together = nullptr);

}  // namespace fascia::cli
