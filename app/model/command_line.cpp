#include "app/model/command_line.h"

#include <cstdio>

namespace fascia::app {

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void add_pose(CommandLine& command, const Pose& pose) {
  for (const auto& [name, value] : pose) {
    command.emplace_back("--set");
    command.push_back(name + "=" + number(value));
  }
}

bool is_plain(const std::string& word) {
  return !word.empty() && word.find_first_not_of(
                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_-+=:,./@%") == std::string::npos;
}

}  // namespace

CommandLine build_command(const DocumentState& state, const std::filesystem::path& edits,
                          const std::filesystem::path& rig) {
  CommandLine command = {"build", state.head, "-o", rig.string()};
  if (!edits.empty() && !state.edits.empty()) command.insert(command.end(), {"--edits", edits.string()});
  return command;
}

CommandLine pose_command(const Pose& pose, const std::filesystem::path& rig,
                         const std::filesystem::path& output) {
  CommandLine command = {"pose", rig.string()};
  add_pose(command, pose);
  command.insert(command.end(), {"-o", output.string()});
  return command;
}

CommandLine play_command(const TakeChoice& take, const Pose& pose, const std::filesystem::path& rig,
                         double fps, const std::filesystem::path& output) {
  // A muted one still says how long the timeline is: it is played with no weight.
  CommandLine command = {"play", rig.string(), "--curves", take.file};
  const double weight = take.is_muted ? 0.0 : take.weight;
  if (weight != 1.0) command.insert(command.end(), {"--weight", number(weight)});
  for (const TakeLayer& layer : take.layers)
    command.insert(command.end(),
                   {"--layer", layer.file + "=" + number(layer.is_muted ? 0.0 : layer.weight)});
  add_pose(command, pose);
  command.insert(command.end(), {"--fps", number(fps)});
  if (take.begin > 0.0) command.insert(command.end(), {"--from", number(take.begin)});
  if (take.end >= 0.0) command.insert(command.end(), {"--to", number(take.end)});
  command.insert(command.end(), {"-o", output.string()});
  return command;
}

CommandLine bake_command(const std::filesystem::path& rig, const std::string& shapes,
                         const std::filesystem::path& output) {
  return {"bake", rig.string(), "--shapes", shapes, "-o", output.string()};
}

CommandLine render_command(const Pose& pose, const std::filesystem::path& rig, const PictureOrder& order,
                           const std::filesystem::path& output) {
  CommandLine command = {"render", rig.string()};
  add_pose(command, pose);
  for (const auto& [option, value] : {std::pair("--layers", &order.layers),
                                      {"--view", &order.view},
                                      {"--camera", &order.camera},
                                      {"--look-at", &order.look_at},
                                      {"--muscles", &order.muscles},
                                      {"--size", &order.size}})
    if (!value->empty()) command.insert(command.end(), {option, *value});
  if (order.is_plain) command.emplace_back("--plain");
  command.insert(command.end(), {"-o", output.string()});
  return command;
}

std::string shell_text(const CommandLine& command) {
  std::string text = "fascia";
  for (const std::string& word : command) {
    text += ' ';
    if (is_plain(word)) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word)
      text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

}  // namespace fascia::app
