#pragma once

#include <cstddef>
#include <functional>

namespace fascia {

/// Runs `part` for 0 .. count - 1, in any order and possibly in parallel, and returns when all are done;
/// exceptions are propagated. The caller of a module provides it: modules start no threads of their own.
/// Empty: sequential.
using ForEach = std::function<void(size_t count, const std::function<void(size_t)>& part)>;

inline void run_each(const ForEach& for_each, size_t count, const std::function<void(size_t)>& part) {
  if (for_each) return for_each(count, part);
  for (size_t i = 0; i < count; ++i)
    part(i);
}

}  // namespace fascia
