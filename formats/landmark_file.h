#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::formats {

/// Landmarks as a file gives them: points on the skin, or on the bone, in the head file's axes.
struct LandmarkFile {
  std::string units;  ///< "m", "cm", "mm", metres per unit, or empty if the file does not say
  Landmarks points;
};

enum class LandmarkSurface { skin, bone };

/// Reads 3D Slicer Markups (`.mrk.json`; LPS taken as is, RAS with x and y negated) or
/// `{"units":"mm","landmarks":{NAME:[x,y,z]}}`, where a landmark may also be
/// `{"skin":[x,y,z],"bone":[x,y,z]}` as `fascia export` writes it; then the point on `surface` is used, and a
/// landmark without it is skipped.
///
/// Throws fascia::Error naming the file and the entry if it is missing, not JSON, of another structure, or a
/// coordinate is not finite.
LandmarkFile read_landmarks(const std::filesystem::path& path,
                            LandmarkSurface surface = LandmarkSurface::skin);

}  // namespace fascia::formats
