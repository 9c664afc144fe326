#pragma once

#include <functional>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::formats {

/// A morph target of one primitive: displacements in the primitive's own coordinates, #vertices.
struct ShapePart {
  int mesh = 0, primitive = 0;
  std::vector<Vec3> displacements;
};

/// Morph targets of one name over all primitives of a file.
struct Shape {
  std::string name;
  std::vector<ShapePart> parts;
};

/// Key frames of morph target weights, from the file's first animation that has any. Meshes are animated
/// independently, even if their morph targets have equal names, so that every mesh has shapes of its own
/// here.
struct ShapeCurves {
  std::vector<Shape> shapes;                 ///< one per morph target of an animated mesh
  std::vector<double> times;                 ///< seconds, rising
  std::vector<std::vector<double>> weights;  ///< by time, one per shape, relative to the base mesh
};

/// The morph targets of a glTF file, in the file's order, by `mesh.extras.targetNames`; optionally restricted
/// to names that satisfy `is_wanted`. Throws fascia::Error if an accessor is damaged or of an unsupported
/// type.
std::vector<Shape> morph_shapes(const Scene& scene,
                                const std::function<bool(const std::string& name)>& is_wanted = {});

/// Key frames of the weights of morph targets; empty if they are not animated. Throws as `morph_shapes`.
ShapeCurves shape_curves(const Scene& scene);

}  // namespace fascia::formats
