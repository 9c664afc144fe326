#include "cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fascia::cli {

namespace {

/// The terminal has one line for it, so there is one.
Progress* innermost_job = nullptr;

}  // namespace

Progress* Progress::innermost() {
  return innermost_job;
}

std::string progress_line(const std::string& what, double done, double seconds) {
  char percent[32];
  std::snprintf(percent, sizeof percent, "  %.0f %%", std::floor(100.0 * std::clamp(done, 0.0, 1.0)));
  std::string line = what + percent;
  if (done < 0.02 || seconds < 0.3) return line;
  const double left = std::ceil(std::max(0.0, seconds / done * (1.0 - done)));
  char text[48];
  if (left < 100.0)
    std::snprintf(text, sizeof text, ", %.0f s left", left);
  else
    std::snprintf(text, sizeof text, ", %.0f min left", std::ceil(left / 60.0));
  return line + text;
}

Progress::Progress(const Common& common, std::string job, std::vector<Stage> stages)
    : outer_(innermost_job),
      job_(std::move(job)),
      stages_(std::move(stages)),
      is_shown_(!common.quiet && isatty(fileno(stderr)) != 0),
      started_(Clock::now()) {
  double whole = 0.0;
  for (const Stage& stage : stages_)
    whole += stage.share;
  for (Stage& stage : stages_)
    stage.share /= whole;
  innermost_job = this;
}

Progress::Progress(const Common& common, std::string job, size_t steps)
    : Progress(common, std::move(job), std::vector<Stage>()) {
  steps_ = std::max<size_t>(steps, 1);
}

Progress::~Progress() {
  wipe();
  innermost_job = outer_;
}

void Progress::begin(const std::string& stage) {
  double before = 0.0;
  for (const Stage& known : stages_) {
    if (known.name == stage) {
      current_ = known.share;
      stage_ = stage;
      done_ = before;
      show(true);
      return;
    }
    before += known.share;
  }
}

void Progress::step() {
  current_ = 1.0 / static_cast<double>(steps_);
  done_ = static_cast<double>(std::min(step_, steps_)) * current_;
  ++step_;
  stage_ = std::to_string(step_) + " of " + std::to_string(steps_);
  show(step_ == 1 || step_ >= steps_);
}

void Progress::wipe() const {
  if (is_shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(bool is_due) {
  if (!is_shown_) return;
  const auto now = Clock::now();
  if (!is_due && now - said_ < std::chrono::milliseconds(200)) return;
  said_ = now;
  double done = done_;
  std::string what = job_ + (stage_.empty() ? "" : ": " + stage_);
  const Progress* whole = this;
  for (; whole->outer_; whole = whole->outer_) {
    done = whole->outer_->done_ + whole->outer_->current_ * done;
    what = whole->outer_->job_ + ", " + what;
  }
  const double seconds = std::chrono::duration<double>(now - whole->started_).count();
  std::fprintf(stderr, "\r  %s\033[K", progress_line(what, done, seconds).c_str());
}

}  // namespace fascia::cli
