#include "builder/landmarks/lid_opening.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::landmarks {

namespace {

constexpr int half_columns = 38, half_rows = 22;
constexpr int columns = 2 * half_columns + 1, rows = 2 * half_rows + 1;

/// A grid of lines of sight on the eye; lengths as shares of the distance between its corners.
struct Sight {
  Vec3 origin, x, y, z;  ///< x toward the outer corner, y up, z to the viewer
  double width, cell;
  Vec3 at(double column, double row, double depth) const {
    return origin + (column - half_columns) * cell * x + (row - half_rows) * cell * y + depth * z;
  }
};

Sight sight_on(const EyeRegion& eye) {
  Sight sight;
  sight.width = (eye.outer - eye.inner).norm();
  sight.x = (eye.outer - eye.inner) / sight.width;
  sight.z = (eye.forward - eye.forward.dot(sight.x) * sight.x).normalized();
  sight.y = sight.z.cross(sight.x);
  if (sight.y.dot(eye.up) < 0.0) sight.y = -sight.y;
  sight.origin = 0.5 * (eye.outer + eye.inner);
  sight.cell = sight.width / 46.0;
  return sight;
}

/// Cells where the lids do not cover the ball.
std::vector<bool> open_cells(const spatial::SurfaceQuery& skin, const EyeRegion& eye, const Sight& sight) {
  const Vec3 centre = eye.ball.centre - sight.origin;
  const double cu = centre.dot(sight.x), cv = centre.dot(sight.y), cz = centre.dot(sight.z),
               r = eye.ball.radius;
  // The ball alone does not reach the corners; the tissue there goes on about as it does.
  const double stretch = std::max(r, 0.66 * sight.width);
  const double reach = 0.8 * sight.width, behind = eye.depth * sight.width;
  std::vector<bool> open(static_cast<size_t>(columns * rows), false);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double u = ((column - half_columns) * sight.cell - cu) / stretch,
                   v = ((row - half_rows) * sight.cell - cv) / r;
      if (u * u + v * v >= 0.98) continue;
      const double surface = cz + r * std::sqrt(1.0 - u * u - v * v);
      open[static_cast<size_t>(row * columns + column)] =
          !skin.blocked(sight.at(column, row, reach), -sight.z, reach - surface + behind);
    }
  return open;
}

/// The connected open cells about the middle; empty when there are none or they run out of the grid.
std::vector<int> opening_cells(const std::vector<bool>& open) {
  int seed = -1;
  double nearest = 1e300;
  for (int i = 0; i < columns * rows; ++i) {
    const double du = i % columns - half_columns, dv = i / columns - half_rows;
    if (open[static_cast<size_t>(i)] && std::abs(du) < 8 && std::abs(dv) < 10 &&
        du * du + dv * dv < nearest) {
      nearest = du * du + dv * dv;
      seed = i;
    }
  }
  std::vector<int> cells;
  if (seed < 0) return cells;
  std::vector<bool> seen(open.size(), false);
  cells.push_back(seed);
  seen[static_cast<size_t>(seed)] = true;
  for (size_t next = 0; next < cells.size(); ++next) {
    const int column = cells[next] % columns, row = cells[next] / columns;
    if (column == 0 || column == columns - 1 || row == 0 || row == rows - 1) return {};
    for (int other : {cells[next] - 1, cells[next] + 1, cells[next] - columns, cells[next] + columns})
      if (open[static_cast<size_t>(other)] && !seen[static_cast<size_t>(other)]) {
        seen[static_cast<size_t>(other)] = true;
        cells.push_back(other);
      }
  }
  return cells;
}

/// The skin one cell beyond the extreme open ones in direction (du, dv).
Vec3 rim_point(const spatial::SurfaceQuery& skin, const Sight& sight, const std::vector<int>& cells, int du,
               int dv) {
  int best = -10000;
  for (int i : cells)
    best = std::max(best, (i % columns) * du + (i / columns) * dv);
  double column = 0.0, row = 0.0, count = 0.0;
  for (int i : cells)
    if ((i % columns) * du + (i / columns) * dv == best) {
      column += i % columns;
      row += i / columns;
      count += 1.0;
    }
  column = column / count + du;
  row = row / count + dv;
  const double reach = 0.8 * sight.width;
  const auto hit = skin.first_hit(sight.at(column, row, reach), -sight.z, 1.6 * sight.width);
  return hit ? hit->position : sight.at(column, row, 0.0);
}

}  // namespace

std::optional<LidOpening> lid_opening(const spatial::SurfaceQuery& skin, const EyeRegion& eye) {
  const Sight sight = sight_on(eye);
  if (!(sight.width > 0.0) || !(eye.ball.radius > 0.0)) return std::nullopt;
  const std::vector<int> cells = opening_cells(open_cells(skin, eye, sight));
  if (cells.size() < 40) return std::nullopt;
  const LidOpening opening = {rim_point(skin, sight, cells, 1, 0), rim_point(skin, sight, cells, -1, 0),
                              rim_point(skin, sight, cells, 0, 1), rim_point(skin, sight, cells, 0, -1)};
  const double width = (opening.outer - opening.inner).dot(sight.x),
               height = (opening.upper - opening.lower).dot(sight.y);
  const bool is_eye = width > 0.6 * sight.width && width < 1.4 * sight.width && height > 0.06 * sight.width &&
                      height < 0.75 * sight.width;
  const bool is_about =
      std::abs((0.5 * (opening.outer + opening.inner) - sight.origin).dot(sight.x)) < 0.25 * sight.width;
  return is_eye && is_about ? std::optional(opening) : std::nullopt;
}

}  // namespace fascia::landmarks
