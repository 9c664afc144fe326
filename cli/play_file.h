#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/common.h"

namespace fascia::cli {

struct PlayRequest {
  std::filesystem::path rig, curves, output;
  std::vector<std::string> set;     ///< NAME=VALUE: values that hold under the curves
  std::filesystem::path values;     ///< the same from an activations file; empty: none
  double weight = 1.0;              ///< of the curves
  std::vector<std::string> layers;  ///< FILE or FILE=WEIGHT: curves added to them
  double frames_per_second = 60.0;
  double curve_frames_per_second = 0.0;  ///< of the curves' rows; 0: as their file says
  double time_unit = 0.0;                ///< seconds in one unit of the curves' times; 0: as their file says
  double from = 0.0, to = -1.0;          ///< seconds from the curves' first key; below 0: to the last
  size_t most_targets = 1024;            ///< morph targets a mesh
  bool keeps_head = false;               ///< whether captured rotations of the head turn its nodes
  std::string solver = "own", level;
};

struct PlayFigures {
  size_t frames = 0;
  int resets = 0;
  double duration = 0.0;  ///< seconds
  double start = 0.0;     ///< seconds: the curves' own time at the first frame
  size_t components = 0;  ///< morph targets of the mesh that has most
  size_t wanted = 0;      ///< how many would bring all within 0.1 mm; 0: more than are followed
  size_t keys = 0;        ///< frames with weights, of the mesh that has most
  double largest_error_mm = 0.0, largest_error_seconds = 0.0;
  double milliseconds_a_frame = 0.0;  ///< median of a step
  std::vector<std::string> matched, unmatched;
  std::vector<std::filesystem::path> files;
};

/// Simulates the rig along the curves, of any length, and writes what `output` asks for by its extension:
/// .glb, the rig's file with morph targets (principal components of the motion, mesh by mesh), their weights
/// over time and the curves again as pointer channels; .pc2 or .mdd, caches of every vertex in every frame,
/// in the input file's axes and units. Throws fascia::Error for what cannot be read or written.
PlayFigures play_file(const Common& common, const PlayRequest& request);

}  // namespace fascia::cli
