#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// How `fascia view` was called.
struct ApplicationOptions {
  std::vector<std::filesystem::path> files;  ///< to open, as if dropped
  std::filesystem::path script;              ///< drives the window; empty: a hand does
  bool is_real_time = false;                 ///< a script runs by the clock and draws what a user would see
  std::filesystem::path state;               ///< folder to remember things in; empty: state_folder()
  std::optional<uint64_t> monkey;            ///< seed of random input
  double monkey_seconds = 60.0;
  double scale = 0.0;  ///< of text and widgets; 0: as the display says
};

struct ApplicationReport {
  uint64_t frames = 0;
  double longest_frame_ms = 0.0;  ///< of the window's thread, what was drawn included
  double median_frame_ms = 0.0;
  double longest_update_ms = 0.0;  ///< of that what takes in and orders work
  std::vector<std::string> files;  ///< that a script wrote
};

/// Opens the window and returns when it is closed, or when the script has ended. Throws fascia::Error when
/// there is no display, or when a step of the script cannot be done (its line is named).
ApplicationReport run_application(const ApplicationOptions& options);

}  // namespace fascia::app
