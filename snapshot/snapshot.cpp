#include "snapshot/snapshot.h"

#include <cstdio>

#include "geometry/error.h"

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

void check_size(size_t vertices, size_t states) {
  constexpr size_t most_vertices = 1'000'000, most_places = 20'000'000;
  if (vertices > most_vertices) throw Error("its regions watch more than a million vertices: watch fewer");
  if (states > most_places || vertices * states > most_places)
    throw Error(std::to_string(vertices) + " watched vertices in " + std::to_string(states) +
                " poses and frames are more than twenty million places: watch fewer, or split the poses");
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
