#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rig/model/rig.h"

namespace fascia::rig {

/// All muscles of a rig with their lists laid end to end, as a file keeps them: a handful of long
/// accessors instead of ten short ones a muscle.
///
/// Muscle `m` has the fibres `fibres[m] .. fibres[m+1]`, fibre `f` the points `fibre_points[f] ..
/// fibre_points[f+1]`, the regions likewise.
struct MuscleTable {
  std::vector<Muscle> heads;             ///< each without its lists
  std::vector<uint32_t> fibres;          ///< #muscles + 1
  std::vector<uint32_t> fibre_points;    ///< #fibres + 1
  std::vector<Vec3f> points;             ///< #points
  std::vector<uint32_t> triangles;       ///< #points
  std::vector<Vec3f> barycentrics;       ///< #points
  std::vector<float> offsets;            ///< #points
  std::vector<uint32_t> origin_regions;  ///< #muscles + 1
  std::vector<Vec3f> origin_points;
  std::vector<uint32_t> insertion_regions;  ///< #muscles + 1
  std::vector<Vec3f> insertion_points;
};

/// Where the last run of an offset list ends: 0 of an empty list.
inline std::size_t run_end(const std::vector<uint32_t>& offsets) {
  return offsets.empty() ? 0 : offsets.back();
}

/// Lays the lists of `muscles` end to end. Throws fascia::Error when a muscle's lists disagree in length.
MuscleTable pack_muscles(const std::vector<Muscle>& muscles);

/// The muscles again; the table's offsets must have been checked.
std::vector<Muscle> unpack_muscles(MuscleTable table);

}  // namespace fascia::rig
