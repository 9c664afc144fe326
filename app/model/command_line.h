#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/model/document.h"

/// The `fascia` command that does what the window does: shown, copied, and run for exports.
namespace fascia::app {

using CommandLine = std::vector<std::string>;  ///< without the program's name

CommandLine build_command(const DocumentState& state, const std::filesystem::path& edits,
                          const std::filesystem::path& rig);
CommandLine pose_command(const DocumentState& state, const std::filesystem::path& rig,
                         const std::filesystem::path& output);
CommandLine play_command(const TakeChoice& take, const std::filesystem::path& rig, double fps,
                         const std::filesystem::path& output);
CommandLine bake_command(const std::filesystem::path& rig, const std::string& shapes,
                         const std::filesystem::path& output);
CommandLine render_command(const DocumentState& state, const std::filesystem::path& rig,
                           const std::string& layers, const std::string& view, int size,
                           const std::filesystem::path& output);

/// As one would type it in a shell, with "fascia" before it.
std::string shell_text(const CommandLine& command);

}  // namespace fascia::app
