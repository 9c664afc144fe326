#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::smas {

/// Points in a hash grid that grows with them: neighbours within a radius in constant time.
class VertexGrid {
 public:
  /// `cell` is the width of a cell, in the unit of the points; about the usual search radius.
  explicit VertexGrid(double cell) : inverse_cell_(1.0 / cell), heads_(1024, -1) {}

  /// Adds the next point; points are numbered from 0 in the order in which they come.
  void add(const Vec3& point) {
    if (points_.size() >= heads_.size()) rehash();
    const size_t slot = slot_of(cell_of(point[0]), cell_of(point[1]), cell_of(point[2]));
    nexts_.push_back(heads_[slot]);
    heads_[slot] = static_cast<int>(points_.size());
    points_.push_back(point);
  }

  /// The numbers of all points within `radius` of `centre`, in an order that depends only on what
  /// was added; `found` is overwritten.
  void near(const Vec3& centre, double radius, std::vector<int>* found) const {
    found->clear();
    int64_t low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = cell_of(centre[k] - radius);
      high[k] = cell_of(centre[k] + radius);
    }
    for (int64_t x = low[0]; x <= high[0]; ++x)
      for (int64_t y = low[1]; y <= high[1]; ++y)
        for (int64_t z = low[2]; z <= high[2]; ++z)
          for (int i = heads_[slot_of(x, y, z)]; i >= 0; i = nexts_[i]) {
            const Vec3& p = points_[i];
            // Two cells can share a slot: take a point only from the cell that it lies in.
            if ((p - centre).squaredNorm() <= radius * radius && cell_of(p[0]) == x && cell_of(p[1]) == y &&
                cell_of(p[2]) == z)
              found->push_back(i);
          }
  }

 private:
  int64_t cell_of(double x) const { return static_cast<int64_t>(std::floor(x * inverse_cell_)); }
  size_t slot_of(int64_t x, int64_t y, int64_t z) const {
    const uint64_t h = static_cast<uint64_t>(x) * 73856093ULL ^ static_cast<uint64_t>(y) * 19349663ULL ^
                       static_cast<uint64_t>(z) * 83492791ULL;
    return static_cast<size_t>(h ^ (h >> 17)) & (heads_.size() - 1);
  }
  void rehash() {
    heads_.assign(heads_.size() * 4, -1);
    for (size_t i = 0; i < points_.size(); ++i) {
      const Vec3& p = points_[i];
      const size_t slot = slot_of(cell_of(p[0]), cell_of(p[1]), cell_of(p[2]));
      nexts_[i] = heads_[slot];
      heads_[slot] = static_cast<int>(i);
    }
  }

  double inverse_cell_;
  std::vector<int> heads_, nexts_;
  std::vector<Vec3> points_;
};

}  // namespace fascia::smas
