#pragma once

#include <filesystem>
#include <optional>
#include <system_error>

#include "app/model/settings.h"
#include "formats/file_lock.h"

namespace fascia::app {

/// A folder that one open window has to itself, for what it builds and for its autosave: DIR/sessions/NAME
/// below the folder that all windows share. A lock that the system lets go with the process tells folders in
/// use from those of windows that crashed. The folder goes when the window closes as it should.
class Session {
 public:
  /// Makes the folder, in the temporary directory where `state` cannot be written. Of folders that crashed
  /// windows left, the one with the newest autosave is offered by left_behind(), a few more are kept for
  /// later windows, and the rest is removed. Throws fascia::Error when no folder can be made.
  explicit Session(const std::filesystem::path& state);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  /// Writes the document, if it is another than the last. Never throws.
  void keep(const DocumentState& state) { autosave_.keep(state); }

  /// The document of a window that crashed, offered by no other window; nothing when there is none.
  const std::optional<DocumentState>& left_behind() const { return left_behind_; }
  /// Removes what that window left: it has been taken over, or is not wanted.
  void forget_left_behind();

  /// A folder of its own for each build, so that nothing that reads a rig sees another build's.
  std::filesystem::path next_build();
  /// Removes the folders of builds but those for which `is_used` says so.
  template <class Used>
  void remove_builds(const Used& is_used) const {
    std::error_code status;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "built", status))
      if (!is_used(entry.path())) std::filesystem::remove_all(entry.path(), status);
  }

 private:
  void adopt_orphans(const std::filesystem::path& sessions);

  std::filesystem::path folder_, orphan_;
  formats::FileLock lock_, orphan_lock_;
  Autosave autosave_{""};
  std::optional<DocumentState> left_behind_;
  int builds_ = 0;
};

}  // namespace fascia::app
