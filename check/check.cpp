#include "check/check.h"

#include <algorithm>
#include <cmath>

#include "check/examination.h"

namespace fascia::check {

int failed(const std::vector<Row>& rows) {
  return static_cast<int>(std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.ok; }));
}

std::vector<Row> run(const Head& head, const Player& player, const anatomy::Checks& checks,
                     const Options& options) {
  Examination examination(head, checks, options.is_quick);
  examination.rest(options.rest_motion);
  std::vector<const anatomy::CheckPose*> poses;
  for (const anatomy::CheckPose& pose : checks.poses)
    if (!options.is_quick || pose.is_quick) poses.push_back(&pose);
  // All at a time, unless that takes much memory: a shape has every vertex of the head.
  constexpr size_t most_vertices = 20'000'000;
  size_t vertices = 1;
  for (const Part& part : head.parts)
    vertices += part.mesh.vertices.size();
  const size_t at_a_time = std::max<size_t>(4, most_vertices / vertices);
  for (size_t first = 0; first < poses.size(); first += at_a_time) {
    std::vector<std::optional<Shape>> shapes(std::min(at_a_time, poses.size() - first));
    run_each(options.for_each, shapes.size(),
             [&](size_t k) { shapes[k] = player(poses[first + k]->weights); });
    for (size_t k = 0; k < shapes.size(); ++k)
      if (shapes[k]) examination.pose(*poses[first + k], *shapes[k]);
  }
  return examination.rows();
}

}  // namespace fascia::check
