#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::cli {

struct LandmarkFrame {
  double time = 0.0;  ///< seconds
  Landmarks points;
};

/// Frames of a file of landmarks; one for a file of one face.
struct LandmarkFrames {
  std::string units;  ///< m, cm, mm, or as the file says; empty: the head file's
  std::vector<LandmarkFrame> frames;
  bool is_take = false;
  bool is_flat = false;  ///< points of a picture, two numbers each: z is 0
};

/// Reads landmarks in any of the forms that `landmark_targets` lists, points of two numbers or of three.
/// Throws fascia::Error naming file and entry.
LandmarkFrames read_landmark_frames(const std::filesystem::path& path);

}  // namespace fascia::cli
