#include <algorithm>
#include <cmath>

#include "fit/fit.h"

namespace fascia::fit {

void Misses::add(double left, double moved, double confidence) {
  constexpr double moves = 5e-4;  // metres
  left_ += confidence * left * left;
  whole_ += confidence * moved * moved;
  confidence_ += confidence;
  miss_ += left;
  ++count_;
  if (moved > moves) {
    miss_moved_ += left;
    ++count_moved_;
  }
}

void Misses::write(FitResult& result) const {
  result.share = whole_ > 0.0 ? 1.0 - left_ / whole_ : left_ > 0.0 ? 0.0 : 1.0;
  result.rms_mm = confidence_ > 0.0 ? 1e3 * std::sqrt(left_ / confidence_) : 0.0;
  result.error_mm = 1e3 * (count_moved_ > 0 ? miss_moved_ / static_cast<double>(count_moved_)
                                            : miss_ / static_cast<double>(std::max<size_t>(1, count_)));
}

}  // namespace fascia::fit
