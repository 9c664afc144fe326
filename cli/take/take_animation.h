#pragma once

#include <span>
#include <string>

#include "cli/gltf_edit.h"
#include "cli/take/head_motion.h"
#include "cli/take/recording.h"

namespace fascia::cli {

/// Puts a recorded take into the file: morph targets of each mesh that moves, named motion_0, motion_1, ...,
/// and an animation `name` of their weights, of the channels (KHR_animation_pointer) and of the nodes that
/// turn with the head. What was there keeps its place; lines in `warnings` tell of names that were there.
void add_take(GltfEdit& edit, const std::string& name, const Take& take, const Face& face,
              Recording recording, const std::vector<NodeMotion>& nodes, std::vector<std::string>& warnings);

}  // namespace fascia::cli
