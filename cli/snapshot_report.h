#pragma once

#include <filesystem>
#include <vector>

#include "snapshot/compare.h"

namespace fascia::cli {

/// Where a report gets its pictures from.
struct SnapshotReport {
  std::filesystem::path rig;
  std::vector<std::filesystem::path> curves;  ///< of the snapshot's takes, in order
  double tolerance_mm = 0.0;                  ///< 0: each region's own
};

/// A page that shows a comparison: the states that differ most, each as recorded, as it is now and as a heat
/// map side by side, and what differs by region. Where nothing can be drawn the page says so and why.
std::string snapshot_page(const SnapshotReport& report, const snapshot::Snapshot& then,
                          const snapshot::Snapshot& now, const snapshot::Comparison& comparison);

}  // namespace fascia::cli
