#pragma once

#include "builder/geodesics/path.h"

namespace fascia::geodesics {

struct TraceResult {
  Path path;
  /// The trace ended at a boundary or a non-manifold edge before its full length.
  bool reached_boundary = false;
  int crossings = 0;        ///< edges crossed
  int vertices_passed = 0;  ///< vertices run straight through
};

struct TraceOptions {
  /// Keep the points of the path; without, only its two ends.
  bool points = true;
  /// Distance from a vertex, in lengths of the edge crossed, within which the path goes through it.
  double vertex_tolerance = 1e-12;
  /// Crossings after which a trace stops.
  int maximum_crossings = 100000000;
};

/// The straightest geodesic from `start` in `direction` (projected into the start triangle) for
/// `length` metres: straight within triangles and over unfolded edges, dividing the angle of every
/// vertex it meets into equal halves (Polthier & Schmies 1998, "Straightest Geodesics on Polyhedral
/// Surfaces", definition 8). From a vertex or an edge a direction that leaves `start`'s triangle is
/// carried on into the triangle it points to. Throws `Error` when `direction` has no part in the
/// triangle's plane, or `length` is negative or not finite.
TraceResult trace(const Surface& surface, const SurfacePoint& start, const Vec3& direction, double length,
                  const TraceOptions& options = {});

}  // namespace fascia::geodesics
