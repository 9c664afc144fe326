#include "formats/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "formats/new_file.h"
#include "geometry/error.h"

namespace fascia::formats {

namespace {

namespace fs = std::filesystem;

using Parts = std::vector<std::span<const uint8_t>>;

void write_into(const fs::path& device, const Parts& parts) {
  const int file = open(device.c_str(), O_WRONLY);
  if (file < 0) fail_to_write(device, errno);
  const bool done =
      std::all_of(parts.begin(), parts.end(), [&](const auto& part) { return write_all(file, part); });
  const int error = errno;
  close(file);
  if (!done) fail_to_write(device, error);
}

/// True when `path` is `folder` or lies in it; both canonical.
bool is_within(const fs::path& path, const fs::path& folder) {
  const auto [in_folder, in_path] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return in_folder == folder.end();
}

}  // namespace

std::vector<uint8_t> read_bytes(const fs::path& path) {
  std::error_code status;
  if (!fs::exists(path, status)) throw Error("'" + path.string() + "' does not exist");
  if (fs::is_directory(path, status)) throw Error("'" + path.string() + "' is a folder, not a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("'" + path.string() + "' cannot be opened: check its permissions");
  std::vector<uint8_t> bytes;
  if (fs::is_regular_file(path, status)) {
    const auto size = static_cast<size_t>(fs::file_size(path, status));
    if (size > most_bytes) throw Error("'" + path.string() + "' is larger than 4 GB");
    bytes.resize(size);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file && !bytes.empty()) throw Error("'" + path.string() + "' cannot be read to its end");
    return bytes;
  }
  std::vector<char> piece(1 << 16);
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0) {
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + file.gcount());
    if (bytes.size() > most_piped_bytes)
      throw Error("'" + path.string() + "' goes on beyond 512 MB: save it to a file");
  }
  return bytes;
}

void read_pieces(const fs::path& path, const std::function<void(std::span<const uint8_t>)>& use) {
  std::error_code status;
  if (!fs::exists(path, status)) throw Error("'" + path.string() + "' does not exist");
  if (!fs::is_regular_file(path, status)) throw Error("'" + path.string() + "' is not a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("'" + path.string() + "' cannot be opened: check its permissions");
  std::vector<uint8_t> piece(1 << 20);
  do {
    file.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
    use({piece.data(), static_cast<size_t>(file.gcount())});
  } while (file);
  if (!file.eof()) throw Error("'" + path.string() + "' cannot be read to its end");
}

void write_bytes(const fs::path& path, const void* bytes, size_t size) {
  write_parts(path, {{static_cast<const uint8_t*>(bytes), size}});
}

void write_parts(const fs::path& path, const Parts& parts) {
  std::error_code status;
  const fs::file_status there = fs::status(path, status);
  if (fs::is_directory(there)) throw Error("'" + path.string() + "' is a folder; give the name of a file");
  if (fs::exists(there) && !fs::is_regular_file(there)) return write_into(path, parts);
  NewFile file(path);
  for (const auto& part : parts)
    file.write(part);
  file.put_in_place();
}

void write_text(const fs::path& path, const std::string& text) {
  write_bytes(path, text.data(), text.size());
}

PathBeside find_beside(const fs::path& owner, const std::string& relative, Outside outside) {
  const fs::path folder = owner.has_parent_path() ? owner.parent_path() : fs::path(".");
  std::error_code status;
  fs::path wanted = folder / fs::path(relative);
  if (!fs::exists(wanted, status)) {
    std::string turned = relative;
    std::replace(turned.begin(), turned.end(), '\\', '/');
    wanted = folder / fs::path(turned);
  }
  const fs::path real = fs::weakly_canonical(wanted, status);
  const fs::path home = fs::weakly_canonical(folder, status);
  if (status || (outside != Outside::allowed && !is_within(real, home)))
    return {std::nullopt, "lies outside the folder of '" + owner.filename().string() +
                              "' and is not opened; move it there" +
                              (outside == Outside::refused_by_default ? ", or give --allow-outside" : "")};
  if (!fs::is_regular_file(real, status))
    return {std::nullopt, "is not there; put it where the file says, beside it"};
  return {real, ""};
}

FileBeside read_beside(const fs::path& owner, const std::string& relative, Outside outside) {
  const PathBeside found = find_beside(owner, relative, outside);
  if (!found.path) return {std::nullopt, found.why};
  try {
    return {read_bytes(*found.path), ""};
  } catch (const Error&) {
    return {std::nullopt, "cannot be read; check its permissions"};
  }
}

}  // namespace fascia::formats
