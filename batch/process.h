#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace fascia::batch {

/// What a process may use.
struct Limits {
  double seconds = 300.0;   ///< of wall time; 0: any
  size_t megabytes = 4096;  ///< of address space; 0: any
};

/// How a process ended.
struct Outcome {
  int exit_code = -1;  ///< -1 when a signal ended it
  int signal = 0;
  bool is_late = false;  ///< it was ended at its limit of time
  double seconds = 0.0;  ///< wall time
  double cpu_seconds = 0.0;
  double megabytes = 0.0;  ///< largest resident memory
  std::string out, err;    ///< what it wrote, up to 8 MB each
};

/// Names of what `run` keeps in its folder of what a program writes, while it runs.
inline constexpr const char *output_name = "stdout.txt", *errors_name = "stderr.txt";

/// Runs a program and waits for its end, in a process of its own with those limits, standard input empty.
/// `scratch` is a folder for what it writes. When `stop` becomes true, or this process dies, the program is
/// ended. Throws fascia::Error when no process can be started.
Outcome run(const std::vector<std::string>& command, const Limits& limits,
            const std::filesystem::path& scratch, const std::atomic<bool>& stop);

}  // namespace fascia::batch
