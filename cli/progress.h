#pragma once

#include <chrono>
#include <string>

#include "cli/common.h"

namespace fascia::cli {

/// One line on stderr that says how far a long job is and how long it will still take; only when that is a
/// terminal and nobody asked for quiet. It is wiped when the job ends.
class Progress {
 public:
  Progress(const Common& common, std::string what, size_t steps);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// One of the steps begins.
  void step();

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  size_t steps_ = 0, done_ = 0;
  bool is_shown_ = false;
  Clock::time_point started_, said_;
};

}  // namespace fascia::cli
