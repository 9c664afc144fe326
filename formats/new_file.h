#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace fascia::formats {

/// A file that is written beside its target, under a name no other has, and renamed into its place once it is
/// whole; removed again otherwise, by an interrupted program too. Every step throws fascia::Error with the
/// system's own words when it fails.
class NewFile {
 public:
  /// `target` may be a symbolic link: what it leads to is replaced.
  explicit NewFile(const std::filesystem::path& target);
  NewFile(NewFile&& other) noexcept;
  NewFile& operator=(NewFile&&) = delete;
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  void write(std::span<const uint8_t> bytes);
  /// Flushes, closes and renames it, with the rights of the file that it replaces.
  void put_in_place();

 private:
  std::filesystem::path target_;
  std::string name_;
  int file_ = -1;
};

/// Writes all of `bytes` to an open file; false with errno set when that fails.
bool write_all(int file, std::span<const uint8_t> bytes);

/// Throws fascia::Error of a path that cannot be written, in the words of errno's value `error`.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error);

}  // namespace fascia::formats
