#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::tissue {

struct RemeshOptions {
  int passes = 8;
};

/// A coarser or finer copy of a surface whose vertices know where on the source they lie.
struct RemeshResult {
  TriangleMesh mesh;
  std::vector<SurfacePoint> source;  ///< #vertices
};

/// Remeshes `source` so that edges near each place are about as long as `edge_length` (#source vertices,
/// metres): splits, collapses, flips and tangential smoothing (Botsch & Kobbelt 2004, "A remeshing approach
/// to multiresolution modeling"). Vertices move along the surface by walking from triangle to neighbouring
/// triangle, so sheets that lie against each other, such as closed lips, never exchange or join. Borders stay
/// on the border.
RemeshResult remesh(const TriangleMesh& source, const std::vector<double>& edge_length,
                    const RemeshOptions& options = {});

/// The factor by which `edge_length` must be multiplied for a remesh of about `vertices` vertices.
double edge_scale_for(const TriangleMesh& source, const std::vector<double>& edge_length, int vertices);

/// The point of `mesh` closest to `point` that a walk over neighbouring triangles from `start` comes to.
SurfacePoint walk_to(const TriangleMesh& mesh, const std::vector<std::vector<int>>& around, const Vec3& point,
                     int start);

/// The triangles around each vertex, ascending.
std::vector<std::vector<int>> triangles_around(const TriangleMesh& mesh);

}  // namespace fascia::tissue
