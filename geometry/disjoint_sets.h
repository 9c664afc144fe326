#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace fascia {

/// Union-find over the numbers below `count`: the least number of a set stands for it.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// The number that stands for the set of `i`.
  int of(int i) {
    while (parent_[static_cast<size_t>(i)] != i)
      i = parent_[static_cast<size_t>(i)] = parent_[static_cast<size_t>(parent_[static_cast<size_t>(i)])];
    return i;
  }
  void join(int a, int b) {
    a = of(a);
    b = of(b);
    parent_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace fascia
