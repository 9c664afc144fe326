#include "app/model/session.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "geometry/error.h"

namespace fascia::app {

namespace fs = std::filesystem;
using Lock = formats::FileLock;

namespace {

constexpr const char* autosave_name = "autosave.json";
constexpr size_t most_orphans = 4;  ///< with an autosave; older ones are removed

/// A new folder with a name of its own below `sessions`; empty when none can be made.
fs::path new_folder(const fs::path& sessions) {
  std::error_code status;
  fs::create_directories(sessions, status);
  std::string name = (sessions / "window-XXXXXX").string();
  return mkdtemp(name.data()) ? fs::path(name) : fs::path();
}

}  // namespace

Session::Session(const fs::path& state) {
  fs::path sessions = state / "sessions";
  std::error_code status;
  fs::create_directories(sessions, status);
  // Between the making of a folder and its lock no other window may take it for a crashed one's.
  const Lock guard(sessions / ".lock", Lock::Wait::yes);
  folder_ = new_folder(sessions);
  if (folder_.empty()) folder_ = new_folder(sessions = fs::temp_directory_path(status) / "fascia-sessions");
  if (folder_.empty())
    throw Error("no folder can be made below '" + (state / "sessions").string() + "' or '" +
                sessions.string() + "': make one of them writable, or set TMPDIR or --state");
  lock_ = Lock(folder_ / ".lock", Lock::Wait::no);
  autosave_ = Autosave(folder_ / autosave_name);
  adopt_orphans(sessions);
}

Session::~Session() {
  std::error_code status;
  fs::remove_all(folder_, status);
}

void Session::adopt_orphans(const fs::path& sessions) {
  struct Orphan {
    fs::path folder;
    fs::file_time_type saved;
    Lock lock;
    DocumentState document;
  };
  std::vector<Orphan> orphans;
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(sessions, status)) {
    if (!entry.is_directory(status) || entry.path() == folder_) continue;
    Lock lock(entry.path() / ".lock", Lock::Wait::no);
    if (!lock.holds()) continue;
    fs::remove_all(entry.path() / "built", status);
    const auto document = Autosave(entry.path() / autosave_name).left_behind();
    if (document && !document->head.empty())
      orphans.push_back({entry.path(), fs::last_write_time(entry.path() / autosave_name, status),
                         std::move(lock), *document});
    else
      fs::remove_all(entry.path(), status);
  }
  std::sort(orphans.begin(), orphans.end(),
            [](const Orphan& a, const Orphan& b) { return a.saved > b.saved; });
  for (size_t i = most_orphans; i < orphans.size(); ++i)
    fs::remove_all(orphans[i].folder, status);
  if (orphans.empty()) return;
  orphan_ = orphans[0].folder;
  orphan_lock_ = std::move(orphans[0].lock);
  left_behind_ = std::move(orphans[0].document);
}

void Session::forget_left_behind() {
  std::error_code status;
  if (!orphan_.empty()) fs::remove_all(orphan_, status);
  orphan_.clear();
  orphan_lock_ = Lock();
  left_behind_.reset();
}

fs::path Session::next_build() {
  const fs::path folder = folder_ / "built" / std::to_string(++builds_);
  fs::create_directories(folder);
  return folder;
}

}  // namespace fascia::app
