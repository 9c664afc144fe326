#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/common.h"

namespace fascia::cli {

struct BakeRequest {
  std::filesystem::path rig, output;
  /// Vocabularies of the rig (arkit, viseme or visemes, vrm, au, faces, ...), and `muscles` for every
  /// channel.
  std::vector<std::string> sets = {"arkit"};
  std::string format;        ///< glb, obj-sequence or pc2; empty: by the output's extension
  bool correctives = false;  ///< whether pairs of ARKit shapes get a target of what their sum lacks
  bool replaces = false;     ///< whether a shape takes the place of a morph target of its name
  bool keeps_rig = false;    ///< whether the FASCIA extensions stay in the file
  std::string solver = "own", level;
};

struct BakeFigures {
  std::vector<std::string> names;
  std::vector<double> megabytes;  ///< by shape: of the file's growth, its share by vertices moved; glb only
  std::vector<std::filesystem::path> files;
};

/// Poses the rig once for each shape, several at a time, and writes the shapes:
///   glb: the rig's original file with a morph target a shape;
///   obj-sequence: a folder of one OBJ a shape, NAME.obj, and rest.obj;
///   pc2: a cache whose first frame is the face at rest and whose others are the shapes.
/// Names are those of the vocabulary; visemes get `viseme_` and action units `AU`, as hosts expect them.
/// Throws fascia::Error for what cannot be read or written.
BakeFigures bake_file(const Common& common, const BakeRequest& request);

}  // namespace fascia::cli
