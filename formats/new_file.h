#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace fascia::formats {

/// A temporary file beside its target, renamed to the target when it is complete and removed otherwise, also
/// by an interrupted program. Every step throws fascia::Error with the system's message on failure.
class NewFile {
 public:
  /// `target` may be a symbolic link: its destination is replaced.
  explicit NewFile(const std::filesystem::path& target);
  /// One that has no name until it is put in place, where the file system can do that (O_TMPFILE): a killed
  /// program leaves nothing.
  static NewFile nameless(const std::filesystem::path& target);
  NewFile(NewFile&& other) noexcept;
  NewFile& operator=(NewFile&&) = delete;
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  void write(std::span<const uint8_t> bytes);
  /// A path by which this process, and others started by it, can open the file while it is open here.
  std::filesystem::path opened();
  /// Flushes, closes and renames it, with the permissions of the file that it replaces.
  void put_in_place();

 private:
  NewFile() = default;
  void make();
  void give_name();

  std::filesystem::path target_;
  std::string name_;  ///< of the temporary file; empty: it has none
  int file_ = -1;
};

/// Writes all of `bytes` to an open file; false with errno set on failure.
bool write_all(int file, std::span<const uint8_t> bytes);

/// Throws fascia::Error for a path that cannot be written, with the message of the errno value `error`.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error);

}  // namespace fascia::formats
