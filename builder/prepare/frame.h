#pragma once

#include "builder/prepare/prepare.h"
#include "geometry/landmarks.h"

namespace fascia::prepare {

/// Where the head is in its file: the map to the rig frame, and the landmarks in file coordinates.
struct Frame {
  Mat4 input_to_metres = Mat4::Identity();
  std::string units;
  Landmarks landmarks;  ///< file coordinates
  std::vector<std::string> warnings;
};

/// Finds units and axes, by the landmarks where there are any. Arguments and errors as for `prepare`.
Frame find_frame(const formats::Scene& scene, const formats::LandmarkFile& given, const Landmarks& reference,
                 const PrepareOptions& options);

}  // namespace fascia::prepare
