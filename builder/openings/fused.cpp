#include "builder/openings/fused.h"

#include "builder/spatial/way_between.h"

namespace fascia::openings {

bool is_fused(const TriangleMesh& mesh, const Connectivity& links, const spatial::SurfaceQuery& surface,
              const MeetingLine& line) {
  const double width = 2.0 * line.half_width, off = 0.1 * width, limit = 0.6 * width;
  int closed = 0, asked = 0;
  bool is_middle_open = false;
  for (const double along : {-0.3, -0.15, 0.0, 0.15, 0.3}) {
    const auto above = surface.first_hit(line.place(along, off, width), -line.axes.col(2), 2.0 * width),
               below = surface.first_hit(line.place(along, -off, width), -line.axes.col(2), 2.0 * width);
    if (!above || !below) continue;
    ++asked;
    // Lips and closed lids bulge before their corners; behind them lies what shows through an opening.
    const double front = std::min((above->position - line.origin).dot(line.axes.col(2)),
                                  (below->position - line.origin).dot(line.axes.col(2)));
    if (front < -0.05 * width) continue;
    const bool is_closed = spatial::way_between(mesh, links, *above, *below, limit) < 0.55 * width;
    closed += is_closed ? 1 : 0;
    // A slit narrower than the line, as where the corners were placed too far out: near its ends the way
    // around them is short.
    is_middle_open = is_middle_open || (along == 0.0 && !is_closed);
  }
  return asked > 0 && 2 * closed > asked && !is_middle_open;
}

}  // namespace fascia::openings
