#pragma once

#include <filesystem>

#include "cli/common.h"
#include "cli/gltf_edit.h"
#include "cli/posing.h"

namespace fascia::cli {

/// Displacements from rest of every mesh of `face` that moves.
std::vector<PrimitiveMotion> motion_from_rest(const Face& face);

struct BakedShapes {
  std::vector<std::string> names;
  std::vector<std::vector<PrimitiveMotion>> shapes;
};

/// Poses `face` at 1 for each of `targets`, pairs of target name and what to set.
BakedShapes bake_shapes(const Common& common, Face& face,
                        const std::vector<std::pair<std::string, std::string>>& targets);

/// A motion as few shapes and their weights over time: principal components.
struct Components {
  std::vector<std::vector<float>> shapes;   ///< displacement of all coordinates a component
  std::vector<std::vector<float>> weights;  ///< #components, one weight a frame
  double largest_error = 0.0;               ///< in the coordinates' unit, any vertex of any frame
};

/// Principal components of `frames` (displacements of equal length, three numbers a vertex), as many as bring
/// every vertex within `tolerance`, at most `limit`.
Components principal_components(const std::vector<std::vector<float>>& frames, size_t limit,
                                double tolerance);

}  // namespace fascia::cli
