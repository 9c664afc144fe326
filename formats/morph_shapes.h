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

/// When each shape weighs how much: of the file's first animation that moves weights. Meshes are animated
/// each on its own, whatever their morph targets are called, so that here every mesh has its own shapes.
struct ShapeCurves {
  std::vector<Shape> shapes;                 ///< one a morph target of an animated mesh
  std::vector<double> times;                 ///< seconds, rising
  std::vector<std::vector<double>> weights;  ///< by time, one a shape: beyond the base mesh's
};

/// The morph targets of a glTF file, in the file's order, by `mesh.extras.targetNames`; of those alone whose
/// names `is_wanted`, where it is given. Throws fascia::Error when an accessor is damaged or of a kind that
/// is not read here.
std::vector<Shape> morph_shapes(const Scene& scene,
                                const std::function<bool(const std::string& name)>& is_wanted = {});

/// Key frames of the weights of morph targets; empty when nothing moves them. Throws as `morph_shapes`.
ShapeCurves shape_curves(const Scene& scene);

}  // namespace fascia::formats
