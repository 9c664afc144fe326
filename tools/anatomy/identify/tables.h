#pragma once

#include <string>
#include <vector>

#include "tools/anatomy/identify/problem.h"

namespace fascia::identify {

struct TableOptions {
  double ridge = 0.004;       ///< of a whole activation squared, as a share of the shape's own square
  double sparsity = 0.002;    ///< of a whole activation
  double least_gain = 0.002;  ///< share of the motion that an actuator must explain to stay
  int rounds = 8;
  bool both_sides = true;  ///< of a one-sided shape
};

/// A row found: weights by channel, and by head what it explains.
struct FittedRow {
  Weights weights;
  std::vector<double> shares;
  double share = 0.0;
};

/// Finds the weights of one shape that serve all `heads` together: Gauss-Newton steps on the full static
/// simulation, bounded, with a price on size and number (shares of each head's own motion, so that a head
/// counts by its weight and not by how far it moves). `base` is played with it. Left and right sides of a
/// one-sided shape both count, each with the mirror image of the weights.
FittedRow fit_row(const ShapeEntry& entry, const Weights& base, const Weights& start,
                  std::vector<FittedHead>& heads, const TableOptions& options, double reach);

}  // namespace fascia::identify
