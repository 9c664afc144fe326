#include "snapshot/compare.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::snapshot {

namespace {

void check_comparable(const Snapshot& then, const Snapshot& now) {
  if (then.quantum_mm != now.quantum_mm)
    throw Error("the snapshots are of different precision: record one of them anew");
  if (then.states.size() != now.states.size() || then.regions.size() != now.regions.size())
    throw Error("the snapshots are of different poses, takes or regions: record one of them anew");
  for (size_t s = 0; s < then.states.size(); ++s)
    if (then.states[s].name != now.states[s].name)
      throw Error("the snapshots differ in what they show: '" + then.states[s].name + "' and '" +
                  now.states[s].name + "'");
  for (size_t r = 0; r < then.regions.size(); ++r)
    if (then.regions[r].vertices != now.regions[r].vertices || then.regions[r].name != now.regions[r].name)
      throw Error("the snapshots watch different vertices in region '" + then.regions[r].name + "'");
}

}  // namespace

double noise_mm(const Snapshot& snapshot) {
  return std::sqrt(3.0) * snapshot.quantum_mm;
}

Comparison compare(const Snapshot& then, const Snapshot& now, double tolerance_mm) {
  check_comparable(then, now);
  Comparison comparison;
  comparison.is_same_rig = then.rig == now.rig;
  for (size_t s = 0; s < then.states.size(); ++s) {
    size_t at = 0;
    for (size_t r = 0; r < then.regions.size(); ++r) {
      const Region& region = then.regions[r];
      Difference difference{s, r, 0.0, 0.0, region.vertices.empty() ? Vertex{} : region.vertices[0], true};
      double sum = 0.0;
      for (const Vertex& vertex : region.vertices) {
        double squared = 0.0;
        for (int k = 0; k < 3; ++k, ++at) {
          const int64_t quanta = int64_t{then.states[s].quanta[at]} - now.states[s].quanta[at];
          const double step = then.quantum_mm * static_cast<double>(quanta);
          squared += step * step;
        }
        sum += squared;
        if (std::sqrt(squared) > difference.largest_mm) {
          difference.largest_mm = std::sqrt(squared);
          difference.vertex = vertex;
        }
      }
      if (!region.vertices.empty()) difference.mean_mm = std::sqrt(sum / double(region.vertices.size()));
      const double allowed = tolerance_mm > 0.0 ? tolerance_mm : region.tolerance_mm;
      difference.ok = difference.mean_mm <= allowed && difference.largest_mm <= largest_share * allowed;
      comparison.failed += !difference.ok;
      comparison.differences.push_back(difference);
    }
  }
  return comparison;
}

std::vector<Difference> Comparison::worst(size_t count) const {
  std::vector<Difference> list = differences;
  std::stable_sort(list.begin(), list.end(), [](const Difference& a, const Difference& b) {
    return a.ok != b.ok ? b.ok : a.mean_mm > b.mean_mm;
  });
  list.resize(std::min(count, list.size()));
  return list;
}

}  // namespace fascia::snapshot
