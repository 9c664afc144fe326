#include "builder/muscles/order.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "builder/muscles/depth.h"

namespace fascia::muscles {

namespace {

/// Points of the fibres, all fibres with as many: row k holds the k-th of each.
using Grid = std::vector<std::vector<FibrePoint>>;

Grid rows_of(const std::vector<Fibre>& fibres, const Replace& replace) {
  size_t most = 0;
  for (const Fibre& fibre : fibres)
    most = std::max(most, fibre.points.size());
  Grid rows(most);
  for (const Fibre& fibre : fibres) {
    std::vector<Vec3> line;
    for (const FibrePoint& point : fibre.points)
      line.push_back(point.position);
    const bool even = fibre.points.size() == most;
    if (!even) line = resampled(line, static_cast<int>(most));
    for (size_t k = 0; k < most; ++k) {
      if (even)
        rows[k].push_back(fibre.points[k]);
      else if (k == 0)
        rows[k].push_back(fibre.points.front());
      else if (k + 1 == most)
        rows[k].push_back(fibre.points.back());
      else
        rows[k].push_back(replace(line[k], double(k) / double(most - 1)));
    }
  }
  return rows;
}

void back_to(std::vector<Fibre>& fibres, const Grid& rows) {
  for (size_t i = 0; i < fibres.size(); ++i) {
    fibres[i].points.clear();
    for (const auto& row : rows)
      fibres[i].points.push_back(row[i]);
  }
}

Vec3 middle(const std::vector<FibrePoint>& row) {
  Vec3 sum = Vec3::Zero();
  for (const FibrePoint& point : row)
    sum += point.position / double(row.size());
  return sum;
}

/// Directions across the muscle at each row: at right angles to its course and to where it is seen from.
std::vector<Vec3> across(const Grid& rows, const std::vector<Fibre>& fibres,
                         const spatial::SurfaceQuery& smas) {
  const auto seen = seen_along(fibres, smas);
  std::vector<Vec3> directions;
  double sign = 0.0;
  for (size_t k = 0; k < rows.size(); ++k) {
    const Vec3 course = middle(rows[std::min(k + 1, rows.size() - 1)]) - middle(rows[k > 0 ? k - 1 : 0]);
    Vec3 normal = Vec3::Zero();
    for (const auto& normals : seen)
      normal += normals[k];
    directions.push_back(normal.cross(course).normalized());
    sign += directions[k].dot(rows[k].back().position - rows[k].front().position);
  }
  if (sign < 0.0)
    for (Vec3& direction : directions)
      direction = -direction;
  return directions;
}

void sort_rows(Grid& rows, const std::vector<Vec3>& directions) {
  for (size_t k = 0; k < rows.size(); ++k)
    std::stable_sort(rows[k].begin(), rows[k].end(), [&](const FibrePoint& a, const FibrePoint& b) {
      return directions[k].dot(a.position) < directions[k].dot(b.position);
    });
}

void smooth(Grid& rows, const Replace& replace) {
  const Grid before = rows;
  const size_t count = rows.size(), fibres = rows[0].size();
  for (size_t k = 1; k + 1 < count; ++k)
    for (size_t i = 0; i < fibres; ++i) {
      const auto at = [&](size_t row, size_t fibre) -> const Vec3& { return before[row][fibre].position; };
      Vec3 wanted = 0.5 * (at(k - 1, i) + at(k + 1, i));
      if (i > 0 && i + 1 < fibres) wanted = 0.7 * wanted + 0.15 * (at(k, i - 1) + at(k, i + 1));
      rows[k][i] = replace(0.4 * at(k, i) + 0.6 * wanted, double(k) / double(count - 1));
    }
}

}  // namespace

int put_in_order(std::vector<Fibre>& fibres, const spatial::SurfaceQuery& smas, const Replace& replace,
                 bool sort, int rounds) {
  int left = crossings(fibres, smas);
  if (left == 0) return 0;
  Grid rows = rows_of(fibres, replace);
  if (rows.size() < 3) return left;
  back_to(fibres, rows);
  std::vector<Fibre> best = fibres;
  left = crossings(fibres, smas);
  for (int round = 0; round < rounds && left > 0; ++round) {
    if (sort) sort_rows(rows, across(rows, fibres, smas));
    smooth(rows, replace);
    back_to(fibres, rows);
    const int now = crossings(fibres, smas);
    if (now >= left) continue;
    best = fibres;
    left = now;
  }
  fibres = std::move(best);
  return left;
}

}  // namespace fascia::muscles
