#include "builder/smas/surface_quality.h"

#include <cmath>

#include "builder/smas/relax.h"
#include "builder/smas/surface_edits.h"
#include "builder/smas/triangle_shape.h"

namespace fascia::smas {

TriangleQuality triangle_quality(const TriangleMesh& mesh) {
  TriangleQuality quality;
  if (mesh.empty()) return quality;
  quality.min_angle = 180.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double angle = std::acos(std::min(smallest_angle_cosine(a, b, c), 1.0)) * 180.0 / M_PI;
    quality.min_angle = std::min(quality.min_angle, angle);
    quality.mean_min_angle += angle;
    const double x = (b - c).norm(), y = (c - a).norm(), z = (a - b).norm();
    // 2 r / R = (y+z-x)(z+x-y)(x+y-z) / (xyz)
    if (x * y * z > 0.0) quality.mean_radius_ratio += (y + z - x) * (z + x - y) * (x + y - z) / (x * y * z);
  }
  quality.mean_min_angle /= mesh.triangle_count();
  quality.mean_radius_ratio /= mesh.triangle_count();
  return quality;
}

long improve_triangles(const ImplicitFunction& function, const QualityOptions& options, TriangleMesh* mesh,
                       std::vector<Vec3>* normals, std::vector<double>* sizes) {
  SurfaceField field{function, options.tolerance};
  SurfaceMesh work(*mesh, *normals, *sizes);
  const BoundaryMotion boundary{options.move_boundary, options.boundary_smoothing};
  for (int pass = 0; pass < options.passes; ++pass) {
    split_long_edges(&field, &work);
    collapse_short_edges(options.feature_turn, &work);
    flip_edges(options.feature_turn, &work);
    smooth_along_surface(boundary, &work);
    smooth_along_surface(boundary, &work);
  }
  flip_edges(options.feature_turn, &work);
  relax_worst(boundary, 0.6, {}, &work);
  settle(&field, &work);
  flip_edges(options.feature_turn, &work);
  mesh->vertices = std::move(work.points);
  mesh->triangles = std::move(work.triangles);
  *normals = std::move(work.normals);
  *sizes = std::move(work.sizes);
  return field.evaluations;
}

}  // namespace fascia::smas
