#pragma once

#include <string>
#include <vector>

#include "tools/anatomy/identify/problem.h"

namespace fascia::identify {

/// A constant of the tissue that may move: by a factor, within the range that its source gives.
struct TissueParameter {
  std::string section, name;  ///< of mechanics.json: a section's constant, or a region's factor (name.factor)
  double value = 0.0, least = 0.0, most = 0.0;
};

struct TissueOptions {
  std::string data = "anatomy/data";  ///< folder of mechanics.json
  std::string level = "low";
  double prior = 0.02;      ///< price of a factor of e, as a share of the motion
  double longest = 0.5;     ///< of a step: the logarithm of a factor
  double difference = 0.2;  ///< of the differences that the derivatives are taken by, likewise
};

/// A step of Gauss and Newton on the tissue's constants: how poses of `rows` (the table as it is) change with
/// each, by rebuilding the rigs with it changed, the table's own weights following as suits best (variable
/// projection: Golub & Pereyra 2003). Prints what moves, by how much it should be, and what the data do not
/// tell. Writes the constants to `output`, a mechanics.json.
void identify_tissue(const std::vector<ShapeEntry>& entries, const std::map<std::string, Weights>& rows,
                     const std::vector<bench::SculptedHead>& heads, const std::vector<double>& head_weights,
                     const TissueOptions& options, const std::string& output);

}  // namespace fascia::identify
