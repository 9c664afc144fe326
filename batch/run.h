#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "batch/process.h"
#include "batch/record.h"

namespace fascia::batch {

struct Options {
  std::filesystem::path tool;    ///< the `fascia` program
  std::string version;           ///< of the tool: another one builds everything anew
  std::filesystem::path output;  ///< folder that gets one folder a head; it must be there
  size_t jobs = 1;               ///< heads at a time
  size_t threads = 1;            ///< of each
  Limits limits;                 ///< of each step of each head
  int attempts = 2;              ///< for heads that end by a signal or an internal error
  bool has_checks = true;        ///< run `fascia check` on each rig
  bool has_thumbnails = true;    ///< draw each head smiling
  bool retries_failed = false;   ///< heads that failed before, too
};

/// Outcome of a head in this run.
enum class Fate {
  done,      ///< built now
  failed,    ///< tried now, failed
  kept,      ///< done or failed before, with the same files and options
  elsewhere  ///< another process is at it
};

struct Report {
  std::vector<Record> records;  ///< in the order of the heads; empty ids where another process is at it
  std::vector<Fate> fates;
};

/// Builds the heads in processes of their own, `jobs` at a time. Each head's results appear atomically in
/// `output`/ID: rig.glb, build.json, check.json, thumbnail.png and job.json; of a failure job.json alone. A
/// head whose results are there and whose files, options and tool are the same is not built again, unless the
/// machine was what failed (is_of_the_machine). Several of
/// these may run into one folder, also on several machines where they share its locks (flock): each head is
/// built by one. `told` is called as each head ends, one at a time. When `stop` becomes true what runs is
/// ended and nothing of it stays. Throws fascia::Error when nothing can be written, or when `output`/ID is
/// something that may not be replaced (why_not_replaced).
Report run_all(const std::vector<Head>& heads, const Options& options, const std::atomic<bool>& stop,
               const std::function<void(size_t head, const Record& record, Fate fate)>& told);

}  // namespace fascia::batch
