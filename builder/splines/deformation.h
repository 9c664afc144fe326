#pragma once

// Deformations from landmarks that carry more than a position: vectors, triads and surface normals.
//
// This work is based on:
// F. Bookstein, W. Green. A feature space for edgels in images with landmarks. 1993
// K. Mardia, J. Kent, C. Goodall, J. Little. Kriging and splines with derivative information. 1996

#include <optional>
#include <span>
#include <vector>

#include "builder/splines/warp.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// A vector at a landmark and what the deformation makes of it: J v = image.
struct CarriedVector {
  Vec3 vector = Vec3::Zero();
  Vec3 image = Vec3::Zero();
};

/// The normal of a surface at a landmark before and after: the tangent plane is carried to the tangent plane,
/// n' . (J t) = 0 for both tangents t of n; how the tangents turn and stretch in it is left to the spline.
struct CarriedNormal {
  Vec3 source = Vec3::Zero();
  Vec3 target = Vec3::Zero();
};

struct DeformationLandmark {
  Vec3 source = Vec3::Zero();
  Vec3 target = Vec3::Zero();
  double weight = 1;                   ///< see Sites
  std::vector<CarriedVector> vectors;  ///< one: an edge or crease; two or three: a frame
  std::optional<CarriedNormal> normal;
  double derivative_weight = 1;  ///< of vectors and normal

  /// Adds the vectors that make the Jacobian at the landmark equal to `jacobian`.
  void carry_frame(const Mat3& jacobian, int dimension = 3);
};

struct DeformationOptions {
  int dimension = 3;    ///< 2: the plane, z is left alone
  double exponent = 3;  ///< above 2; smaller is more local
  int degree = -1;      ///< see SplineOptions
  double lambda = 0;
};

/// The least bending map that carries every landmark with its vectors and normal.
/// Throws Error for dependent vectors at a landmark, coinciding landmarks, or anything Factorisation refuses.
Warp fit_deformation(std::span<const DeformationLandmark> landmarks, const DeformationOptions& options = {});

}  // namespace fascia::splines
