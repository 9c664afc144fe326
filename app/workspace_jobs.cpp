#include <Eigen/Geometry>
#include <algorithm>

#include "app/workspace.h"
#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/json.h"

namespace fascia::app {

namespace {

using Json = nlohmann::ordered_json;

/// The first line of what the tool said, without its name.
std::string first_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  const std::string name = "fascia: ";
  return line.rfind(name, 0) == 0 ? line.substr(name.size()) : line;
}

/// Moves a recording to a name that no other has: other windows record into the same folder.
std::filesystem::path keep_recording(const std::filesystem::path& from, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (int number = 1;; ++number) {
    const std::filesystem::path file = folder / ("recording_" + std::to_string(number) + ".json");
    std::error_code status;
    std::filesystem::copy_file(from, file, status);  // never replaces one
    if (status == std::errc::file_exists) continue;
    if (status) throw Error("'" + file.string() + "' cannot be written: " + status.message());
    return file;
  }
}

}  // namespace

void Workspace::run(const CommandLine& command, const std::string& title) {
  try {
    jobs_.push_back(std::make_unique<ToolJob>(places_.tool, command, title));
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

void Workspace::run_check() {
  if (!rig) return;
  run({"check", rig->file.string(), "--json"}, "Check");
}

void Workspace::read_check(const ToolJob& job) {
  const Json json = parse_json<Json>(job.output(), "the check's report");
  if (!json.is_object() || !json.contains("rows") || !rig) return;
  size_t failed = 0;
  for (const Json& row : json["rows"]) {
    if (row.value("ok", true)) continue;
    ++failed;
    const std::string text =
        "check " + row.value("name", std::string()) + ": " + row.value("remedy", std::string());
    const std::string start = text.substr(0, text.find(':'));
    warnings.erase(
        std::remove_if(warnings.begin(), warnings.end(),
                       [&](const Warning& known) { return known.text.rfind(start + ":", 0) == 0; }),
        warnings.end());
    warnings.push_back(warning_of(text));
  }
  notify("Checked: " + std::to_string(json["rows"].size()) + " rows, " + std::to_string(failed) + " failed",
         failed ? Notice::Kind::warning : Notice::Kind::info);
}

void Workspace::take_jobs() {
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    ToolJob& now = **job;
    if (!now.poll()) {
      ++job;
      continue;
    }
    const int check_failed = 4;
    if (now.title() == "Check" && (now.exit_code() == 0 || now.exit_code() == check_failed))
      read_check(now);
    else if (now.was_cancelled())
      notify(now.title() + ": given up");
    else if (now.exit_code() == 0)
      notify(now.title() + ": done");
    else
      notify(now.title() + ": " + first_line(now.message()), Notice::Kind::error);
    job = jobs_.erase(job);
  }
}

void Workspace::listen(LiveReceiver::Protocol protocol, uint16_t port) {
  live.reset();
  try {
    live = std::make_unique<LiveReceiver>(protocol, port);
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

void Workspace::start_recording() {
  playback.recorded.clear();
  playback.recorded_seconds = 0.0;
  playback.is_recording = true;
  playback.adds_layer = take != nullptr;
  if (!take) return;
  // A layer begins with the recording; before the piece that is played it holds.
  playback.time = state().take.begin;
  playback.recorded_seconds = playback.time;
  playback.is_playing = true;
}

void Workspace::stop_recording() {
  playback.is_recording = false;
  if (playback.recorded.empty()) return;
  std::set<std::string> names;
  for (const auto& pose : playback.recorded)
    for (const auto& [name, value] : pose)
      names.insert(name);
  if (names.empty()) return notify("Nothing was moved while recording", Notice::Kind::warning);
  Json channels = Json::object();
  for (const std::string& name : names) {
    const double rest = rig ? static_cast<double>(rig->asset->range_of(name).rest) : 0.0;
    Json& values = channels[name] = Json::array();
    for (const auto& pose : playback.recorded) {
      const auto found = pose.find(name);
      values.push_back(found == pose.end() ? rest : found->second);
    }
  }
  const Json json = {{"fps", recorded_rate}, {"channels", channels}};
  try {
    const std::filesystem::path written = session_.folder() / "recording.json";
    formats::write_text(written, json.dump());
    const std::filesystem::path file = keep_recording(written, places_.state / "recordings");
    clear_pose();
    if (playback.adds_layer)
      load_layer(file);
    else
      load_take(file);
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

void Workspace::poke(const SkinHit& hit) {
  if (!frame) return;
  const double radius = 0.012;  // metres: a fingertip
  const size_t most = 16;       // each takes some of the 64 places for touches
  poke_ =
      Poke{hit.part, hit.vertex, hit.position, soft_selection(*frame, hit.part, hit.vertex, radius, most)};
  if (poke_->grip.empty()) poke_->grip.emplace_back(hit.vertex, 1.0);
}

void Workspace::pull(const Vec3& target) {
  if (poke_) poke_->target = target;
}

void Workspace::let_go() {
  poke_.reset();
}

}  // namespace fascia::app
