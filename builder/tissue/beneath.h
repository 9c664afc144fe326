#pragma once

#include "builder/tissue/region.h"

namespace fascia::tissue {

/// The bones behind the skin: meshes with their teeth and gums.
struct Bones {
  TriangleMesh cranium, mandible;
};
Bones bones_of(const TissueInputs& inputs);

/// Layers beneath each vertex of the region, computed once so that all levels sample the same data.
struct Beneath {
  std::vector<Vec3> normals;                    ///< unit, smoothed; layers lie in the opposite direction
  std::vector<double> smas_depth, inner_depth;  ///< metres
  std::vector<double> bone;  ///< 1 where bone lies behind the skin, so that the inner node is on it
  std::vector<double>
      lower_lip;  ///< 0 of the upper lip .. 0.5 at the corner .. 1 of the lower, by the way along the surface
  std::vector<double> jaw_weight;  ///< 0 moves with the cranium .. 1 with the mandible
};
Beneath find_beneath(const TissueInputs& inputs, const FaceRegion& region, const TissueOptions& options);

/// How long edges are that far from lips and lids, over their length beside them.
double edge_growth(const TissueOptions& options, double feature_distance);

/// The lips as the jaw's influence needs them: how far each vertex lies from their edge along the surface,
/// and to which it belongs (Beneath::lower_lip).
struct Lips {
  std::vector<double> distance, lower;
};

/// Which lip each vertex of `mesh` belongs to: from the skin clearly above and clearly below the mouth,
/// `distance` from whose edge is given, it is asked which is nearer along the surface. Lips that touch stay
/// apart: only the corner joins them.
std::vector<double> lower_lip(const TissueInputs& inputs, const TriangleMesh& mesh,
                              const std::vector<bool>& outer, const std::vector<double>& distance);

/// How much of the jaw's motion carries each vertex of `mesh`: 1 and 0 where mandible or cranium clearly lies
/// nearer, 0 where skin is `still`, on the rim and the nose, and between a smooth field over the surface
/// (screened Laplace equation), which does not cross from lip to lip.
std::vector<double> jaw_weights(const TriangleMesh& mesh, const std::vector<bool>& still, const Bones& bones,
                                const Lips& lips, const anatomy::mechanics::JawInfluence& influence);

}  // namespace fascia::tissue
