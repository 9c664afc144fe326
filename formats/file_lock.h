#pragma once

#include <filesystem>
#include <utility>

namespace fascia::formats {

/// A lock on a file that one process at a time can hold. The system lets it go with the process, whichever
/// way that ends.
class FileLock {
 public:
  enum class Wait { no, yes };
  FileLock() = default;
  static constexpr unsigned owner_only = 0600, everyone = 0666;  ///< who may open a file that is made
  /// Makes the file where there is none, and locks it; holds() tells whether that was possible, is_open()
  /// whether there is a file at least, which another process holds.
  FileLock(const std::filesystem::path& file, Wait wait, unsigned permissions = owner_only);
  ~FileLock();
  FileLock(FileLock&& other) noexcept
      : file_(std::exchange(other.file_, -1)), holds_(std::exchange(other.holds_, false)) {}
  FileLock& operator=(FileLock&& other) noexcept;

  bool holds() const { return holds_; }
  bool is_open() const { return file_ >= 0; }

 private:
  int file_ = -1;
  bool holds_ = false;
};

}  // namespace fascia::formats
