#include "snapshot/snapshot.h"

#include <cstdio>

namespace fascia::snapshot {

size_t Snapshot::first_vertex(size_t region) const {
  size_t first = 0;
  for (size_t r = 0; r < region; ++r)
    first += regions[r].vertices.size();
  return first;
}

size_t Snapshot::vertex_count() const {
  return first_vertex(regions.size());
}

std::vector<std::string> state_names(const Snapshot& snapshot) {
  std::vector<std::string> names = {"rest"};
  for (const Pose& pose : snapshot.poses)
    names.push_back(pose.name);
  for (const Take& take : snapshot.takes)
    for (const uint32_t frame : take.frames) {
      char time[32];
      std::snprintf(time, sizeof time, " at %.3f s", frame / take.frames_per_second);
      names.push_back(take.name + time);
    }
  return names;
}

}  // namespace fascia::snapshot
