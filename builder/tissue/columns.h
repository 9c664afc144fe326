#pragma once

#include "builder/tissue/region.h"
#include "builder/tissue/remesh.h"

namespace fascia::tissue {

/// What the bones behind the skin are: meshes with their teeth and gums.
struct Bones {
  TriangleMesh cranium, mandible;
};
Bones bones_of(const TissueInputs& inputs);

/// The columns of one level: a remesh of the face region, with a place on the SMAS and one on bone or mucosa
/// under every vertex.
struct Columns {
  TriangleMesh mesh;                 ///< the skin nodes
  std::vector<SurfacePoint> source;  ///< #columns, on the region's mesh
  std::vector<Vec3> normals;         ///< #columns, unit, smoothed
  std::vector<Vec3> smas, inner;     ///< #columns
  std::vector<double> smas_depth, inner_depth;  ///< #columns, metres
  std::vector<double> area;          ///< #columns, square metres
  std::vector<bool> outer, rim;      ///< seen from outside; on the fixed border
  std::vector<bool> bone;            ///< bone lies behind, so the inner node rests on it
  std::vector<double> lower_lip;     ///< 0 of the upper lip .. 0.5 at the corner .. 1 of the lower, by the way along the surface
  std::vector<double> jaw_weight;    ///< 0 carried by the cranium .. 1 by the mandible
  std::vector<double> feature_distance;                 ///< metres to the nearest lip, lid or nostril edge
  std::array<std::vector<double>, 5> opening_distance;  ///< by Opening
  int count() const { return mesh.vertex_count(); }
};

/// Makes the columns of `level` from the region.
Columns make_columns(const TissueInputs& inputs, const FaceRegion& region, const LevelOptions& level,
                     const TissueOptions& options);

/// The lips as the jaw's influence needs them: how far each vertex lies from their edge along the surface, and to which
/// it belongs (Columns::lower_lip).
struct Lips {
  std::vector<double> distance, lower;
};

/// Which lip each vertex of `mesh` belongs to: from the skin clearly above and clearly below the mouth, `distance` from
/// whose edge is given, it is asked which is nearer along the surface. Lips that touch stay apart: only the corner joins them.
std::vector<double> lower_lip(const TissueInputs& inputs, const TriangleMesh& mesh, const std::vector<bool>& outer,
                              const std::vector<double>& distance);

/// How much of the jaw's motion carries each vertex of `mesh`: 1 and 0 where mandible or cranium clearly lies nearer,
/// 0 on the rim, and between a smooth field over the surface (screened Laplace equation), which does not
/// cross from lip to lip.
std::vector<double> jaw_weights(const TriangleMesh& mesh, const std::vector<bool>& rim, const Bones& bones,
                                const Lips& lips);

}  // namespace fascia::tissue
