#pragma once

#include "rig/model/rig.h"
#include "rig/write/write.h"

namespace fascia::test {

/// A small but whole rig for tests: a curved patch of face, 17 by 17 columns, with the muscles
/// `zygomaticus_major_left` and `_right`, a jaw below the middle, and an ARKit set of three.
rig::Rig tiny_rig();

/// The head it is made for: one mesh of 289 vertices in centimetres, its node 160 cm up, with properties that
/// Fascia does not know, an animation, extras and a material.
rig::GltfSource tiny_head();

/// Both together, as the bytes of a rig file.
std::vector<uint8_t> tiny_rig_file();

}  // namespace fascia::test
