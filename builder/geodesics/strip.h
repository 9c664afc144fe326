#pragma once

#include "builder/geodesics/path.h"

namespace fascia::geodesics {

/// Appends a crossing; one that undoes the crossing before it cancels with it.
void push_crossing(const Surface& surface, std::vector<int>& strip, int half_edge);

/// Turns a strip around: the same triangles, crossed from its other end.
void turn_strip(const Surface& surface, std::vector<int>& strip);

/// Fills `workspace.strip` with the edges crossed on the way from `from` to `to` by steps towards `to`
/// projected into each triangle, sliding along ridges, valleys and rims. Returns false when the walk
/// stalls: in the corner of a rim, or when it returns to a triangle it has left.
bool trace_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                 Workspace& workspace);

/// Fills `workspace.strip` with the triangles that the plane through both ends and along the mean of their
/// normals cuts on the way from `from` to `to` (Lee, Han & Lee 2006). Returns false when the cut runs into a
/// rim, passes `to` by, or grows much longer than the distance.
bool cut_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
               Workspace& workspace);

/// Fills `workspace.strip` with triangles along the shortest way over vertices and edges (A*, with an
/// estimate that allows for the zigzag). Both ends must be in one piece. Returns the number of vertices
/// visited.
int search_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                 Workspace& workspace);

}  // namespace fascia::geodesics
