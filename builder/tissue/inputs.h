#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/mechanics.h"
#include "geometry/for_each.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"
#include "rig/model/rig.h"

namespace fascia::tissue {

/// One primitive of the user's file, to be bound to the lattice.
struct PartMesh {
  std::string part;  ///< skin, eye_left, eye_right, eye_surround, teeth_upper, teeth_lower, gums_upper,
                     ///< gums_lower, mouth_interior, tongue, lashes, brows, hair, other
  std::vector<Vec3> vertices;  ///< metres, in the file's order
  std::vector<fascia::Triangle> triangles;
  std::vector<int> skin_vertices =
      {};  ///< of a skin part: the vertex of `TissueInputs::skin` each one is, -1 unknown; or none known
};

/// The inputs of the lattice. Metres; see rig/model/rig.h for axes.
struct TissueInputs {
  anatomy::Mechanics mechanics;             ///< constants of the tissue
  TriangleMesh skin;                        ///< welded; lips and lids open as the mesh has them
  Landmarks landmarks;                      ///< on the skin, by full name
  TriangleMesh cranium, mandible;           ///< fitted, teeth apart or not
  TriangleMesh smas;                        ///< may be empty: then it lies at a share of the depth to bone
  std::vector<float> smas_bone_attachment;  ///< #smas vertices, 0 gliding .. 1 firm; may be empty
  rig::JawJoint jaw;
  rig::Eye eye_left, eye_right;          ///< radius 0: found from the lids' landmarks
  std::vector<rig::Ligament> ligaments;  ///< used with TissueOptions::contact
  std::vector<rig::Muscle> muscles;
  std::vector<rig::Channel> channels;
  std::vector<PartMesh> parts;
  std::vector<float> blink;          ///< #channels: what closes both eyes; empty: not known
  bool has_muscles_by_hand = false;  ///< edited muscles may be asymmetric
};

/// Resolution of a level: approximate number of columns, and growth of the edge length away from lips and
/// lids.
struct LevelOptions {
  std::string name = "medium";
  int columns = 2000;
  /// Edge length at the mouth's corners over that along the lips. The corner opens like a crack, wider the
  /// finer its tip is cut: medium and high cut it alike, at some 0.9 mm, low at 1.8.
  double corner_ratio = 0.5;
};

/// Options of the discretisation; they do not affect tissue properties.
struct TissueOptions {
  /// Contact with bones, teeth and the other lip, and one-sided ligaments. The bones must be closed surfaces.
  bool contact = true;
  std::vector<LevelOptions> levels = {{"low", 700, 0.45}, {"medium", 2000, 0.32}, {"high", 5000}};
  double lining = 0.010;         ///< how far the simulated skin goes on over lips and lids into the openings
  double edge_ratio = 2.7;       ///< edge length far from lips and lids over that at them
  double edge_growth = 0.045;    ///< distance over which it grows
  double corner_growth = 0.012;  ///< distance over which it grows
  ForEach for_each;              ///< parallel execution over levels; results do not depend on it
};

}  // namespace fascia::tissue
