#include "runtime/crowd.h"

#include <atomic>
#include <exception>
#include <mutex>

namespace fascia::runtime {
namespace {

struct Work {
  std::span<Face* const> faces;
  double seconds;
  std::atomic<std::size_t> diverged{0};
  std::mutex mutex;
  std::exception_ptr fault;  ///< the first; nothing may pass through the host's code

  void run(std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end && i < faces.size(); ++i)
      try {
        if (!faces[i]->step(seconds)) ++diverged;
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!fault) fault = std::current_exception();
      }
  }
};

void run_range(uint32_t first, uint32_t end, void* context) {
  static_cast<Work*>(context)->run(first, end);
}

}  // namespace

std::size_t step_all(std::span<Face* const> faces, double seconds, const fascia_tasks* tasks) {
  Work work{faces, seconds, {}, {}, {}};
  if (tasks == nullptr || faces.empty()) {
    work.run(0, faces.size());
  } else if (void* task = tasks->begin(run_range, static_cast<uint32_t>(faces.size()), 1, &work, tasks->user);
             task != nullptr) {
    tasks->finish(task, tasks->user);
  }
  if (work.fault) std::rethrow_exception(work.fault);
  return work.diverged;
}

}  // namespace fascia::runtime
