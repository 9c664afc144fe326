#include "rig/model/muscle_table.h"

#include "geometry/error.h"

namespace fascia::rig {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <class T>
std::vector<T> slice(const std::vector<T>& list, std::size_t first, std::size_t last) {
  return {list.begin() + static_cast<std::ptrdiff_t>(first),
          list.begin() + static_cast<std::ptrdiff_t>(last)};
}

Muscle head_of(const Muscle& muscle) {
  Muscle head;
  head.name = muscle.name;
  head.group = muscle.group;
  head.kind = muscle.kind;
  head.origin = muscle.origin;
  head.insertion = muscle.insertion;
  head.strength = muscle.strength;
  head.peak_shortening = muscle.peak_shortening;
  return head;
}

void check(const Muscle& muscle) {
  const std::size_t points = muscle.points.size();
  if (run_end(muscle.fibre_offsets) != points || muscle.triangles.size() != points ||
      muscle.barycentrics.size() != points || muscle.offsets.size() != points)
    throw Error("muscle " + muscle.name + ": its point lists or fibre offsets disagree in length");
}

}  // namespace

MuscleTable pack_muscles(const std::vector<Muscle>& muscles) {
  MuscleTable table;
  table.fibres.push_back(0);
  table.fibre_points.push_back(0);
  table.origin_regions.push_back(0);
  table.insertion_regions.push_back(0);
  for (const Muscle& muscle : muscles) {
    check(muscle);
    table.heads.push_back(head_of(muscle));
    const uint32_t first_point = table.fibre_points.back();
    for (std::size_t f = 1; f < muscle.fibre_offsets.size(); ++f)
      table.fibre_points.push_back(first_point + muscle.fibre_offsets[f]);
    table.fibres.push_back(static_cast<uint32_t>(table.fibre_points.size() - 1));
    append(table.points, muscle.points);
    append(table.triangles, muscle.triangles);
    append(table.barycentrics, muscle.barycentrics);
    append(table.offsets, muscle.offsets);
    append(table.origin_points, muscle.origin_region);
    append(table.insertion_points, muscle.insertion_region);
    table.origin_regions.push_back(static_cast<uint32_t>(table.origin_points.size()));
    table.insertion_regions.push_back(static_cast<uint32_t>(table.insertion_points.size()));
  }
  return table;
}

std::vector<Muscle> unpack_muscles(MuscleTable table) {
  std::vector<Muscle> muscles = std::move(table.heads);
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    Muscle& muscle = muscles[m];
    const std::size_t first = table.fibres[m], last = table.fibres[m + 1];
    const uint32_t point = table.fibre_points[first], end = table.fibre_points[last];
    muscle.fibre_offsets = slice(table.fibre_points, first, last + 1);
    for (uint32_t& offset : muscle.fibre_offsets)
      offset -= point;
    muscle.points = slice(table.points, point, end);
    muscle.triangles = slice(table.triangles, point, end);
    muscle.barycentrics = slice(table.barycentrics, point, end);
    muscle.offsets = slice(table.offsets, point, end);
    muscle.origin_region = slice(table.origin_points, table.origin_regions[m], table.origin_regions[m + 1]);
    muscle.insertion_region =
        slice(table.insertion_points, table.insertion_regions[m], table.insertion_regions[m + 1]);
  }
  return muscles;
}

}  // namespace fascia::rig
