#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "builder/spatial/surface_query.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

/// The first stage: from a mesh file to a head with known units, axes and parts.
namespace fascia::prepare {

/// The class of a piece of the input, which determines what it follows when the face moves.
enum class Part {
  skin,
  eye_left,
  eye_right,
  eye_surround,  ///< lacrimal, tear line, occlusion and blend meshes that lie on the lids
  teeth_upper,
  teeth_lower,
  gums_upper,
  gums_lower,
  mouth_interior,  ///< gums of both jaws in one, palate, floor of the mouth: between cranium and mandible
  tongue,
  lashes,
  brows,
  hair,
  glasses,  ///< fixed to the skull
  clothes,  ///< stay where they are
  other     ///< rest of a body: fixed, except pieces close to the face
};

/// Name as it stands in files: skin, eye_left, teeth_upper, ...
const char* part_name(Part part);

/// One mesh of the scene, vertex order kept.
struct PreparedMesh {
  std::string name;
  std::vector<Vec3> positions;  ///< metres, rig frame
  std::vector<Triangle> triangles;
  std::vector<Part> parts;  ///< one a vertex
  std::vector<int>
      skin_vertices;  ///< vertex of PreparedHead::skin, -1 for other parts and vertices of slivers alone
};

/// An eyeball found in the input.
struct Eyeball {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;  ///< metres
  Vec3 gaze =
      Vec3::UnitZ();  ///< unit vector: through cornea or pole of the mesh, straight ahead where neither shows
};

struct PreparedHead {
  std::vector<PreparedMesh> meshes;              ///< one for each mesh of the scene, same order
  TriangleMesh skin;                             ///< welded, without slivers, metres, rig frame
  std::optional<spatial::SurfaceQuery> surface;  ///< of `skin`; there once prepared, shared by its copies
  Landmarks landmarks;                           ///< the given ones, on the skin, metres, rig frame
  std::optional<Eyeball> eye_left, eye_right;
  Mat4 input_to_metres = Mat4::Identity();  ///< from file coordinates to the rig frame
  std::string units;                        ///< "m", "dm", "cm", "mm", "in" or metres a unit
  std::vector<std::string> warnings;
};

struct PrepareOptions {
  std::string units = "auto";             ///< auto, m, cm, mm, or metres a unit as a number
  std::string up = "auto";                ///< auto, y or z
  std::string skin;                       ///< name of the mesh that is the skin; empty: found
  std::set<std::string> rough_landmarks;  ///< only roughly placed: how far they are off the skin says nothing
};

/// Units of a landmark file that are known to be the head file's own.
inline constexpr const char* head_units = "head";

/// The landmarks' coordinates in the head file's units: of the decimal ratios the one that puts them on the
/// surface, for a landmark file may be in millimetres beside a head in metres.
formats::LandmarkFile in_file_units(const formats::Scene& scene, const formats::LandmarkFile& given);

/// All meshes of `scene` as one, in the file's axes and units; of the mesh named `only` alone when that is
/// not empty. Throws fascia::Error, naming the meshes there are, when `only` names none.
TriangleMesh joined_meshes(const formats::Scene& scene, const std::string& only = "");

/// Subsets of `scene` to search for a head, the most likely first, in the file's axes and units: all of it
/// without the meshes whose names say hair, clothes, glasses, lashes or brows; all of it; then its largest
/// meshes one by one, for hair and hats that no name tells. The mesh named `only` alone when that is not
/// empty. Throws as `joined_meshes` does.
std::vector<TriangleMesh> search_surfaces(const formats::Scene& scene, const std::string& only = "");

/// Finds units, axes and parts of `scene`, and welds its skin.
///
/// `given` are the landmarks by hand, `reference` the generic head's skin landmarks by the same names
/// (metres, rig frame): size, up and facing follow from comparing the two, so at least three common ones that
/// are not in line are needed when `given` is not empty. Without landmarks glTF's own convention (metres, +Y
/// up, +Z front) holds, other files are judged by their extent.
///
/// Vertices are welded only where the mesh has open edges, so lips and lids that touch stay apart.
/// Throws fascia::Error naming file and landmark when a landmark lies off the surface, units or axes
/// cannot be told, or the named skin is not there.
PreparedHead prepare(const formats::Scene& scene, const formats::LandmarkFile& given,
                     const Landmarks& reference, const PrepareOptions& options);

/// Changes the rig frame: every position p of `head` becomes rotation * p + translation (metres), directions
/// are rotated, and so is the map that leads from the file.
void move(PreparedHead& head, const Mat3& rotation, const Vec3& translation);

}  // namespace fascia::prepare
