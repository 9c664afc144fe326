#pragma once

#include <vector>

#include "builder/landmarks/placement.h"
#include "builder/splines/warp.h"

namespace fascia::landmarks {

/// A point of the generic head that must come to lie at a known one of the target.
struct Anchor {
  Vec3 generic, target;  ///< generic head's frame; mesh's frame
  double weight = 1.0;   ///< of a correspondence found is at most 1
};

struct RegistrationOptions {
  int stride = 1;  ///< takes every so many points of the generic face
  /// Smoothing of the thin plate (metres), from stage to stage; about (smoothing length)^3 / (point spacing)^2.
  std::vector<double> lambdas = {10, 3, 1, 0.3, 0.1, 0.03, 0.01};
  int rounds = 2;  ///< closest points and spline anew, so often a stage
  double reach = 0.03, last_reach = 0.008;  ///< correspondences farther than this count for nothing: first, last stage
};

/// The generic head bent onto a mesh.
struct Registration {
  Placement placement;
  splines::Warp warp;              ///< generic head's frame onto itself; `placement` leads on to the mesh
  std::vector<int> used;           ///< indices into GenericFace::points
  std::vector<double> residuals;   ///< of those, to the plane of the surface there, metres of the generic head; infinite: none found
  std::vector<double> agreements;  ///< cosine between the normals there
  Vec3 operator()(const Vec3& generic) const { return placement(warp(generic)); }
};

/// Bends the generic head by thin-plate splines onto `target` (its frame: the mesh's): correspondences run from a
/// generic point to the nearest target samples that face the same way, averaged over their tangent plane, so that
/// points are free to slide; the plate softens from stage to stage.
Registration register_face(const GenericFace& face, const Samples& target, const Placement& placement,
                           const std::vector<Anchor>& anchors = {}, const RegistrationOptions& options = {});

/// How face-like the fit is: the share of the face's points whose surface is near and faces as it should.
double fitted_share(const GenericFace& face, const Registration& fit);

}  // namespace fascia::landmarks
