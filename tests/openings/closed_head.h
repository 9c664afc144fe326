#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::testing {

/// The generic head as a scan has it: lips and lids stitched together, nothing behind them, no eyeballs.
struct ClosedHead {
  TriangleMesh skin;            ///< metres, rig frame
  std::vector<int> of_generic;  ///< vertex of the generic skin -> vertex here, -1: left out
  Landmarks landmarks;
};

/// `lids`: the lids are drawn down over the eyes and stitched too; else the eyes stay as they are.
ClosedHead closed_head(const anatomy::GenericAnatomy& anatomy, bool lids = true);

/// The generic head, metres, with its eyes as statues and many scans have them: open, and one surface with
/// the lids.
TriangleMesh eyes_in_one_piece(const anatomy::GenericAnatomy& anatomy);

/// As OBJ text in millimetres, with texture coordinates and one quad on the forehead's side.
std::string obj_text(const TriangleMesh& mesh);

}  // namespace fascia::testing
