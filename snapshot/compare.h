#pragma once

#include <string>
#include <vector>

#include "snapshot/snapshot.h"

namespace fascia::snapshot {

/// How far a region lies from where it lay in one state.
struct Difference {
  size_t state = 0, region = 0;
  double mean_mm = 0.0;     ///< root mean square over the region's watched vertices
  double largest_mm = 0.0;  ///< of the vertex that is farthest off
  Vertex vertex;            ///< that vertex
  bool ok = true;
};

struct Comparison {
  std::vector<Difference> differences;  ///< by state, then by region
  size_t failed = 0;
  bool is_same_rig = true;  ///< the very file that was recorded

  std::vector<Difference> worst(size_t count) const;  ///< those that fail first, largest first
};

/// A vertex may be off by so many times what its region may be on average.
inline constexpr double largest_share = 4.0;

/// Compares two snapshots of the same regions, poses and takes. A region fails in a state when the root mean
/// square of its vertices' differences is above its tolerance (that of `then`, or `tolerance_mm` when that is
/// above 0), or one vertex is off by more than `largest_share` times as much. Throws fascia::Error when they
/// do not have the same regions and states.
Comparison compare(const Snapshot& then, const Snapshot& now, double tolerance_mm = 0.0);

/// What is left of a difference below which nothing is said: half a quantum along each axis of both.
double noise_mm(const Snapshot& snapshot);

}  // namespace fascia::snapshot
