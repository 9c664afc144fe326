#include "formats/partial.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>
#include <ctime>
#include <mutex>

namespace fascia::formats {

namespace {

/// A place in a table that a signal handler may read at any moment: it is filled before it is marked used.
struct Place {
  std::array<char, 4096> path = {};
  std::atomic<bool> is_used = false;
};

constinit std::array<Place, 1024> table;

std::mutex& writers() {
  static std::mutex mutex;
  return mutex;
}

constinit std::atomic<bool> is_ending = false;
constinit std::atomic<int> files_in_making = 0;

/// Until files that other threads are making are there; not for long, as a file server may not answer.
void wait_for_files_in_making() {
  constexpr int most = 100;
  const timespec millisecond = {0, 1'000'000};
  for (int k = 0; k < most && files_in_making > 0; ++k)
    nanosleep(&millisecond, nullptr);
}

}  // namespace

void remember_partial(const std::filesystem::path& path) {
  std::error_code status;
  const std::string whole = std::filesystem::absolute(path, status).string();
  const std::lock_guard lock(writers());
  for (Place& place : table) {
    if (place.is_used || whole.size() >= place.path.size()) continue;
    std::memcpy(place.path.data(), whole.c_str(), whole.size() + 1);
    place.is_used = true;
    return;
  }
}

void forget_partial(const std::filesystem::path& path) {
  std::error_code status;
  const std::string whole = std::filesystem::absolute(path, status).string();
  const std::lock_guard lock(writers());
  for (Place& place : table)
    if (place.is_used && whole == place.path.data()) place.is_used = false;
}

void remove_partial_files() {
  is_ending = true;
  wait_for_files_in_making();
  for (Place& place : table)
    if (place.is_used) unlink(place.path.data());
  for (Place& place : table)
    if (place.is_used) rmdir(place.path.data());
}

MakingPartial::MakingPartial() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &signals_);
  ++files_in_making;
  if (!is_ending) return;
  --files_in_making;
  pthread_sigmask(SIG_SETMASK, &signals_, nullptr);
  for (;;)
    pause();
}

MakingPartial::~MakingPartial() {
  --files_in_making;
  pthread_sigmask(SIG_SETMASK, &signals_, nullptr);
}

PartialGroup::~PartialGroup() {
  std::error_code ignored;
  for (auto path = paths_.rbegin(); path != paths_.rend(); ++path)
    std::filesystem::remove(*path, ignored);
  keep();
}

void PartialGroup::add(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) return;
  paths_.push_back(path);
  remember_partial(path);
}

void PartialGroup::keep() {
  for (const std::filesystem::path& path : paths_)
    forget_partial(path);
  paths_.clear();
}

}  // namespace fascia::formats
