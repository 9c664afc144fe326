#pragma once

#include <string>

#include "builder/rigging/find_landmarks.h"
#include "view/image.h"

namespace fascia::bench {

/// A picture of a head with its landmarks drawn: green sure, red doubtful. `yaw` turns it from the front,
/// degrees.
view::Tile landmark_tile(const rigging::FoundLandmarks& found, const std::string& caption, double yaw);

}  // namespace fascia::bench
