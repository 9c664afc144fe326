#include "runtime/crowd.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <new>

#include "geometry/arithmetic_mode.h"
#include "runtime/allocator.h"

namespace fascia::runtime {
namespace {

struct Work {
  std::span<fascia_face* const> faces;
  double seconds;
  std::atomic<std::size_t> diverged{0};
  std::mutex mutex;
  std::exception_ptr fault;  ///< the first; nothing may pass through the host's code
  std::atomic<bool> ran_out{false};

  void run(std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end && i < faces.size(); ++i)
      try {
        if (!faces[i]->face->step(seconds)) ++diverged;
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!fault) fault = std::current_exception();
      }
  }
};

void run_range(uint32_t first, uint32_t end, void* context) {
  const ArithmeticMode mode;  // of a thread of the host's
  const RefusalsDeferred refusals;
  auto& work = *static_cast<Work*>(context);
  work.run(first, end);
  if (has_run_out()) work.ran_out = true;
}

}  // namespace

bool are_different(std::span<fascia_face* const> faces) {
  std::size_t marked = 0;
  while (marked < faces.size() && !faces[marked]->is_listed)
    faces[marked++]->is_listed = true;
  for (std::size_t i = 0; i < marked; ++i)
    faces[i]->is_listed = false;
  return marked == faces.size();
}

std::size_t step_all(std::span<fascia_face* const> faces, double seconds, const fascia_tasks* tasks) {
  Work work{faces, seconds, {}, {}, {}, {}};
  if (tasks == nullptr || faces.empty()) {
    work.run(0, faces.size());
  } else if (void* task = tasks->begin(run_range, static_cast<uint32_t>(faces.size()), 1, &work, tasks->user);
             task != nullptr) {
    tasks->finish(task, tasks->user);
  }
  if (work.ran_out) throw std::bad_alloc();
  if (work.fault) std::rethrow_exception(work.fault);
  return work.diverged;
}

}  // namespace fascia::runtime
