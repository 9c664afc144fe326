#pragma once

#include <vector>

#include "formats/scene.h"
#include "rig/model/rig.h"

namespace fascia::rigging {

/// Makes primitives that are drawn from one vertex buffer follow alike: each vertex as the first primitive
/// that draws it has it, those that none draws not at all. Their bindings are then the same data, which files
/// store once, and so are the morph targets made from them.
///
/// `bindings` are those of one level over the primitives of `scene`.
void share_vertices(const formats::Scene& scene, std::vector<rig::Binding>& bindings);

}  // namespace fascia::rigging
