#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::batch {

/// A Slurm job array that builds heads.
struct SlurmJob {
  std::filesystem::path tool, source, output;  ///< absolute
  size_t tasks = 1;                            ///< of the array
  size_t most_at_once = 0;                     ///< 0: as many as the cluster gives
  size_t jobs = 1;                             ///< heads at a time in each task
  size_t megabytes = 4096;                     ///< of a head
  std::string time = "04:00:00";               ///< of a task, as Slurm writes it
  std::string partition;                       ///< empty: the cluster's own
  std::vector<std::string> options;            ///< more of `fascia batch`
};

/// A task's time limit as Slurm writes it: what its work may take at most, in seconds, but from 10 minutes to
/// 4 hours. A longer one than the partition allows would keep the job waiting for ever, without a word.
std::string slurm_time(double most_seconds);

/// The script for `sbatch`: one task a share of the heads; a task that is killed is queued again and takes up
/// where it was.
std::string slurm_script(const SlurmJob& job);

/// `text` as one word of a shell.
std::string shell_word(const std::string& text);

}  // namespace fascia::batch
