#pragma once

#include <optional>
#include <vector>

#include "builder/skull/skull.h"

namespace fascia::skull {

/// Teeth and joints: everything near them, on whichever bone, moves by one similarity. Rows of teeth that the
/// head shows move as `upper` and `lower` say; else both move as one body, in contact as on the generic.
std::vector<BoneMap::Patch> make_patches(const Generic& generic, const std::optional<Mat4>& upper,
                                         const std::optional<Mat4>& lower);

/// `pattern` with the similarities that follow `warp`; those fixed by evidence stay.
std::vector<BoneMap::Patch> settled_patches(const splines::Warp& warp,
                                            const std::vector<BoneMap::Patch>& pattern);

}  // namespace fascia::skull
