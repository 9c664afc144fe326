#pragma once

#include "gltf/edit/edit.h"
#include "gltf/edit/morph_targets.h"
#include "rig/write/write.h"

/// The names by which the commands know what changes glTF files (gltf/edit).
namespace fascia::cli {

using GltfEdit = gltf::Edit;
using gltf::add_morph_targets;
using gltf::PrimitiveMotion;

}  // namespace fascia::cli
