#pragma once

#include "builder/prepare/prepare.h"

namespace fascia::prepare {

/// The rotation that sets a head upright as the reference stands, by its landmarks: +X is the direction
/// from right landmarks to left ones, and nodding is taken out by least squares (Umeyama 1991) over
/// all. `here` and `reference` are in the rig frame, by the same names. Identity with fewer than three pairs.
Mat3 uprighting(const std::map<std::string, Vec3>& here, const std::map<std::string, Vec3>& reference);

/// Turns the whole head about the origin; `input_to_metres` with it.
void turn(PreparedHead& head, const Mat3& rotation);

}  // namespace fascia::prepare
