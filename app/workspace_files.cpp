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
  std::error_code status;
  if (!std::filesystem::exists(file, status))
    return notify("'" + file.string() + "' is not there", Notice::Kind::error);
  if (!is_mesh_file(file)) return read_file(file, FileKind::either, false);
  cancel_build();
  opened_ = std::filesystem::absolute(file).string();
  building_edits_ = nlohmann::ordered_json::object();
  start_build(opened_, false);
}

/// Begins a build in a folder of its own.
void Workspace::start_build(const std::filesystem::path& head, bool builds_anew) {
  try {
    BuildOrder order{head, session_.next_build(), "", "medium", builds_anew};
    if (!building_edits_.empty()) {
      order.edits = order.cache / "edits.json";
      write_edits_file(order.edits, building_edits_);
    }
    build_ = std::make_unique<BuildTask>(std::move(order));
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
}

/// Jobs, and the window itself, may still read rigs of earlier builds.
void Workspace::remove_old_builds() {
  session_.remove_builds([this](const std::filesystem::path& folder) {
    const auto is_within = [&](const std::filesystem::path& file) { return file.parent_path() == folder; };
    if (rig && (is_within(rig->file) || is_within(rig->head))) return true;
    if (other_ && is_within(other_->file)) return true;
    for (const BuildTask* task : {build_.get(), other_build_.get()})
      if (task && task->cache() == folder) return true;
    for (const auto& task : given_up_)
      if (task->cache() == folder) return true;
    for (const auto& job : jobs_)
      for (const std::string& word : job->arguments())
        if (is_within(word)) return true;
    return saving_.is_running();
  });
}

void Workspace::open_embedded_head() {
  try {
    // Recent files and copied commands name it: it stays, and is the same for all windows.
    const std::filesystem::path folder = places_.state / "embedded_head";
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
  start_build(rig->head, true);
}

void Workspace::cancel_build() {
  if (!build_) return;
  build_->cancel();
  restores_ = false;
  // Its thread ends with the stage that runs; until then nobody waits for it.
  given_up_.push_back(std::move(build_));
}

BuildTask::Progress Workspace::build_progress() const {
  return build_ ? build_->progress() : BuildTask::Progress{};
}

void Workspace::restore() {
  if (!left_behind()) return;
  const DocumentState saved = *left_behind();
  open(saved.head);
  if (!build_) return;
  restores_ = true;
  // Edits are built in once the head is there, see update().
  history_.reset(saved);
  opened_ = saved.head;
  follow_document();
}

// --- Recordings and edits

void Workspace::load_take(const std::filesystem::path& file) {
  read_file(file, FileKind::take, false);
}

void Workspace::load_layer(const std::filesystem::path& file) {
  read_file(file, take || !coming_files_.empty() ? FileKind::layer : FileKind::take, false);
}

void Workspace::load_edits(const std::filesystem::path& file) {
  read_file(file, FileKind::edits, false);
}

void Workspace::read_file(const std::filesystem::path& file, FileKind kind, bool is_again) {
  coming_files_.push_back(std::async(std::launch::async, [file, kind, is_again] {
    ReadFile read = read_now(file, kind);
    read.is_again = is_again;
    return read;
  }));
}

Workspace::ReadFile Workspace::read_now(const std::filesystem::path& file, FileKind kind) {
  ReadFile read{file, nullptr, {}, false, kind == FileKind::layer};
  if (kind == FileKind::edits || (kind == FileKind::either && is_edits_file(file)))
    read.edits = read_edits_file(file);
  else
    read.take = std::make_shared<const Take>(file);
  return read;
}

void Workspace::take_files(bool waits) {
  while (!coming_files_.empty()) {
    std::future<ReadFile>& first = coming_files_.front();
    if (!waits && first.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    std::future<ReadFile> done = std::move(first);
    coming_files_.pop_front();
    try {
      adopt(done.get());
    } catch (const std::exception& error) {
      notify(error.what(), Notice::Kind::error);
    }
  }
}

void Workspace::wait_for_files() {
  take_files(true);
  take_saved(true);
}

// --- Saving

bool Workspace::save_edits(const std::filesystem::path& file) {
  try {
    write_edits_file(file, state().edits);
    saved_edits_ = SavedFile{std::filesystem::absolute(file), text_of_edits(state().edits)};
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
  saved_rig_ = SavedFile{std::filesystem::absolute(file), rig->file.string()};
  saving_.start([from = rig->file, file] {
    const std::vector<uint8_t> bytes = formats::read_bytes(from);
    formats::write_bytes(file, bytes.data(), bytes.size());
    return file;
  });
  if (waits()) take_saved(true);
  return saved_rig_.has_value();
}

void Workspace::take_saved(bool waits) {
  try {
    if (const auto file = saving_.take(waits)) notify("Saved " + file->string());
  } catch (const std::exception& error) {
    saved_rig_.reset();
    notify(error.what(), Notice::Kind::error);
  }
}

}  // namespace fascia::app
