#pragma once

#include "gltf/edit/edit.h"
#include "gltf/tinygltf/tinygltf.h"

namespace fascia::gltf {

/// Makes the clips that drive the weights of `mesh`, by node or by pointer (KHR_animation_pointer), and the
/// default weights of its nodes, fit a mesh whose targets have grown from `before` to `after` in number: the
/// new ones stay at 0, the others as they were. `model` is the file before the change. What does not fit its
/// mesh already is left alone, and a line in `warnings` says so.
void lengthen_weights(Edit& edit, const tinygltf::Model& model, uint32_t mesh, std::size_t before,
                      std::size_t after, std::vector<std::string>& warnings);

/// Weights a node shows a mesh with before any clip plays: its own, else the mesh's, else zeros; `count` of
/// them.
std::vector<float> default_weights(const Json& root, const Json& node, std::size_t count);

}  // namespace fascia::gltf
