#pragma once

#include <cstdint>
#include <vector>

#include "builder/geodesics/surface.h"

namespace fascia::geodesics {

/// Statistics of a path, for logs and tests (the counts of Aina 2011, section 5.3.1).
struct PathCounters {
  int traced_triangles = 0;        ///< triangles the first strip crosses
  bool cut = false;                ///< the projected trace stalled and the strip was cut by a plane instead
  bool searched = false;           ///< that ran out too and the strip was searched instead
  int searched_vertices = 0;       ///< vertices the search visited
  int passes = 0;                  ///< times the strip was pulled taut
  int rerouted_vertices = 0;       ///< vertices the strip was led around on the other side
  int pinned_vertices = 0;         ///< vertices the final path goes through
  int straight_lengths = 0;        ///< maximal runs without a turn in the final path
  int first_straight_lengths = 0;  ///< the same after the first pass
  /// Largest |left − right| / (left + right) at an interior vertex that pins the path: zero is straight
  /// in the sense of Polthier and Schmies, what fixed ends leave at a hyperbolic vertex is not.
  double unevenness = 0.0;
  bool converged = true;  ///< no vertex is left that the path could be shortened around
};

/// A geodesic as the points where it starts, crosses edges or passes vertices, and ends.
///
/// The segment between points i and i+1 lies in triangle `points[i+1].triangle`.
struct Path {
  std::vector<SurfacePoint> points;
  std::vector<Vec3> positions;  ///< of `points`, metres
  double length = 0.0;          ///< metres, in the surface's inner geometry
  PathCounters counters;
};

struct PathOptions {
  /// A vertex is led around when the angle on the far side is below π by more than this, radians.
  double angle_tolerance = 1e-9;
  /// Passes after which a path is given back as it is, with `converged` false.
  int maximum_passes = 2000;
  /// Search the strip at once instead of tracing by vector projection first.
  bool search_first = false;
};

/// Scratch memory, so that only the first path on a surface allocates: one per thread, passed to every call.
class Workspace {
 public:
  /// Strips: half-edges crossed, each in the triangle that is left.
  std::vector<int> strip, rerouted;
  /// Search and trace marks, valid where the stamp equals `epoch`.
  std::vector<uint32_t> triangle_stamp, vertex_stamp, vertex_done;
  std::vector<double> vertex_cost;
  std::vector<int> vertex_parent, vertex_entry, way, left_turn, right_turn;
  std::vector<std::pair<double, int>> heap;
  uint32_t epoch = 0;
  /// Unfolded strip and funnel.
  struct Node {
    Vec2 place = Vec2::Zero();
    int first = 0, last = 0;  // crossings of the strip at which the node is the left or right end
    int parent = -1;
    bool left = false;
  };
  std::vector<Node> nodes;
  std::vector<int> left_node, right_node, funnel, taut;
  /// For each point of the last path, the crossing of `strip` at which it lies (0 at the start, the
  /// number of crossings at the end): the segment before it lies in the triangle left there.
  std::vector<int> point_crossing;
};

/// The locally shortest path from `from` to `to`: a strip of triangles by vector projection (Aina 2011,
/// section 5.2; by A* search over edges if that fails), straightened by the funnel algorithm (section 5.3),
/// and rerouted around every vertex that shortens it (section 5.4), until at each vertex it passes both sides
/// measure at least π. That is a locally shortest path; no homotopic change near it shortens it. After Aina
/// 2011, chapter 5; Lee & Preparata 1984 (funnel); Xin & Wang 2007 (strips).
///
/// The same points in reverse give the same path reversed, bit by bit. O(triangles crossed) a pass.
/// Throws `Error` when the ends lie on parts that no chain of triangles connects.
Path connect(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
             const PathOptions& options, Workspace& workspace);

/// As above with a workspace and options of its own; for single paths.
Path connect(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
             const PathOptions& options = {});

/// As above into `path`, reusing its memory.
void connect_into(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                  const PathOptions& options, Workspace& workspace, Path& path);

/// Straightens the path from `from` to `to` through `workspace.strip` within its class, into `path`.
/// The strip's first triangle holds `from`, its last `to`.
void straighten_strip(const Surface& surface, SurfacePoint from, SurfacePoint to, const PathOptions& options,
                      Workspace& workspace, Path& path);

/// The point at `distance` metres along `path` (clamped to its ends).
SurfacePoint point_along(const Surface& surface, const Path& path, double distance);

/// `count` ≥ 2 points at equal distances along `path`, ends included.
std::vector<SurfacePoint> resample(const Surface& surface, const Path& path, int count);

}  // namespace fascia::geodesics
