#pragma once

#include <functional>
#include <vector>

#include "builder/smas/implicit_function.h"

namespace fascia::smas {

/// How `marching_triangles` meshes a surface. Lengths are in the unit of the function's points.
///
/// Which edge length to take: a facet of edge L over radius of curvature R stands off the true
/// surface by about L^2/(6R) at its middle, so L = sqrt(6 R sag). For a skull or head in metres,
/// `edge_length` .004 with `min_edge_length` .0015 keeps orbital rims, teeth sockets and the alae
/// (R of 3 mm or more) within .2 mm; a flat .004 is right for the SMAS. A crease sharper than the
/// shortest edge comes out rounded at that length.
struct MarchingOptions {
  /// Length of edges where the surface is flat.
  double edge_length = 0.004;
  /// Shortest edges, taken where the surface bends; 0 or >= `edge_length`: uniform edges.
  double min_edge_length = 0.0;
  /// How far the normal may turn along one edge before edges get shorter, in radians.
  double max_normal_turn = 0.35;
  /// How close to the surface vertices lie: |f|/|grad f| at most this part of `edge_length`.
  double tolerance = 1e-6;
  /// Where the surface may have vertices; empty: everywhere. A surface that does not close on
  /// itself within the domain ends in a boundary up to one edge length inside it.
  std::function<bool(const Vec3&)> domain;
  /// Points near the surface to start from, at least one on each part that is wanted; those that
  /// lead to a part already meshed cost one evaluation or so.
  std::vector<Vec3> seeds;
  /// Flip, split, collapse and smooth afterwards (surface_quality.h).
  bool improve = true;
  /// More vertices than this are an error: the surface runs away.
  int max_vertices = 2'000'000;
};

/// A polygonised surface and what it took.
struct MarchingResult {
  TriangleMesh mesh;
  /// Unit normals (gradient directions) at the vertices.
  std::vector<Vec3> normals;
  /// The length that edges at each vertex were meant to have.
  std::vector<double> sizes;
  /// Calls of the function.
  long evaluations = 0;
  /// Connected parts.
  int parts = 0;
  /// Edges with a triangle on one side only: 0 for a closed surface.
  int boundary_edges = 0;
};

/// Meshes the zero set of `function` by marching triangles.
///
/// Grows a front of triangles from each seed. A new vertex is found by spinning a triangle about the
/// front edge until it meets the surface, starting from the curvature that the neighbouring normals
/// foretell, so that one or two evaluations a vertex are enough. A triangle is accepted when its
/// circumsphere holds no vertex of the same orientation (found in a hash grid) and crosses no front;
/// else the front closes onto the vertex in the way that a Delaunay triangulation would, which leaves
/// no gaps between fronts. Sheets that face each other, however near, never join.
/// The mesh is oriented with the gradient; the same input gives the same bytes.
///
/// Based on: A. Hilton, A. Stoddart, J. Illingworth and T. Windeatt, "Marching triangles: range image
/// fusion for complex object modelling", ICIP 1996; S. Akkouche and E. Galin, "Adaptive implicit
/// surface polygonization using marching triangles", Computer Graphics Forum 20(2), 2001; M. Cermak and
/// V. Skala, "Polygonization of implicit surfaces with sharp features by edge-spinning", The Visual
/// Computer 21, 2005; E. Hartmann, "A marching method for the triangulation of surfaces", The Visual
/// Computer 14, 1998.
///
/// @throws Error when no seed reaches the surface, an option is out of range, or the surface outgrows
/// `max_vertices`.
MarchingResult marching_triangles(const ImplicitFunction& function, const MarchingOptions& options);

/// Seeds for surfaces about which nothing is known: points of a grid of spacing `spacing` over `box`
/// next to which `function` changes sign, each moved to the surface. Costs one value a grid point.
std::vector<Vec3> grid_seeds(const ImplicitFunction& function, const Bounds& box, double spacing);

}  // namespace fascia::smas
