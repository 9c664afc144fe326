#pragma once

#include <cstddef>
#include <vector>

namespace fascia::sim::realtime {

/// Floats on whole cache lines, zero at first.
class Floats {
 public:
  Floats() = default;
  explicit Floats(size_t count) : lines_((count + 15) / 16) {}
  float* data() { return lines_.empty() ? nullptr : lines_.front().value; }
  const float* data() const { return lines_.empty() ? nullptr : lines_.front().value; }
  size_t size() const { return 16 * lines_.size(); }

 private:
  struct alignas(64) Line {
    float value[16] = {};
  };
  std::vector<Line> lines_;
};

}  // namespace fascia::sim::realtime
