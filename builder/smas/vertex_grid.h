#pragma once

#include <array>
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
    if (nodes_.size() >= heads_.size()) rehash();
    const Cell cell = {cell_of(point[0]), cell_of(point[1]), cell_of(point[2])};
    int& head = heads_[slot_of(cell)];
    nodes_.push_back({point, cell, head, false});
    head = static_cast<int>(nodes_.size()) - 1;
  }

  /// Takes point number `i` out.
  void remove(int i) {
    int* link = &heads_[slot_of(nodes_[i].cell)];
    while (*link >= 0 && *link != i)
      link = &nodes_[*link].next;
    if (*link == i) *link = nodes_[i].next;
    nodes_[i].removed = true;
  }

  /// The numbers of all points within `radius` of `centre`, in an order that depends only on what
  /// was added; `found` is overwritten.
  void near(const Vec3& centre, double radius, std::vector<int>* found) const {
    found->clear();
    Cell low, high;
    for (int k = 0; k < 3; ++k) {
      low[k] = cell_of(centre[k] - radius);
      high[k] = cell_of(centre[k] + radius);
    }
    Cell cell;
    for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0])
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1])
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2])
          for (int i = heads_[slot_of(cell)]; i >= 0; i = nodes_[i].next)
            // Two cells can share a slot: take a point only from the cell that it lies in.
            if ((nodes_[i].point - centre).squaredNorm() <= radius * radius && nodes_[i].cell == cell)
              found->push_back(i);
  }

 private:
  using Cell = std::array<int64_t, 3>;
  struct Node {
    Vec3 point;
    Cell cell;
    int next;
    bool removed;
  };
  int64_t cell_of(double x) const { return static_cast<int64_t>(std::floor(x * inverse_cell_)); }
  size_t slot_of(const Cell& cell) const {
    const uint64_t h = static_cast<uint64_t>(cell[0]) * 73856093ULL ^
                       static_cast<uint64_t>(cell[1]) * 19349663ULL ^
                       static_cast<uint64_t>(cell[2]) * 83492791ULL;
    return static_cast<size_t>(h ^ (h >> 17)) & (heads_.size() - 1);
  }
  void rehash() {
    heads_.assign(heads_.size() * 4, -1);
    for (size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].removed) continue;
      int& head = heads_[slot_of(nodes_[i].cell)];
      nodes_[i].next = head;
      head = static_cast<int>(i);
    }
  }

  double inverse_cell_;
  std::vector<int> heads_;
  std::vector<Node> nodes_;
};

}  // namespace fascia::smas
