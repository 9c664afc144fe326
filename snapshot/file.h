#pragma once

#include <string>
#include <string_view>

#include "snapshot/record.h"
#include "snapshot/snapshot.h"

namespace fascia::snapshot {

/// A snapshot as text: JSON, a line for each region that moves in a state with its mean displacement and the
/// largest in millimetres, so that a difference of two files can be read, and the numbers themselves packed.
std::string to_text(const Snapshot& snapshot);

/// The snapshot of such a text. Throws fascia::Error, beginning with `name`, when it is not one or is
/// damaged.
Snapshot from_text(std::string_view text, const std::string& name);

/// Poses and regions as a user writes them:
/// {"poses": {NAME: {CHANNEL: VALUE}}, "regions": {NAME: {"landmarks": [...], "radius_mm": 12} or
/// {"mesh": 0, "primitive": 0, "vertices": [...]}, each with "tolerance_mm" if need be}}; either may be
/// missing. A file of activations is one pose. Throws fascia::Error, beginning with `name`.
void read_poses(std::string_view text, const std::string& name, Request& request);

}  // namespace fascia::snapshot
