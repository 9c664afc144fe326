#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "cli/common.h"

namespace fascia::cli {

/// One part of a job.
struct Stage {
  std::string name;
  double share = 1.0;  ///< of the job's time, in any unit: only ratios count
};

/// How far a job is, on one line of stderr that is wiped when it ends: stage, percent, time left. Shown only
/// when that is a terminal and nobody asked for quiet. A job begun while another runs is a part of the
/// other's present stage: the line gives the percent and the time left of the whole.
class Progress {
 public:
  /// A job of stages that take different times. A stage that is not listed begins no new part.
  Progress(const Common& common, std::string job, std::vector<Stage> stages);
  /// A job of `steps` steps that take about the same time.
  Progress(const Common& common, std::string job, size_t steps);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// The stage of this name begins, and those before it are done.
  void begin(const std::string& stage);
  /// One of the steps begins.
  void step();
  /// The job that is being done, within others perhaps; null when none is. Jobs are told of by one thread.
  static Progress* innermost();

  /// Takes the line away, so that something else can be written; the next stage or step brings it back.
  void wipe() const;

 private:
  using Clock = std::chrono::steady_clock;

  void show(bool is_due);

  Progress* outer_ = nullptr;
  std::string job_, stage_;
  std::vector<Stage> stages_;
  size_t steps_ = 0, step_ = 0;
  double done_ = 0.0, current_ = 0.0;  ///< of the whole job: before the present stage, and in it
  bool is_shown_ = false;
  Clock::time_point started_, said_;
};

/// "build: tissue  62 %, 3 s left" for a job that is done to a share in so many seconds. The time left is
/// left out while too little is done to tell.
std::string progress_line(const std::string& what, double done, double seconds);

}  // namespace fascia::cli
