#pragma once

#include "builder/tissue/beneath.h"
#include "builder/tissue/mirror.h"
#include "builder/tissue/remesh.h"

namespace fascia::tissue {

/// The columns of one level: a remesh of the face region, with a point on the SMAS and one on bone or mucosa
/// under every vertex.
struct Columns {
  TriangleMesh mesh;                            ///< the skin nodes
  std::vector<SurfacePoint> source;             ///< #columns, on the region's mesh
  std::vector<Vec3> normals;                    ///< #columns, unit, smoothed
  std::vector<Vec3> smas, inner;                ///< #columns
  std::vector<double> smas_depth, inner_depth;  ///< #columns, metres
  std::vector<double> area;                     ///< #columns, square metres
  std::vector<bool> outer, rim;                 ///< seen from outside; on the fixed border
  std::vector<bool> bone;                       ///< bone lies behind, so the inner node rests on it
  std::vector<double>
      lower_lip;  ///< 0 of the upper lip .. 0.5 at the corner .. 1 of the lower, by the way along the surface
  std::vector<double> jaw_weight;                       ///< 0 carried by the cranium .. 1 by the mandible
  std::vector<double> feature_distance;                 ///< metres to the nearest lip, lid or nostril edge
  std::array<std::vector<double>, 5> opening_distance;  ///< by Opening
  int count() const { return mesh.vertex_count(); }
};

/// Builds the columns of `level` from the region and the layers beneath it. On a symmetric face the right
/// ones are mirror images of the left ones where the skin permits, because different triangulations of the
/// same skin move differently.
Columns make_columns(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath,
                     const std::optional<Symmetry>& symmetry, const LevelOptions& level,
                     const TissueOptions& options);

}  // namespace fascia::tissue
