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
using Pose = std::map<std::string, double>;  ///< by name, as `--set` takes them

CommandLine pose_command(const Pose& pose, const std::filesystem::path& rig,
                         const std::filesystem::path& output);
/// The takes over `pose`, which holds all the time.
CommandLine play_command(const TakeChoice& take, const Pose& pose, const std::filesystem::path& rig,
                         double fps, const std::filesystem::path& output);
CommandLine bake_command(const std::filesystem::path& rig, const std::string& shapes,
                         const std::filesystem::path& output);

/// Options of `fascia render`; empty ones are left out.
struct PictureOrder {
  std::string layers, view, size, camera, look_at, muscles;
  bool is_plain = false;  ///< without the head's textures
};
CommandLine render_command(const Pose& pose, const std::filesystem::path& rig, const PictureOrder& order,
                           const std::filesystem::path& output);

/// As one would type it in a shell, with "fascia" before it.
std::string shell_text(const CommandLine& command);

}  // namespace fascia::app
