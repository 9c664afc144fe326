#pragma once

#include <cstddef>
#include <vector>

namespace fascia::sim::realtime {

/// Numbers on whole cache lines, zero at first.
template <class Number>
class Aligned {
 public:
  static constexpr size_t line = 64 / sizeof(Number);  ///< numbers on one

  Aligned() = default;
  explicit Aligned(size_t count) : lines_((count + line - 1) / line) {}
  Number* data() { return lines_.empty() ? nullptr : lines_.front().value; }
  const Number* data() const { return lines_.empty() ? nullptr : lines_.front().value; }
  size_t size() const { return line * lines_.size(); }

 private:
  struct alignas(64) Line {
    Number value[line] = {};
  };
  std::vector<Line> lines_;
};
using Floats = Aligned<float>;

}  // namespace fascia::sim::realtime
