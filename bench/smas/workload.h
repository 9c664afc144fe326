#pragma once

#include <functional>
#include <vector>

#include "builder/splines/spline.h"
#include "geometry/mesh.h"

/// The surface that all mesh, and what each makes of it.
namespace fascia::bench {

/// Zero set of a triharmonic spline of 2,000 centres: 1,000 points on the surface of something like a head
/// with brow, nose and chin, and as many inside. Metres; it lies within a ball of `ball_radius` about the
/// origin.
splines::Spline head_like_surface();
constexpr double ball_radius = 0.15;

/// Closed-form radius of the surface that the points were taken from, along the unit `direction`.
double head_like_radius(const Vec3& direction);

struct Meshed {
  TriangleMesh mesh;
  double seconds = 0.0;  ///< processor time, field evaluations included
  long evaluations = 0;  ///< of the field
};

/// CGAL's surface mesher with facets of circumradius at most `radius` and angles of at least 30 degrees,
/// vertices within `tolerance` of the surface. The field is asked for values only.
Meshed mesh_by_cgal(const splines::Spline& field, double radius, double tolerance);

/// VTK's marching cubes on a grid of cells `cell` wide over the surface's box with one cell around, sampled
/// in one go.
Meshed mesh_by_vtk(const splines::Spline& field, const Bounds& box, double cell);

/// Processor time of this thread, seconds: other programs on the machine do not count.
double processor_time();

}  // namespace fascia::bench
