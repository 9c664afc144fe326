#pragma once

#include <vector>

#include "builder/landmarks/placement.h"
#include "builder/splines/warp.h"

namespace fascia::landmarks {

/// One stage of the fit.
struct RegistrationStage {
  double lambda;  ///< smoothing of the thin plate, metres; about (smoothing length)^3 / (point spacing)^2
  int stride;     ///< uses every stride-th point of the generic face; residuals are those of the last stage
  int rounds;     ///< number of iterations of closest points and spline
};

struct RegistrationOptions {
  std::vector<RegistrationStage> stages;
  double reach = 0.03,
         last_reach = 0.006;  ///< correspondences farther than this are ignored: first, last stage
};

/// A few stiff stages on few points: sufficient for a face score, and for the location of parts within a few
/// millimetres.
RegistrationOptions coarse_fit();

/// The generic head deformed onto a mesh.
struct Registration {
  Placement placement;
  splines::Warp warp;              ///< generic head's frame onto itself; `placement` leads on to the mesh
  std::vector<int> used;           ///< indices into GenericFace::points
  std::vector<double> residuals;   ///< of those, to the plane of the surface there, metres of the generic
                                   ///< head; infinite: none found
  std::vector<double> agreements;  ///< cosine between the normals there
  std::vector<double> overhangs;   ///< how far along the generic surface the nearest place of the mesh is:
                                   ///< large beyond the mesh's edge
  std::vector<Vec3> feet,
      normals;  ///< where the surface is next to those points, and how it faces there; generic head's frame
  Vec3 operator()(const Vec3& generic) const { return placement(warp(generic)); }
};

/// Deforms the generic head by thin-plate splines onto `target` (in the mesh's frame): correspondences are
/// from a generic point to the nearest target samples with compatible normals, averaged over their tangent
/// plane, so that points are free to slide; stiffness decreases from stage to stage. `start` is an initial
/// warp.
Registration register_face(const GenericFace& face, const Samples& target, const Placement& placement,
                           const std::vector<Anchor>& anchors = {},
                           const RegistrationOptions& options = coarse_fit(),
                           const splines::Warp& start = {});

/// The similarity transform contained in the deformation of `fit`; the remaining deformation is that of
/// proportions. A few iterations converge to the same placement from any start.
Placement similarity_of(const GenericFace& face, const Registration& fit);

/// Metres along the surface from which on a point is beyond the mesh's edge: samples are some 4 mm apart.
inline constexpr double beyond_edge = 0.008;

/// The overhang about a place on the generic head: that of the nearest of the fit's points, median of three.
double overhang_at(const GenericFace& face, const Registration& fit, const Vec3& generic);

/// The distance from the surface about a place on the generic head, likewise, metres of the generic head.
double residual_at(const GenericFace& face, const Registration& fit, const Vec3& generic);

}  // namespace fascia::landmarks
