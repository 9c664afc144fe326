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

namespace {

/// Where a symbolic link leads to, also when there is nothing yet.
fs::path destination_of(fs::path target) {
  constexpr int most_links = 40;  // as many as the system follows
  std::error_code status;
  for (int k = 0; k < most_links && fs::is_symlink(fs::symlink_status(target, status)); ++k)
    target = target.parent_path() / fs::read_symlink(target, status);
  return target;
}

/// Calls `make`, which returns a file or -1 with errno set, with names beside `target` until one is not
/// taken. The name is remembered before it is made, so that no signal finds it unknown.
template <class Make>
std::string make_beside(const fs::path& target, Make&& make) {
  std::random_device random;
  for (;;) {
    char number[24];
    std::snprintf(number, sizeof number, ".%08x%08x.part", random(), random());
    const std::string name = target.string() + number;
    remember_partial(name);
    int error = 0;
    {
      const MakingPartial making;
      if (make(name.c_str()) < 0) error = errno;
    }
    if (error == 0) return name;
    forget_partial(name);
    if (error != EEXIST) fail_to_write(target, error);
  }
}

/// A path of the open file that other processes which inherit it can open too.
std::string path_of_opened(int file) {
  return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace

NewFile::NewFile(const fs::path& target) : target_(destination_of(target)) {
  make();
}

NewFile NewFile::nameless(const fs::path& target) {
  NewFile file;
  file.target_ = destination_of(target);
#ifdef O_TMPFILE
  const fs::path folder = file.target_.has_parent_path() ? file.target_.parent_path() : ".";
  file.file_ = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
#endif
  if (file.file_ < 0) file.make();
  return file;
}

void NewFile::make() {
  name_ = make_beside(target_, [this](const char* name) {
    return file_ = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  });
}

void NewFile::give_name() {
  name_ = make_beside(target_, [this](const char* name) {
    return linkat(AT_FDCWD, path_of_opened(file_).c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW);
  });
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

fs::path NewFile::opened() {
  if (!name_.empty()) return name_;
  fcntl(file_, F_SETFD, 0);  // other programs are to inherit it
  return path_of_opened(file_);
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
  if (name_.empty()) give_name();
  const int closed = close(file_);
  file_ = -1;
  if (closed != 0) fail_to_write(target_, errno);
  if (std::rename(name_.c_str(), target_.c_str()) != 0) fail_to_write(target_, errno);
  forget_partial(name_);
  name_.clear();
}

}  // namespace fascia::formats
