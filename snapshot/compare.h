#pragma once

#include <string>
#include <vector>

#include "snapshot/snapshot.h"

namespace fascia::snapshot {

/// Difference of a region from the recording in one state.
struct Difference {
  size_t state = 0, region = 0;
  double mean_mm = 0.0;     ///< root mean square over the region's watched vertices
  double largest_mm = 0.0;  ///< of the vertex with the largest difference
  Vertex vertex;            ///< that vertex
  bool ok = true;
};

struct Comparison {
  std::vector<Difference> differences;  ///< by state, then by region
  size_t failed = 0;
  bool is_same_rig = true;  ///< the rig file is identical to the recorded one

  std::vector<Difference> worst(size_t count) const;  ///< those that fail first, largest first
};

/// Tolerance of a single vertex, relative to that of its region.
inline constexpr double largest_share = 4.0;

/// Compares two snapshots of the same regions, poses and takes. A region fails in a state when the root mean
/// square of its vertices' differences is above its tolerance (that of `then`, or `tolerance_mm` when that is
/// above 0), or one vertex exceeds `largest_share` times the tolerance. Throws fascia::Error when they do not
/// have the same regions and states.
Comparison compare(const Snapshot& then, const Snapshot& now, double tolerance_mm = 0.0);

/// Differences below this are ignored: half a quantum along each axis of both.
double noise_mm(const Snapshot& snapshot);

}  // namespace fascia::snapshot
