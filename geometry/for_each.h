#pragma once

#include <cstddef>
#include <functional>

namespace fascia {

/// Runs `part` for 0 .. count - 1, in any order and perhaps side by side, and returns when all are done; what
/// a part throws comes out. Who calls a room decides how: rooms themselves start no threads. Empty: one after
/// the other.
using ForEach = std::function<void(size_t count, const std::function<void(size_t)>& part)>;

inline void run_each(const ForEach& for_each, size_t count, const std::function<void(size_t)>& part) {
  if (for_each) return for_each(count, part);
  for (size_t i = 0; i < count; ++i)
    part(i);
}

}  // namespace fascia
