#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::skull {

/// Where points of the generic's teeth belong on teeth that the head has.
struct TeethMatch {
  Mat4 similarity = Mat4::Identity();  ///< generic teeth -> the head's
  double rms = 0;                      ///< m, of the trimmed nearest distances
};

/// Registers generic teeth to the head's own by trimmed iterated closest points, starting from `start`
/// (generic -> head). Only the front and sides of crowns that find a partner within 4 mm count, at most
/// 80 % of the points.
/// P. Besl, N. McKay. A method for registration of 3-D shapes. 1992; D. Chetverikov et al. The trimmed ICP.
/// 2002.
TeethMatch match_teeth(const TriangleMesh& generic, const TriangleMesh& actual, const Mat4& start);

/// About `count` points spread evenly over the vertices of `mesh`, by farthest-point sampling.
std::vector<Vec3> spread_points(const TriangleMesh& mesh, int count);

/// The same points and their mirror images in x: the generic is symmetric, a choice of its points must be
/// too.
std::vector<Vec3> symmetric_points(const TriangleMesh& mesh, int count);

}  // namespace fascia::skull
