#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// All access to files. Writing is atomic; files referenced by an input are opened only in that input's
/// folder.
namespace fascia::formats {

/// Largest file that is read, as of GLB; so counts of vertices fit into an int.
inline constexpr size_t most_bytes = size_t{4} << 30;
/// Most that is read from a pipe or a device, which has no size.
inline constexpr size_t most_piped_bytes = size_t{512} << 20;

/// The bytes of a file. Throws fascia::Error if it cannot be read or is too large.
std::vector<uint8_t> read_bytes(const std::filesystem::path& path);

/// Calls `use` with the bytes of a regular file, in consecutive pieces of at most 1 MB. Throws fascia::Error
/// if it cannot be read.
void read_pieces(const std::filesystem::path& path, const std::function<void(std::span<const uint8_t>)>& use);

/// Writes `bytes` to a temporary file beside `path` with a unique name and renames it: readers see the old
/// file or the new one. Symbolic links are followed, permissions of a replaced file are kept, and devices and
/// pipes are written directly. The folder must exist. Throws fascia::Error on failure, without leaving a
/// temporary file.
void write_bytes(const std::filesystem::path& path, const void* bytes, size_t size);
/// The same for a file given in several consecutive parts.
void write_parts(const std::filesystem::path& path, const std::vector<std::span<const uint8_t>>& parts);
void write_text(const std::filesystem::path& path, const std::string& text);

/// Files outside the folder of the file that references them.
enum class Outside {
  refused,
  refused_by_default,  ///< refused with the advice to give --allow-outside
  allowed
};

/// How a mesh file is read.
struct ReadOptions {
  Outside outside = Outside::refused;  ///< files referenced by a glTF or by an OBJ's materials
};

/// The path of a referenced file, or why it may not be read, with a remedy.
struct PathBeside {
  std::optional<std::filesystem::path> path;
  std::string why;
};

/// The regular file `relative` (forward or backward slashes) in the folder of `owner`. One outside that
/// folder, by its path or through a symbolic link, is refused unless `outside` allows it.
PathBeside find_beside(const std::filesystem::path& owner, const std::string& relative, Outside outside);

/// The bytes of a referenced file, or why it was not read, with a remedy.
struct FileBeside {
  std::optional<std::vector<uint8_t>> bytes;
  std::string why;
};

/// The bytes of what `find_beside` finds.
FileBeside read_beside(const std::filesystem::path& owner, const std::string& relative, Outside outside);

}  // namespace fascia::formats
