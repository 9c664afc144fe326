#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/common.h"
#include "cli/gltf_edit.h"
#include "cli/posing.h"

namespace fascia::cli {

/// Displacements from rest of every mesh of `face` that moves.
std::vector<PrimitiveMotion> motion_from_rest(const Face& face);

/// A shape: what stands at 1 in it.
struct ShapeToBake {
  std::string name;
  std::vector<std::string> sets;
  /// Of a corrective, the shapes whose sum is taken off: numbers of earlier ones in the list.
  std::vector<size_t> corrects;
};

struct BakedShapes {
  std::vector<std::string> names;
  std::vector<std::vector<PrimitiveMotion>> shapes;
};

/// Poses `face` as the shape has it, from rest: the order in which shapes are posed leaves no trace.
void pose_shape(Face& face, const ShapeToBake& shape);

/// Poses a sibling of `face` for each of `shapes`, as many at a time as there are threads, and shows them to
/// `visit` one after the other in the list's order; the same whatever the number of threads.
void for_each_shape(const Common& common, const Face& face, const std::vector<ShapeToBake>& shapes,
                    const std::function<void(size_t shape, const Face& posed)>& visit);

/// What each of `shapes` moves; of a corrective, what it moves beyond the sum of its parts.
BakedShapes bake_shapes(const Common& common, const Face& face, const std::vector<ShapeToBake>& shapes);

}  // namespace fascia::cli
