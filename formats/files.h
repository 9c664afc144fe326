#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// All access to files. Writing is atomic; files referenced by an input are opened only in that input's
/// folder.
namespace fascia::formats {

/// The bytes of a file. Throws fascia::Error if it cannot be read.
std::vector<uint8_t> read_bytes(const std::filesystem::path& path);

/// Writes `bytes` to a temporary file beside `path` with a unique name and renames it: readers see the old
/// file or the new one. Symbolic links are followed, permissions of a replaced file are kept, and devices and
/// pipes are written directly. The folder must exist. Throws fascia::Error on failure, without leaving a
/// temporary file.
void write_bytes(const std::filesystem::path& path, const void* bytes, size_t size);
/// The same for a file given in several consecutive parts.
void write_parts(const std::filesystem::path& path, const std::vector<std::span<const uint8_t>>& parts);
void write_text(const std::filesystem::path& path, const std::string& text);

/// The bytes of a referenced file, or why it was not read, with a remedy.
struct FileBeside {
  std::optional<std::vector<uint8_t>> bytes;
  std::string why;
};

/// Opens the file `relative` (forward or backward slashes) from the folder of `owner`. A file outside that
/// folder, by its path or through a symbolic link, is not opened unless `allow_outside`.
FileBeside read_beside(const std::filesystem::path& owner, const std::string& relative, bool allow_outside);

}  // namespace fascia::formats
