#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "rig/model/rig.h"

namespace fascia::tissue {

/// One primitive of the user's file: what must follow the face in the end.
struct PartMesh {
  std::string part;  ///< skin, eye_left, eye_right, eye_surround, teeth_upper, teeth_lower, gums_upper,
                     ///< gums_lower, mouth_interior, tongue, lashes, brows, hair, other
  std::vector<Vec3> vertices;  ///< metres, in the file's order
  std::vector<fascia::Triangle> triangles;
  std::vector<int> skin_vertices =
      {};  ///< of a skin part: the vertex of `TissueInputs::skin` each one is, or none known
};

/// All that the lattice is made from. Metres; see rig/model/rig.h for axes.
struct TissueInputs {
  TriangleMesh skin;                        ///< welded; lips and lids open as the mesh has them
  std::map<std::string, Vec3> landmarks;    ///< on the skin, by full name
  TriangleMesh cranium, mandible;           ///< fitted, teeth apart or not
  TriangleMesh smas;                        ///< may be empty: then it lies at a share of the depth to bone
  std::vector<float> smas_bone_attachment;  ///< #smas vertices, 0 gliding .. 1 firm; may be empty
  std::vector<float> smas_skin_attachment;  ///< the same, to the skin
  rig::JawJoint jaw;
  rig::Eye eye_left, eye_right;          ///< radius 0: found from the lids' landmarks
  std::vector<rig::Ligament> ligaments;  ///< used with TissueOptions::contact
  std::vector<rig::Muscle> muscles;
  std::vector<rig::Channel> channels;
  std::vector<PartMesh> parts;
};

/// What the tissue is made of. Moduli in pascal, lengths in metres; each figure's source beside it.
struct TissueMaterial {
  double skin_modulus = 14e3;  ///< Young's: 3 x shear 4.7 kPa, within 1.4..6.4 (Barbarino 2008; Picard 2026)
  double skin_thickness = 0.0017;  ///< mean of 1.51..1.97 mm (Chopra 2015)
  double smas_modulus = 15e3;      ///< resting mimic muscle, shear-wave elastography
  double smas_thickness = 0.002;
  double bending_factor =
      15.0;  ///< of a thin plate's rigidity: layers are not one plate, fat and retinacula stiffen them
  double fat_modulus = 8e3;            ///< across the layer between skin and SMAS, retinacula included
  double fat_shear = 2.5e3;            ///< of that layer where the SMAS is firmly attached to the skin
  double glide_shear = 350.0;          ///< of the plane between SMAS and bone at mean attachment
  double glide_normal = 12e3;          ///< across it: bone lets nothing sink, what lies on air may give
  double glide_depth = 0.005;          ///< that the two refer to
  double volume_modulus = 4e4;         ///< between skin and SMAS
  double inner_volume_modulus = 1e3;   ///< between SMAS and what lies behind: fat that may flow aside
  double density = 1000.0;             ///< kilogram a cubic metre
  double fibre_shortest_factor = 1.6;  ///< the pull ends at this multiple of the muscle's peak shortening
  double insertion_spread = 0.006;     ///< over which a fibre's pull comes in at its free end
  double mouth_pressure = 3500.0;  ///< behind the cheeks at channel value 1; trumpeters blow with 1 to 25 kPa
                                   ///< (Fletcher & Tarnopolsky 1999)
  double gum_hold =
      480.0;  ///< pascal: stiffness a length with which the gums hold the lips' lining at its fold
  double lip_drive = 1.5e5;  ///< pascal per metre: stiffness an area with which lips follow their roll
  double lid_hold = 1.0e6;   ///< pascal per metre: stiffness an area with which the tarsal plates keep their
                             ///< place on the globe
};

/// How fine a level is: roughly how many columns, and how edge length grows from lips and lids outward.
struct LevelOptions {
  std::string name = "medium";
  int columns = 2000;
  /// Edge length at the mouth's corners over that along the lips. The corner opens like a crack, wider the
  /// finer its tip is cut: medium and high cut it alike, at some 0.9 mm.
  double corner_ratio = 0.5;
};

struct TissueOptions {
  TissueMaterial material;
  /// Contact with bones, teeth and the other lip, and one-sided ligaments. The bones must be closed surfaces.
  bool contact = true;
  std::vector<LevelOptions> levels = {{"low", 700}, {"medium", 2000, 0.32}, {"high", 5000}};
  double lining = 0.010;         ///< how far the simulated skin goes on over lips and lids into the openings
  double edge_ratio = 2.7;       ///< edge length far from lips and lids over that at them
  double edge_growth = 0.045;    ///< distance over which it grows
  double corner_growth = 0.012;  ///< distance over which it grows
};

}  // namespace fascia::tissue
