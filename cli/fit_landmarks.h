#pragma once

#include "cli/fit_target.h"

namespace fascia::cli {

/// Opens landmarks as what is to be fitted: a landmark file (formats/landmark_file.h) of our names, or
///
///     {"units": "mm", "points": [[x, y, z], ...]}          one face by the 68 points of iBUG or the 478 of
///     MediaPipe, null for one that was not seen
///     {"units": "mm", "frames": [{"time": 0.0, "points": [...]}, ...]}         a take
///     {"units": "mm", "frames": [{"time": 0.0, "landmarks": {NAME: [x, y, z]}}, ...]}
///
/// in the axes of the file the rig was built from. (Points of two numbers: see fit_pictures.h.) `neutral`:
/// the same landmarks on the face at rest, by the same detector, whose places on the skin then need not be
/// ours; empty: none. Where still landmarks have moved, the head's own motion is taken out unless `options`
/// say otherwise. `subject` must outlive the result. Throws fascia::Error naming file and entry.
FitTargets landmark_targets(const Common& common, const std::filesystem::path& path,
                            const std::filesystem::path& neutral, const fit::Subject& subject,
                            const FitTargetOptions& options);

}  // namespace fascia::cli
