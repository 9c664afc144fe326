#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::fit {

/// The mark-up of a detector: which of its points show which landmarks.
struct LandmarkSet {
  std::string name;   ///< ibug68, mediapipe478
  size_t points = 0;  ///< a face
  struct Entry {
    std::string landmark;          ///< its name in the rig
    std::vector<uint32_t> points;  ///< whose middle it is
  };
  std::vector<Entry> entries;
};

/// All that are known (anatomy/data/landmark_sets.json, compiled in), read anew: nothing of it stays in
/// memory that may be a host's.
std::vector<LandmarkSet> landmark_sets();

/// The one of a name, if there is one.
std::optional<LandmarkSet> find_landmark_set(std::string_view name);

}  // namespace fascia::fit
