#pragma once

#include "gltf/edit/document.h"
#include "gltf/edit/morph_targets.h"

namespace fascia::gltf::test {

/// What a sheet file holds beside positions and triangles.
struct SheetOptions {
  bool normals = false, tangents = false;
  int primitives = 1;  ///< over one vertex buffer, each drawing its share of the triangles
  std::vector<float> weights =
      {};             ///< two morph targets, "lift" (up by 1) and "jawOpen", with these default weights
  bool clip = false;  ///< an animation of the weights, three keys
};

/// A flat sheet of 5 by 5 vertices in the x-y plane facing +Z, a unit between neighbours, as one mesh on one
/// node.
Document sheet(const SheetOptions& options = {});

/// A bump of `height` in the sheet's middle vertex, number 12.
std::vector<PrimitiveMotion> bump(float height, int primitives = 1);

/// Float elements of an accessor of `document`.
std::vector<float> floats(const Document& document, const Json& accessor);

}  // namespace fascia::gltf::test
