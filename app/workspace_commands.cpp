#include <cmath>
#include <cstdio>

#include "app/workspace.h"
#include "formats/content_hash.h"
#include "formats/files.h"
#include "geometry/error.h"

namespace fascia::app {

namespace {

/// A short name of its own for each text.
std::string mark_of(const std::string& text) {
  return formats::content_hash({reinterpret_cast<const uint8_t*>(text.data()), text.size()}).substr(0, 8);
}

std::string joined(std::initializer_list<double> numbers) {
  std::string text;
  for (const double number : numbers) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", number);
    text += (text.empty() ? "" : ",") + std::string(digits);
  }
  return text;
}

}  // namespace

std::map<std::string, double> Workspace::standing_pose() const {
  if (!rig || !frame || (!take && !live)) return state().pose;
  std::map<std::string, double> values;
  for (size_t c = 0; c < std::min(frame->values.size(), rig->asset->channels.size()); ++c) {
    const FaceChannel& channel = rig->asset->channels[c];
    const auto value = static_cast<double>(frame->values[c]);
    const double least = 5e-4;
    if (std::abs(value - static_cast<double>(channel.rest)) > least) values[channel.name] = value;
  }
  return values;
}

Workspace::PresentCommand Workspace::present_command() const {
  PresentCommand present;
  if (!rig) return present;
  const std::string stem = std::filesystem::path(state().head).stem().string();
  const std::filesystem::path head = state().head;
  std::filesystem::path file;
  const bool is_built = rig->file != head || has_unbuilt_edits();
  if (!is_built)
    file = head;
  else if (saved_rig_ && saved_rig_->content == rig->file.string() && !has_unbuilt_edits())
    file = saved_rig_->file;
  if (file.empty()) {
    std::filesystem::path edits;
    if (!state().edits.empty()) {
      const std::string text = text_of_edits(state().edits);
      edits = saved_edits_ && saved_edits_->content == text
                  ? saved_edits_->file
                  : places_.state / "commands" / ("edits_" + mark_of(text) + ".json");
      if (!saved_edits_ || saved_edits_->content != text) present.files[edits] = text;
    }
    file = stem + "_rig.glb";
    present.text = shell_text(build_command(state(), edits, file));
  }
  const auto then = [&](const CommandLine& command) {
    present.text += (present.text.empty() ? "" : " && ") + shell_text(command);
  };
  if (take) {
    then(play_command(state().take, state().pose, file, recorded_rate, stem + "_take.glb"));
  } else if (!state().pose.empty()) {
    then(pose_command(state().pose, file, stem + "_posed.glb"));
  } else if (present.text.empty()) {
    then({"info", file.string()});
  }
  return present;
}

std::string Workspace::copy_command() {
  const PresentCommand present = present_command();
  try {
    for (const auto& [file, text] : present.files) {
      std::filesystem::create_directories(file.parent_path());
      formats::write_text(file, text);
    }
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
    return "";
  }
  if (!present.files.empty())
    notify("Copied; the edits are in " + present.files.begin()->first.string());
  else
    notify("Copied");
  return present.text;
}

void Workspace::export_pose(const std::filesystem::path& output) {
  if (!rig) return notify("Open a head first", Notice::Kind::warning);
  run(pose_command(standing_pose(), rig->file, output), "Export " + output.filename().string());
}

void Workspace::export_take(const std::filesystem::path& output, double fps) {
  if (!rig || !take) return notify("Load a recording first", Notice::Kind::warning);
  run(play_command(state().take, state().pose, rig->file, fps, output),
      "Export " + output.filename().string());
}

/// What the viewport shows, as `fascia render` takes it.
PictureOrder Workspace::picture_order() const {
  PictureOrder order;
  order.layers = names_of(settings.layers);
  order.is_plain = !settings.layers.has_textures;
  std::string shown;
  for (const rig::Muscle& muscle : rig->rig->muscles)
    if (!hidden_muscles.count(muscle.name)) shown += (shown.empty() ? "" : ",") + muscle.name;
  if (!hidden_muscles.empty()) order.muscles = shown;
  return order;
}

void Workspace::draw_picture(const std::filesystem::path& output, double aspect) {
  if (!rig) return notify("Open a head first", Notice::Kind::warning);
  PictureOrder order = picture_order();
  const view::Camera& camera = orbit.camera();
  const int height = 1600, most = 8192;  // pixels
  order.view = "front";
  order.camera = joined({camera.yaw, camera.pitch});
  order.look_at = joined({camera.target[0], camera.target[1], camera.target[2], camera.distance});
  order.size = std::to_string(std::clamp(static_cast<int>(std::lround(height * aspect)), 16, most)) + "x" +
               std::to_string(height);
  run(render_command(standing_pose(), rig->file, order, output), "Draw " + output.filename().string());
}

void Workspace::film_turntable(const std::filesystem::path& output) {
  if (!rig) return notify("Open a head first", Notice::Kind::warning);
  PictureOrder order = picture_order();
  order.view = "turntable";
  order.size = "800";
  run(render_command(standing_pose(), rig->file, order, output), "Film " + output.filename().string());
}

}  // namespace fascia::app
