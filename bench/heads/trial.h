#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::bench {

/// What became of one head.
struct Trial {
  std::string name, kind;            ///< kind: wild, people, own
  std::string outcome;               ///< built, refused, crashed or timed out
  std::string reason;                ///< what the tool said when it was not built
  std::vector<std::string> failing;  ///< rows of the check that fail
  int rows = 0;                      ///< of the check
  double seconds = 0.0;              ///< of the build, by the clock
  double megabytes = 0.0;            ///< of the rig file
  int warnings = 0;                  ///< of the build
};

/// Builds and checks `head` with the tool as a user would, each in a process of its own that is stopped after
/// `limit` seconds. `detail`: finest level of the lattice, at which it is checked. The rig is written into
/// `folder` and removed again; the check's sheet goes to `sheet` when that is not empty.
Trial try_head(const std::string& name, const std::string& kind, const std::filesystem::path& head,
               const std::string& detail, const std::filesystem::path& folder,
               const std::filesystem::path& sheet, int limit = 300);

}  // namespace fascia::bench
