#include <Eigen/Geometry>
#include <algorithm>

#include "app/workspace.h"
#include "formats/files.h"
#include "formats/scene.h"
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

}  // namespace

void Workspace::run(const CommandLine& command, const std::string& title) {
  try {
    jobs_.push_back(std::make_unique<ToolJob>(places_.tool, command, title));
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

void Workspace::export_take(const std::filesystem::path& output, double fps) {
  if (!rig || !take) return notify("Load a recording first", Notice::Kind::warning);
  run(play_command(state().take, rig->file, fps, output), "Export " + output.filename().string());
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
    const std::filesystem::path folder = places_.state / "recordings";
    std::filesystem::create_directories(folder);
    std::filesystem::path file;
    for (int number = 1; file.empty() || std::filesystem::exists(file); ++number)
      file = folder / ("recording_" + std::to_string(number) + ".json");
    formats::write_text(file, json.dump());
    clear_pose();
    load_take(file);
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

/// The vertices of a file that has the head's meshes, one list a part of the asset.
std::vector<std::vector<float>> Workspace::positions_from(const std::string& file) const {
  const formats::Scene scene = formats::read(file);
  std::vector<std::vector<float>> lists;
  std::vector<bool> is_used(scene.meshes.size(), false);
  for (const FacePart& part : rig->asset->parts) {
    lists.emplace_back();
    for (size_t m = 0; m < scene.meshes.size(); ++m) {
      const formats::SceneMesh& mesh = scene.meshes[m];
      if (is_used[m] || mesh.positions.size() != part.vertex_count) continue;
      is_used[m] = true;
      for (const Vec3& p : mesh.positions) {
        const Vec3 metres = transform_point(rig->head_to_metres, p + scene.offset);
        for (int k = 0; k < 3; ++k)
          lists.back().push_back(static_cast<float>(metres[k]));
      }
      break;
    }
  }
  if (std::all_of(lists.begin(), lists.end(), [](const auto& list) { return list.empty(); }))
    throw Error("'" + file +
                "': none of its meshes has as many vertices as one of the head's; compare with a file "
                "of the same meshes");
  return lists;
}

void Workspace::compare_with(Reference wanted, const std::string& file) {
  reference.reset();
  reference_frame.reset();
  reference_positions.clear();
  coming_reference_ = {};
  comparison.reference = rig ? wanted : Reference::none;
  comparison.file = file;
  ++changes_;
  if (!rig) return;
  try {
    if (wanted == Reference::rest)
      for (const FacePart& part : rig->asset->parts)
        reference_positions.push_back(part.rest);
    if (wanted == Reference::file) reference_positions = positions_from(file);
    std::shared_ptr<const FaceAsset> asset = rig->asset;
    if (wanted == Reference::before) {
      if (!before_) throw Error("There is no rig from before: change a landmark or a muscle and build again");
      asset = before_->asset;
    }
    if (wanted == Reference::before || wanted == Reference::bullet || wanted == Reference::converged) {
      const fascia_solver solver = wanted == Reference::bullet      ? FASCIA_SOLVER_BULLET
                                   : wanted == Reference::converged ? FASCIA_SOLVER_REFERENCE
                                                                    : FASCIA_SOLVER_OWN;
      coming_reference_ = std::async(std::launch::async, [asset, solver, pace = pace_] {
        return std::make_unique<Simulation>(asset, solver, pace);
      });
    }
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
    comparison.reference = Reference::none;
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
