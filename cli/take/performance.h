#pragma once

#include <functional>
#include <vector>

#include "cli/progress.h"
#include "cli/take/curves.h"

namespace fascia::cli {

/// A take to simulate: frames at an even rate from the curves' first key up to the first frame that shows
/// their last one.
struct Take {
  const Curves& curves;
  double frames_per_second = 60.0;
  size_t frames() const;
  double time(size_t frame) const { return static_cast<double>(frame) / frames_per_second; }
};

struct PerformanceFigures {
  int resets = 0;
  double milliseconds_a_frame = 0.0;  ///< median of a step
};

/// Simulates the take on `face`, which must be fresh: the first frame is the first key's pose at balance, the
/// others follow in time. `visit` sees the face at each frame. The same take on the same rig gives the same
/// frames, to the last bit.
PerformanceFigures perform(const Take& take, Face& face, Progress& progress,
                           const std::function<void(size_t frame)>& visit);

}  // namespace fascia::cli
