#include <algorithm>
#include <cctype>

#include "app/workspace.h"
#include "builder/rigging/embedded_head.h"
#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/json.h"
#include "geometry/text.h"

namespace fascia::app {

namespace {

bool is_mesh_file(const std::filesystem::path& file) {
  const std::string extension = extension_of(file);
  return extension == ".glb" || extension == ".gltf" || extension == ".obj" || extension == ".ply" ||
         extension == ".stl" || extension == ".vrm";
}

/// An edits file is JSON that has one of the builder's lists; other JSON is a recording.
bool is_edits_file(const std::filesystem::path& file) {
  if (extension_of(file) != ".json") return false;
  const std::vector<uint8_t> bytes = formats::read_bytes(file);
  const auto json = parse_json<nlohmann::ordered_json>(bytes, "'" + file.string() + "'");
  return json.is_object() &&
         (json.contains("landmarks") || json.contains("muscles") || json.contains("new_muscles"));
}

}  // namespace

void Workspace::open(const std::filesystem::path& file) {
  try {
    std::error_code status;
    if (!std::filesystem::exists(file, status)) throw Error("'" + file.string() + "' is not there");
    if (is_edits_file(file)) return load_edits(file);
    if (!is_mesh_file(file)) return load_take(file);
  } catch (const std::exception& error) {
    return notify(error.what(), Notice::Kind::error);
  }
  cancel_build();
  opened_ = std::filesystem::absolute(file).string();
  building_edits_ = nlohmann::ordered_json::object();
  build_ = std::make_unique<BuildTask>(BuildOrder{opened_, places_.state / "built", "", "medium", false});
}

void Workspace::open_embedded_head() {
  try {
    const std::filesystem::path folder = places_.state / "built";
    std::filesystem::create_directories(folder);
    rigging::write_embedded_head(folder / "embedded_head.obj", folder / "embedded_head_landmarks.json");
    open(folder / "embedded_head.obj");
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

void Workspace::rebuild() {
  if (!rig) return notify("Open a head first", Notice::Kind::warning);
  cancel_build();
  opened_.clear();
  building_edits_ = state().edits;
  const std::filesystem::path folder = places_.state / "built", edits = folder / "edits.json";
  try {
    std::filesystem::create_directories(folder);
    write_edits_file(edits, state());
  } catch (const std::exception& error) {
    return notify(error.what(), Notice::Kind::error);
  }
  build_ = std::make_unique<BuildTask>(
      BuildOrder{rig->head, folder, state().edits.empty() ? "" : edits, "medium", true});
}

void Workspace::cancel_build() {
  if (!build_) return;
  build_->cancel();
  // Its thread ends with the stage that runs; until then nobody waits for it.
  given_up_.push_back(std::move(build_));
}

BuildTask::Progress Workspace::build_progress() const {
  return build_ ? build_->progress() : BuildTask::Progress{};
}

void Workspace::restore(const DocumentState& saved) {
  const DocumentState next = saved;
  open(next.head);
  if (!build_) return;
  // Edits are built in once the head is there, see update().
  history_.reset(next);
  opened_ = next.head;
  if (!next.take.file.empty()) load_take(next.take.file);
}

void Workspace::load_take(const std::filesystem::path& file) {
  try {
    auto loaded = std::make_shared<const Take>(file);
    size_t known = loaded->names().size();
    if (rig) {
      const std::vector<bool> matched = loaded->matched(rig->asset->handle());
      known = static_cast<size_t>(std::count(matched.begin(), matched.end(), true));
    }
    take = loaded;
    DocumentState next = state();
    const std::string path = std::filesystem::absolute(file).string();
    if (next.take.file != path) next.take = {path, 0.0, -1.0, true};
    commit(std::move(next), "Load recording");
    playback.time = state().take.begin;
    playback.is_playing = true;
    notify("Loaded " + file.filename().string() + ": " + std::to_string(known) + " of " +
               std::to_string(loaded->names().size()) + " curves move this face",
           known ? Notice::Kind::info : Notice::Kind::warning);
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

void Workspace::load_edits(const std::filesystem::path& file) {
  try {
    DocumentState next = state();
    next.edits = read_edits_file(file);
    commit(std::move(next), "Load edits");
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

bool Workspace::save_edits(const std::filesystem::path& file) {
  try {
    write_edits_file(file, state());
    notify("Saved " + file.string());
    return true;
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
    return false;
  }
}

bool Workspace::save_rig(const std::filesystem::path& file) {
  if (!rig) {
    notify("There is no rig to save yet", Notice::Kind::warning);
    return false;
  }
  try {
    const std::vector<uint8_t> bytes = formats::read_bytes(rig->file);
    formats::write_bytes(file, bytes.data(), bytes.size());
    notify("Saved " + file.string());
    return true;
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
    return false;
  }
}

}  // namespace fascia::app
