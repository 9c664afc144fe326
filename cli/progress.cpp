#include "cli/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace fascia::cli {

Progress::Progress(const Common& common, std::string what, size_t steps)
    : what_(std::move(what)),
      steps_(steps),
      is_shown_(!common.quiet && isatty(fileno(stderr)) != 0),
      started_(Clock::now()),
      said_(started_) {}

Progress::~Progress() {
  if (is_shown_) std::fputs("\r\033[K", stderr);
}

void Progress::step() {
  ++done_;
  if (!is_shown_) return;
  const auto now = Clock::now();
  if (done_ > 1 && done_ < steps_ && now - said_ < std::chrono::milliseconds(200)) return;
  said_ = now;
  const double passed = std::chrono::duration<double>(now - started_).count();
  const double left = passed / static_cast<double>(done_) * static_cast<double>(steps_ - done_);
  std::fprintf(stderr, "\r  %s %zu of %zu, %.0f s left\033[K", what_.c_str(), done_, steps_, std::ceil(left));
}

}  // namespace fascia::cli
