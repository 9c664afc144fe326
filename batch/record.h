#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::batch {

inline constexpr const char* record_name = "job.json";

/// The result of one head, stored as job.json in its folder.
struct Record {
  std::string id, head;    ///< head: the mesh's path as it was given
  std::string key;         ///< key_of the head: what the results depend on
  bool is_done = false;    ///< there is a rig
  std::string cause;       ///< category of a failure; empty if done
  std::string message;     ///< message of the tool
  bool is_lasting = true;  ///< false: the machine failed, not the head; the next run tries it again
  int attempts = 0;
  double seconds = 0.0;  ///< wall time of all steps, last attempt
  double cpu_seconds = 0.0;
  double megabytes = 0.0;  ///< largest resident memory of any step
  size_t rig_bytes = 0;
  std::vector<std::string> failed_checks;  ///< names of rows of `fascia check`
  int checks = -1;                         ///< rows in all; -1: not checked
  std::vector<std::string> warnings;       ///< of the build
};

/// Reads and writes `folder`/job.json; a missing or invalid record is empty. Writing is atomic.
bool read_record(const std::filesystem::path& folder, Record& record);
void write_record(const std::filesystem::path& folder, const Record& record);

/// Every record below `output`, by id.
std::vector<Record> all_records(const std::filesystem::path& output);

}  // namespace fascia::batch
