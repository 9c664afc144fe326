#pragma once

#include <csignal>
#include <filesystem>
#include <vector>

namespace fascia::formats {

/// Files, and folders, that are being written, so that a program which is interrupted can take them away. Of
/// more than 1,024 at a time, or paths of more than 4,095 bytes, the rest are not remembered.
void remember_partial(const std::filesystem::path& path);
void forget_partial(const std::filesystem::path& path);

/// Deletes what is remembered: files, then folders that are empty. For the end of a program: from then on no
/// remembered file is made. May be called in a signal handler.
void remove_partial_files();

/// Lives while a remembered file is made, so that `remove_partial_files` comes before it or after it, never
/// between. At the end of the program its constructor does not return. Signals wait for its destructor.
class MakingPartial {
 public:
  MakingPartial();
  ~MakingPartial();
  MakingPartial(const MakingPartial&) = delete;
  MakingPartial& operator=(const MakingPartial&) = delete;

 private:
  sigset_t signals_;
};

/// Files and folders that only make sense together. Until all are there, an interruption or an error takes
/// away those that are new.
class PartialGroup {
 public:
  PartialGroup() = default;
  ~PartialGroup();
  PartialGroup(const PartialGroup&) = delete;
  PartialGroup& operator=(const PartialGroup&) = delete;

  /// Before `path` is made. What is there already is not taken away.
  void add(const std::filesystem::path& path);
  /// All is there.
  void keep();

 private:
  std::vector<std::filesystem::path> paths_;
};

}  // namespace fascia::formats
