#include "formats/new_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>

#include "formats/partial.h"
#include "geometry/error.h"

namespace fascia::formats {

namespace fs = std::filesystem;

void fail_to_write(const fs::path& path, int error) {
  throw Error("'" + path.string() + "' cannot be written: " + std::strerror(error) +
              "; check the folder, its permissions and free space");
}

bool write_all(int file, std::span<const uint8_t> bytes) {
  const uint8_t* at = bytes.data();
  size_t size = bytes.size();
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

NewFile::NewFile(const fs::path& target) : target_(target) {
  std::error_code status;
  if (fs::is_symlink(fs::symlink_status(target, status))) target_ = fs::weakly_canonical(target, status);
  std::random_device random;
  do {
    char number[24];
    std::snprintf(number, sizeof number, ".%08x%08x.part", random(), random());
    name_ = target_.string() + number;
    // Noted before it is made, so that no signal finds it unknown.
    remember_partial(name_);
    file_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file_ >= 0) return;
    const int error = errno;
    forget_partial(name_);
    if (error != EEXIST) fail_to_write(target_, error);
  } while (true);
}

NewFile::NewFile(NewFile&& other) noexcept
    : target_(std::move(other.target_)),
      name_(std::exchange(other.name_, std::string())),
      file_(std::exchange(other.file_, -1)) {}

NewFile::~NewFile() {
  if (file_ >= 0) close(file_);
  if (name_.empty()) return;
  unlink(name_.c_str());
  forget_partial(name_);
}

void NewFile::write(std::span<const uint8_t> bytes) {
  if (!write_all(file_, bytes)) fail_to_write(target_, errno);
}

void NewFile::put_in_place() {
  struct stat old = {};
  const mode_t mask = umask(0);
  umask(mask);
  const mode_t mode = stat(target_.c_str(), &old) == 0 ? old.st_mode & 07777 : 0666 & ~mask;
  if (fchmod(file_, mode) != 0) fail_to_write(target_, errno);
  // Some file systems report a full disk only now.
  if (fsync(file_) != 0 && errno != EINVAL && errno != EROFS) fail_to_write(target_, errno);
  const int closed = close(file_);
  file_ = -1;
  if (closed != 0) fail_to_write(target_, errno);
  if (std::rename(name_.c_str(), target_.c_str()) != 0) fail_to_write(target_, errno);
  forget_partial(name_);
  name_.clear();
}

}  // namespace fascia::formats
