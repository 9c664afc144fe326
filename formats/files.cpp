#include "formats/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>

#include "formats/partial.h"
#include "geometry/error.h"

namespace fascia::formats {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_write(const fs::path& path, int error) {
  throw Error("'" + path.string() + "' cannot be written: " + std::strerror(error) +
              "; check the folder, its permissions and free space");
}

using Parts = std::vector<std::span<const uint8_t>>;

bool write_all(int file, std::span<const uint8_t> part) {
  const uint8_t* at = part.data();
  size_t size = part.size();
  while (size > 0) {
    const ssize_t written = ::write(file, at, std::min(size, size_t{1} << 30));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      if (written == 0) errno = EIO;
      return false;
    }
    at += written;
    size -= static_cast<size_t>(written);
  }
  return true;
}

bool write_all(int file, const Parts& parts) {
  return std::all_of(parts.begin(), parts.end(), [&](const auto& part) { return write_all(file, part); });
}

/// A new file beside its target, removed again unless it is renamed into place.
class NewFile {
 public:
  explicit NewFile(const fs::path& target) : target_(target) {
    std::random_device random;
    do {
      char number[24];
      std::snprintf(number, sizeof number, ".%08x%08x.part", random(), random());
      name_ = target.string() + number;
      // Noted before it is made, so that no signal finds it unknown.
      remember_partial(name_);
      file_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
      if (file_ >= 0) return;
      const int error = errno;
      forget_partial(name_);
      if (error != EEXIST) fail_to_write(target_, error);
    } while (true);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() {
    if (file_ >= 0) close(file_);
    if (name_.empty()) return;
    unlink(name_.c_str());
    forget_partial(name_);
  }

  void write(const Parts& parts) {
    struct stat old = {};
    const mode_t mask = umask(0);
    umask(mask);
    const mode_t mode = stat(target_.c_str(), &old) == 0 ? old.st_mode & 07777 : 0666 & ~mask;
    if (!write_all(file_, parts) || fchmod(file_, mode) != 0) fail_to_write(target_, errno);
    // Some file systems report a full disk only now.
    if (fsync(file_) != 0 && errno != EINVAL && errno != EROFS) fail_to_write(target_, errno);
    const int closed = close(file_);
    file_ = -1;
    if (closed != 0) fail_to_write(target_, errno);
  }

  void rename_into_place() {
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail_to_write(target_, errno);
    forget_partial(name_);
    name_.clear();
  }

 private:
  fs::path target_;
  std::string name_;
  int file_ = -1;
};

void write_into(const fs::path& device, const Parts& parts) {
  const int file = open(device.c_str(), O_WRONLY);
  if (file < 0) fail_to_write(device, errno);
  const bool done = write_all(file, parts);
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
    bytes.resize(static_cast<size_t>(fs::file_size(path, status)));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file && !bytes.empty()) throw Error("'" + path.string() + "' cannot be read to its end");
    return bytes;
  }
  bytes.assign(std::istreambuf_iterator<char>(file), {});  // a pipe has no length
  return bytes;
}

void write_bytes(const fs::path& path, const void* bytes, size_t size) {
  write_parts(path, {{static_cast<const uint8_t*>(bytes), size}});
}

void write_parts(const fs::path& path, const Parts& parts) {
  std::error_code status;
  const fs::file_status there = fs::status(path, status);
  if (fs::is_directory(there)) throw Error("'" + path.string() + "' is a folder; give the name of a file");
  if (fs::exists(there) && !fs::is_regular_file(there)) return write_into(path, parts);
  const bool is_link = fs::is_symlink(fs::symlink_status(path, status));
  const fs::path target = is_link ? fs::weakly_canonical(path, status) : path;
  NewFile file(target);
  file.write(parts);
  file.rename_into_place();
}

void write_text(const fs::path& path, const std::string& text) {
  write_bytes(path, text.data(), text.size());
}

FileBeside read_beside(const fs::path& owner, const std::string& relative, bool allow_outside) {
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
  if (status || (!allow_outside && !is_within(real, home)))
    return {std::nullopt, "lies outside the folder of '" + owner.filename().string() +
                              "' and is not opened; move it there, or give --allow-outside"};
  if (!fs::is_regular_file(real, status))
    return {std::nullopt, "is not there; put it where the file says, beside it"};
  try {
    return {read_bytes(real), ""};
  } catch (const Error&) {
    return {std::nullopt, "cannot be read; check its permissions"};
  }
}

}  // namespace fascia::formats
