#include "cli/take/performance.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace fascia::cli {

size_t Take::frames() const {
  return static_cast<size_t>(std::ceil(curves.duration() * frames_per_second - 1e-6)) + 1;
}

PerformanceFigures perform(const Take& take, Face& face, Progress& progress,
                           const std::function<void(size_t frame)>& visit) {
  PerformanceFigures figures;
  std::vector<float> milliseconds;
  take.curves.apply(0.0, face);
  face.pose();
  for (size_t f = 0; f < take.frames(); ++f) {
    progress.step();
    if (f > 0) {
      take.curves.apply(take.time(f), face);
      const auto started = std::chrono::steady_clock::now();
      if (!face.step(1.0 / take.frames_per_second)) ++figures.resets;
      milliseconds.push_back(
          std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - started).count());
    }
    visit(f);
  }
  if (!milliseconds.empty()) {
    const auto middle = milliseconds.begin() + static_cast<std::ptrdiff_t>(milliseconds.size() / 2);
    std::nth_element(milliseconds.begin(), middle, milliseconds.end());
    figures.milliseconds_a_frame = static_cast<double>(*middle);
  }
  return figures;
}

}  // namespace fascia::cli
