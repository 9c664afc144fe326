#pragma once

#include "gltf/edit/document.h"

namespace fascia::gltf {

/// Gives every node that shows a mesh which another node shows too a mesh of its own: a copy of its JSON over
/// the same accessors, appended. What moves one then leaves the others alone. Returns how many were added.
std::size_t separate_instances(Json& root);

}  // namespace fascia::gltf
