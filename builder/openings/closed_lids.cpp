#include "builder/openings/closed_lids.h"

namespace fascia::openings {

namespace {

// Radians, in the mean along the line: less cannot be seen. Over an eyeball of the head's own closed lids lie
// smooth; the step beside an open one bends by 1 and more.
constexpr double least_bend = 0.12, most_bend_over_eyeball = 0.75;
// The crease of a closed upper lid over the valley where the lids meet: 0.22 with the generic head's lids
// drawn down; 0.5 to 1.6 under the upper lid of open eyes in one piece with their lids (scans, statues).
constexpr double crease_share = 0.3;

/// The valley where an open eye's upper lid would end, a fissure's height (10 mm of 29, Farkas 1994) above
/// `line`.
MeetingLine upper_valley(const spatial::SurfaceQuery& skin, const MeetingLine& line, const FaceAxes& face) {
  LineSearch search;
  search.reach = 0.15;
  const Vec3 right = line.origin - line.half_width * line.axes.col(0),
             left = line.origin + line.half_width * line.axes.col(0);
  return find_line(
      skin, right, left, face,
      [&](double along) {
        return line.height(along) / (2.0 * line.half_width) + 0.33 * (1.0 - along * along);
      },
      search);
}

}  // namespace

bool eyeball_shows(const prepare::Eyeball& ball, const spatial::SurfaceQuery& skin, const MeetingLine& line) {
  const double before = 2.0 * line.half_width;
  int before_skin = 0, asked = 0;
  for (const double along : {-0.3, 0.0, 0.3})
    for (const double up : {0.0, 0.1, 0.2}) {
      const auto hit =
          skin.first_hit(line.place(along, 2.0 * up * line.half_width, before), -line.axes.col(2));
      ++asked;
      before_skin += !hit || (hit->position - ball.centre).norm() < 0.98 * ball.radius ? 1 : 0;
    }
  return 2 * before_skin > asked;
}

std::optional<std::string> doubt_of_closed_lids(const spatial::SurfaceQuery& skin, const MeetingLine& line,
                                                const FaceAxes& face, bool has_eyeball) {
  if (line.clearness < least_bend) return "there is no furrow where the lids would meet";
  if (has_eyeball && line.clearness > most_bend_over_eyeball)
    return "the furrow is deeper than that of closed lids";
  if (upper_valley(skin, line, face).clearness > crease_share * line.clearness)
    return "there is a second furrow above it, as under the upper lid of an open eye";
  return std::nullopt;
}

}  // namespace fascia::openings
