#pragma once

#include <vector>

#include "builder/smas/layers.h"
#include "builder/smas/reach.h"
#include "builder/smas/surface_quality.h"
#include "geometry/mesh.h"

namespace fascia::smas {

/// What the SMAS is built from. All in metres, in one frame: face along +Z, +Y up.
struct Inputs {
  /// Skin, welded and oriented outwards; it may go on into mouth, nostrils and eye sockets.
  const TriangleMesh* skin = nullptr;
  /// Fitted bones; either may be null or empty, then free depths hold.
  const TriangleMesh* cranium = nullptr;
  const TriangleMesh* mandible = nullptr;
  /// Landmarks on the skin. Needed: exocanthion, endocanthion, palpebrale_superius, palpebrale_inferius,
  /// cheilion, alare and tragion of both sides, glabella, nasion, pronasale, subnasale, stomion,
  /// labiale_superius, labiale_inferius, gnathion. Used when there: all of the layer table, trichion,
  /// vertex, columella, subalare, preaurale, otobasion_superius, cervicale.
  Landmarks landmarks;
  std::vector<LayerSample> depths;      ///< of an adult, by region: `anatomy::Tissue::smas_depths`
  anatomy::mechanics::SmasShape shape;  ///< how far it reaches: `anatomy::Mechanics::smas_shape`
};

/// Inputs that hold the depths and the shape of `anatomy`; the rest is to be filled in.
Inputs inputs_from(const anatomy::GenericAnatomy& anatomy);

/// What the implicit function is told besides where it is 0.
enum class ImplicitForm {
  variational,  ///< its height at points over and under the surface (Turk and O'Brien)
  hermite,      ///< its gradient, the skin's normal, at every fourth point
};

/// How the SMAS is built. Lengths are for an adult face and scale with the face.
struct Options {
  double edge_length = 0.004;
  ReachOptions reach;
  ImplicitForm form = ImplicitForm::variational;
  /// Data of the implicit function at most: accuracy against time, which grows with the cube.
  int max_centres = 700;
  /// Distance to the depth asked for at which no more centres are added.
  double fit_tolerance = 0.0002;
};

/// The SMAS, and how it lies between skin and bone.
struct Result {
  TriangleMesh mesh;          ///< oriented outwards, one part, open at the outer limit, lids, mouth, nostrils
  std::vector<Vec3> normals;  ///< unit outward normals, one a vertex
  std::vector<double> skin_distance;      ///< thickness of skin and fat over each vertex, metres
  std::vector<double> bone_distance;      ///< distance to the nearer bone, metres; infinite without bones
  std::vector<SurfacePoint> skin_points;  ///< point of the given skin over each vertex
  /// Boundary loops as vertex numbers, longest first: the first is the outer limit.
  std::vector<std::vector<int>> boundary;
  int outside_layers = 0;  ///< vertices not strictly between bone and skin
  int folds = 0;           ///< triangles that face against their vertices' normals
  TriangleQuality quality;
  int centres = 0;  ///< data of the implicit function
  double fit_error =
      0.0;  ///< root mean square distance of the depths asked for to the function's surface, metres
  double depth_error = 0.0;  ///< the largest such distance, metres
  long evaluations = 0;
};

/// Builds the SMAS as an implicit surface between skin and bone.
///
/// Rays from the skin find the bone; zero points are put at the regional depth between them; a
/// triharmonic spline is fitted to a greedy choice of these and of points over and under them; marching
/// triangles polygonise its zero set; the mesh is trimmed along the lids, lips, nostrils and the outer
/// limit; and vertices that came too near to skin or bone are moved between them.
///
/// Based on: O. Aina, "Generating anatomical substructures for physically-based facial animation", 2011,
/// section 7.1; G. Turk and J. O'Brien, "Modelling with implicit surfaces that interpolate", 2002;
/// J. Carr et al., "Reconstruction and representation of 3D objects with radial basis functions", 2001
/// (greedy centres).
///
/// @throws Error when the skin is empty, landmarks are missing or lie off the skin, or no surface comes
/// about.
Result build(const Inputs& inputs, const Options& options = {});

}  // namespace fascia::smas
