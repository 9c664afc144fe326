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
  for (const anatomy::CheckPose& pose : checks.poses) {
    if (options.is_quick && !pose.is_quick) continue;
    const std::optional<Shape> shape = player(pose.weights);
    if (shape) examination.pose(pose, *shape);
  }
  return examination.rows();
}

}  // namespace fascia::check
