#pragma once

#include "cli/fit_target.h"
#include "fit/scan/scan.h"

namespace fascia::cli {

/// A scan on the rig's head, metres, ready to be fitted.
struct PlacedScan {
  TriangleMesh mesh;
  std::vector<std::string> warnings;  ///< how it was brought there, where it was not there already
};

/// Reads the scan at `scene` in the rig's axes and units. One that lies elsewhere is looked for a face and
/// brought there by landmarks that no muscle moves; its size is kept unless it is of another unit. Throws
/// fascia::Error when no face is found in it.
PlacedScan place_scan(const fit::Subject& subject, const formats::Scene& scene, bool may_search);

}  // namespace fascia::cli
