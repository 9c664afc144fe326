#include "builder/prepare/tooth_rows.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace fascia::prepare {

namespace {

constexpr double most_of_height = 0.6;  // teeth that bite past each other share less

double overlap(const Bounds& a, const Bounds& b, int axis) {
  return std::min(a.upper[axis], b.upper[axis]) - std::max(a.lower[axis], b.lower[axis]);
}

/// Whether two pieces are one over or beside the other, but for a little, as upper incisors stand before
/// lower ones.
bool are_near(const Bounds& a, const Bounds& b) {
  const double slack = 0.3 * std::min(a.size().y(), b.size().y());
  return overlap(a, b, 0) > -slack && overlap(a, b, 2) > -slack;
}

/// Share of the smaller height that both pieces have.
double shared_height(const Bounds& a, const Bounds& b) {
  return overlap(a, b, 1) / std::max(std::min(a.size().y(), b.size().y()), 1e-6);
}

/// Whether one piece stands squarely over the other: then they are of two rows.
bool are_stacked(const Bounds& a, const Bounds& b) {
  constexpr double squarely = 0.3;  // of the smaller extent
  for (const int axis : {0, 2})
    if (overlap(a, b, axis) < squarely * std::min(a.size()[axis], b.size()[axis])) return false;
  return shared_height(a, b) < most_of_height;
}

/// Pieces of one row: neighbours that share most of their height, and so on along the row, those that share
/// most first, so that no row is joined with pieces over or under it.
std::vector<size_t> neighbouring(const std::vector<Bounds>& pieces) {
  const size_t count = pieces.size();
  std::vector<size_t> group(count);
  std::iota(group.begin(), group.end(), size_t{0});
  std::vector<std::vector<bool>> apart(count, std::vector<bool>(count, false));  // by group
  std::vector<std::tuple<double, size_t, size_t>> links;
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j < i; ++j) {
      if (!are_near(pieces[i], pieces[j])) continue;
      if (are_stacked(pieces[i], pieces[j]))
        apart[i][j] = apart[j][i] = true;
      else if (const double share = shared_height(pieces[i], pieces[j]); share > most_of_height)
        links.emplace_back(-share, j, i);
    }
  std::sort(links.begin(), links.end());
  for (const auto& [share, a, b] : links) {
    const size_t kept = std::min(group[a], group[b]), gone = std::max(group[a], group[b]);
    if (kept == gone || apart[kept][gone]) continue;
    std::replace(group.begin(), group.end(), gone, kept);
    for (size_t k = 0; k < count; ++k)
      if (apart[gone][k]) apart[kept][k] = apart[k][kept] = true;
  }
  return group;
}

/// The pieces with the slope and tilt taken off that they have in common, so that single teeth beside each
/// other stand at one height. Few pieces, such as whole rows, do not tell a slope from one standing over the
/// other.
std::vector<Bounds> levelled(std::vector<Bounds> pieces) {
  constexpr size_t fewest = 8;
  if (pieces.size() < fewest) return pieces;
  Vec3 middle = Vec3::Zero();
  for (const Bounds& box : pieces)
    middle += box.centre() / static_cast<double>(pieces.size());
  Eigen::Matrix2d moments = 1e-9 * Eigen::Matrix2d::Identity();  // square metres: pieces in one line
  Vec2 rises = Vec2::Zero();
  for (const Bounds& box : pieces) {
    const Vec3 off = box.centre() - middle;
    const Vec2 flat(off.x(), off.z());
    moments += flat * flat.transpose();
    rises += off.y() * flat;
  }
  const Vec2 slope = moments.inverse() * rises;
  for (Bounds& box : pieces) {
    const Vec3 off = box.centre() - middle;
    const double rise = slope.dot(Vec2(off.x(), off.z()));
    box.lower.y() -= rise;
    box.upper.y() -= rise;
  }
  return pieces;
}

}  // namespace

std::optional<std::vector<bool>> lower_row(const std::vector<Bounds>& as_they_stand) {
  const std::vector<Bounds> pieces = levelled(as_they_stand);
  const size_t count = pieces.size();
  const std::vector<size_t> group = neighbouring(pieces);
  std::vector<int> above(count, 0);  // by group: pieces of other rows beneath it, less those over it
  bool any = false;
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j < count; ++j) {
      if (group[i] == group[j] || !are_near(pieces[i], pieces[j]) ||
          pieces[i].centre().y() <= pieces[j].centre().y())
        continue;
      ++above[group[i]];
      --above[group[j]];
      any = true;
    }
  if (!any) return std::nullopt;
  std::vector<bool> lower(count);
  for (size_t i = 0; i < count; ++i) {
    size_t like = i;
    // A tooth without an opposite one is assigned to the row of the nearest tooth that has one.
    for (size_t j = 0; above[group[like]] == 0 && j < count; ++j) {
      if (above[group[j]] == 0) continue;
      const auto far = [&](size_t k) { return (pieces[k].centre() - pieces[i].centre()).squaredNorm(); };
      like = j;
      for (size_t k = j; k < count; ++k)
        if (above[group[k]] != 0 && far(k) < far(like)) like = k;
    }
    lower[i] = above[group[like]] < 0;
  }
  return lower;
}

}  // namespace fascia::prepare
