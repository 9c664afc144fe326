#include "builder/openings/line.h"
#include "geometry/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::openings {

namespace {

constexpr int columns = 49, half_rows = 24, rows = 2 * half_rows + 1;

/// How far the skin stands out at each place of a grid, metres; NaN where there is none.
struct DepthMap {
  std::vector<double> depths = std::vector<double>(static_cast<size_t>(columns * rows), std::nan(""));
  double row_step = 0.0;
  double& at(int column, int row) { return depths[static_cast<size_t>(row * columns + column)]; }
  double at(int column, int row) const { return depths[static_cast<size_t>(row * columns + column)]; }
};

double along_of(int column) {
  return 2.0 * column / (columns - 1.0) - 1.0;
}

DepthMap depth_map(const spatial::SurfaceQuery& skin, const MeetingLine& line,
                   const std::vector<double>& middle, double row_step) {
  DepthMap map;
  map.row_step = row_step;
  const double before = 1.2 * line.half_width;
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) {
      const double up = middle[static_cast<size_t>(column)] + (row - half_rows) * row_step;
      const Vec3 from = line.origin + line.axes * Vec3(along_of(column) * line.half_width, up, before);
      if (const auto hit = skin.first_hit(from, -line.axes.col(2), 2.4 * line.half_width))
        map.at(column, row) = before - hit->distance;
    }
  return map;
}

/// The angle by which the surface bends up towards the viewer at a place, over `reach` rows; 0 where unknown.
double bend(const DepthMap& map, int column, int row, int reach) {
  if (row - reach < 0 || row + reach >= rows) return 0.0;
  const double here = map.at(column, row), step = reach * map.row_step;
  const double below = std::atan2(map.at(column, row - reach) - here, step),
               above = std::atan2(map.at(column, row + reach) - here, step);
  return std::isfinite(below + above) ? std::clamp(below + above, -1.0, 1.6) : 0.0;
}

/// The row of each column on the best way through `gain` with the least jumps.
std::vector<int> best_way(const std::vector<double>& gain, double jump_cost) {
  std::vector<double> best(gain.size(), -1e300);
  std::vector<int> from(gain.size(), 0);
  const auto at = [](int column, int row) { return static_cast<size_t>(row * columns + column); };
  for (int row = 0; row < rows; ++row)
    best[at(0, row)] = gain[at(0, row)];
  for (int column = 1; column < columns; ++column)
    for (int row = 0; row < rows; ++row)
      for (int jump = -4; jump <= 4; ++jump) {
        const int last = row - jump;
        if (last < 0 || last >= rows) continue;
        const double value = best[at(column - 1, last)] - jump_cost * jump * jump + gain[at(column, row)];
        if (value > best[at(column, row)]) {
          best[at(column, row)] = value;
          from[at(column, row)] = last;
        }
      }
  std::vector<int> way(columns, 0);
  for (int row = 0; row < rows; ++row)
    if (best[at(columns - 1, row)] > best[at(columns - 1, way[columns - 1])]) way[columns - 1] = row;
  for (size_t column = columns - 1; column > 0; --column)
    way[column - 1] = from[at(static_cast<int>(column), way[column])];
  return way;
}

std::vector<double> mirrored(const std::vector<double>& gain) {
  std::vector<double> other(gain.size());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      other[static_cast<size_t>(row * columns + columns - 1 - column)] =
          gain[static_cast<size_t>(row * columns + column)];
  return other;
}

}  // namespace

FaceAxes face_axes(const anatomy::GenericAnatomy& anatomy, const Landmarks& landmarks) {
  std::vector<Vec3> generic, here;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (const auto at = landmarks.find(landmark.name); landmark.skin && at != landmarks.end()) {
      generic.push_back(*landmark.skin);
      here.push_back(at->second);
    }
  FaceAxes face;
  if (generic.size() < 4) return face;
  const Mat4 map = similarity(generic, here);
  face.scale = map.topLeftCorner<3, 1>().norm();
  if (face.scale > 0.0) face.rotation = map.topLeftCorner<3, 3>() / face.scale;
  return face;
}

double MeetingLine::along(const Vec3& p) const {
  return (p - origin).dot(axes.col(0)) / half_width;
}

double MeetingLine::height(double along) const {
  const double last = static_cast<double>(heights.size()) - 1.0;
  const double x = std::clamp(0.5 * (along + 1.0), 0.0, 1.0) * last;
  const auto k = std::min(static_cast<size_t>(x), heights.size() - 2);
  const double t = x - static_cast<double>(k);
  return (1.0 - t) * heights[k] + t * heights[k + 1];
}

double MeetingLine::above(const Vec3& p) const {
  return (p - origin).dot(axes.col(1)) - height(along(p));
}

Vec3 MeetingLine::place(double along, double up, double front) const {
  return origin + axes * Vec3(along * half_width, height(along) + up, front);
}

MeetingLine find_line(const spatial::SurfaceQuery& skin, const Vec3& right, const Vec3& left,
                      const FaceAxes& face, const std::function<double(double)>& expected,
                      const LineSearch& search) {
  MeetingLine line;
  const double width = (left - right).norm();
  line.origin = 0.5 * (left + right);
  line.half_width = 0.5 * width;
  line.axes.col(0) = (left - right) / width;
  const Vec3 front = face.rotation.col(2);
  line.axes.col(2) = (front - front.dot(line.axes.col(0)) * line.axes.col(0)).normalized();
  line.axes.col(1) = line.axes.col(2).cross(line.axes.col(0));

  std::vector<double> middle(columns);
  for (int column = 0; column < columns; ++column)
    middle[static_cast<size_t>(column)] = width * expected(along_of(column));
  const double step = search.reach * width / half_rows;
  const DepthMap map = depth_map(skin, line, middle, step);
  const int fine = std::max(1, static_cast<int>(std::lround(search.bend_scale * width / step)));
  std::vector<double> gain(static_cast<size_t>(columns * rows), 0.0);
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) {
      const double off = (row - half_rows) * step / (search.keep_scale * width);
      // At the corners only the expected line tells where it ends.
      const double held = search.keep * (1.0 + 8.0 * std::pow(std::abs(along_of(column)), 12.0));
      gain[static_cast<size_t>(row * columns + column)] =
          bend(map, column, row, fine) + 0.5 * bend(map, column, row, 2 * fine) - held * off * off;
    }
  const double column_step = width / (columns - 1.0);
  // Heights are relative to the expected line, so that following it has no slope cost. The search runs from
  // both corners, so that ties between equally good lines favour neither side.
  const double jump_cost = search.straight * (step / column_step) * (step / column_step);
  const std::vector<int> way = best_way(gain, jump_cost), back = best_way(mirrored(gain), jump_cost);
  line.heights.resize(columns);
  for (size_t column = 0; column < way.size(); ++column) {
    const double row = 0.5 * (way[column] + back[way.size() - 1 - column]);
    line.heights[column] = middle[column] + (row - half_rows) * step;
    line.clearness += bend(map, static_cast<int>(column), static_cast<int>(row), fine) / columns;
  }
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next = line.heights;
    for (size_t k = 1; k + 1 < next.size(); ++k)
      next[k] = 0.25 * (line.heights[k - 1] + 2.0 * line.heights[k] + line.heights[k + 1]);
    line.heights = std::move(next);
  }
  return line;
}

}  // namespace fascia::openings
