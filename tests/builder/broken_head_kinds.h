#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/builder/pieces_file.h"

/// What the makers of broken heads share.
namespace fascia::testing {

using Random = std::mt19937;

/// A head in the making.
struct Made {
  std::vector<Piece> pieces;
  bool is_usable = true, is_cut = false;
  std::vector<std::string> says;
};

inline Piece& skin_of(Made& made) {
  return *std::find_if(made.pieces.begin(), made.pieces.end(),
                       [](const Piece& piece) { return piece.name == "skin"; });
}

inline double chance(Random& random, double from, double to) {
  return from + (to - from) * static_cast<double>(random()) / 4294967295.0;
}

inline size_t any(Random& random, size_t count) {
  return static_cast<size_t>(random()) % count;
}

using Break = std::function<void(Made&, Random&)>;

/// Kinds that no rig can come of.
void add_ruins(std::map<std::string, Break>& kinds);

}  // namespace fascia::testing
