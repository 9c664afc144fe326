#include "formats/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

namespace fascia::formats {

FileLock::FileLock(const std::filesystem::path& file, Wait wait, unsigned permissions) {
  file_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, permissions);
  if (file_ < 0) return;
  int result = 0;
  do
    result = flock(file_, LOCK_EX | (wait == Wait::no ? LOCK_NB : 0));
  while (result != 0 && errno == EINTR);
  holds_ = result == 0;
}

FileLock::~FileLock() {
  if (file_ >= 0) close(file_);
}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(holds_, other.holds_);
  return *this;
}

}  // namespace fascia::formats
