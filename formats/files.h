#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The one place that opens files. What is written appears whole or not at all; what an input names beside
/// itself is looked for in that input's own folder.
namespace fascia::formats {

/// A whole file's bytes. Throws fascia::Error when it cannot be read.
std::vector<uint8_t> read_bytes(const std::filesystem::path& path);

/// Writes `bytes` into a new file beside `path`, of a name no other process uses, and renames it into place:
/// readers see the old file or the new one. A link is followed, permissions of a file that is replaced are
/// kept, and devices and pipes are written as they are. The folder must be there. Throws fascia::Error when
/// it cannot; then nothing is left behind.
void write_bytes(const std::filesystem::path& path, const void* bytes, size_t size);
/// The same of a file in parts, one after the other.
void write_parts(const std::filesystem::path& path, const std::vector<std::span<const uint8_t>>& parts);
void write_text(const std::filesystem::path& path, const std::string& text);

/// A file that `owner` names as `relative`, or why it is not read and the one thing to do about it.
struct FileBeside {
  std::optional<std::vector<uint8_t>> bytes;
  std::string why;
};

/// Opens the file `relative` (forward or backward slashes) from the folder of `owner`. One that lies outside
/// that folder, by its path or through a link, is not opened unless `allow_outside`.
FileBeside read_beside(const std::filesystem::path& owner, const std::string& relative, bool allow_outside);

}  // namespace fascia::formats
