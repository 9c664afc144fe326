#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace fascia::cli {

/// What "units" says in a landmark file whose coordinates are of `metres` each: "m", "cm", "mm" (within a
/// ten-thousandth), or else the metres as a number.
inline nlohmann::ordered_json landmark_units(double metres) {
  for (const auto& [name, value] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}})
    if (std::abs(metres / value - 1.0) < 1e-4) return name;
  return metres;
}

}  // namespace fascia::cli
