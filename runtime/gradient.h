#pragma once

#include <span>

#include "runtime/face.h"

namespace fascia::runtime {

/// The derivative of a loss by every channel at a static pose: `slopes` #meshes, each the loss's derivative
/// by the mesh's positions in the face's space (3 floats a vertex) or null; `by_channel` #channels. See
/// fascia_face_gradient.
void find_gradient(Face& face, std::span<const float* const> slopes, std::span<float> by_channel);

}  // namespace fascia::runtime
