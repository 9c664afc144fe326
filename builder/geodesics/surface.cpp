#include "builder/geodesics/surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::geodesics {

namespace {

void check_mesh(const TriangleMesh& mesh, const std::string& name) {
  if (mesh.empty()) throw Error(name + ": no triangles; a geodesic needs a surface");
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.vertices[v].allFinite())
      throw Error(name + ": vertex " + std::to_string(v) + " is not a finite point; repair the mesh");
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    for (int corner : corners)
      if (corner < 0 || corner >= mesh.vertex_count())
        throw Error(name + ": triangle " + std::to_string(t) + " names vertex " + std::to_string(corner) +
                    ", which does not exist; repair the mesh");
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
      throw Error(name + ": triangle " + std::to_string(t) +
                  " names a vertex twice; weld and repair the mesh");
  }
}

void link_twins(Surface& surface) {
  const Connectivity links = connectivity(surface.mesh);
  surface.twin.assign(surface.mesh.triangles.size() * 3, -1);
  for (int h = 0; h < static_cast<int>(surface.twin.size()); ++h) {
    const int across_triangle = links.neighbours[h / 3][h % 3];
    if (across_triangle < 0) continue;
    for (int e = 0; e < 3; ++e)
      if (surface.origin(3 * across_triangle + e) == surface.target(h) &&
          surface.target(3 * across_triangle + e) == surface.origin(h))
        surface.twin[h] = 3 * across_triangle + e;
  }
}

/// Edge lengths, lengthened alike until every triangle keeps a clear triangle inequality.
void measure_edges(Surface& surface) {
  const int count = static_cast<int>(surface.twin.size());
  surface.length.resize(count);
  double sum = 0.0;
  for (int h = 0; h < count; ++h) {
    surface.length[h] =
        (surface.mesh.vertices[surface.target(h)] - surface.mesh.vertices[surface.origin(h)]).norm();
    sum += surface.length[h];
  }
  const double mean = sum > 0.0 ? sum / count : 1.0;
  const double slack = 1e-10 * mean;
  for (int h = 0; h < count; ++h) {
    const double excess =
        surface.length[Surface::next(h)] + surface.length[Surface::previous(h)] - surface.length[h];
    surface.mollification = std::max(surface.mollification, slack - excess);
  }
  for (double& length : surface.length)
    length += surface.mollification;
}

void measure_triangles(Surface& surface) {
  const int count = static_cast<int>(surface.twin.size());
  surface.apex.resize(count);
  surface.angle.resize(count);
  for (int h = 0; h < count; ++h) {
    const double base = surface.length[h], far = surface.length[Surface::next(h)],
                 near = surface.length[Surface::previous(h)];
    const double x = (base * base + near * near - far * far) / (2.0 * base);
    // Heron in Kahan's order, exact to rounding for needles.
    double a = base, b = far, c = near;
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    const double product = (a + (b + c)) * std::max(c - (a - b), 0.0) * (c + (a - b)) * (a + (b - c));
    const double y = std::sqrt(std::max(product, 0.0)) / (2.0 * base);
    surface.apex[h] = Vec2(x / base, std::max(y / base, 1e-14));
    surface.angle[h] = std::atan2(y, x);
  }
}

void number_pieces(Surface& surface) {
  const int count = surface.mesh.triangle_count();
  surface.piece.assign(count, -1);
  std::vector<int> stack;
  int pieces = 0;
  for (int seed = 0; seed < count; ++seed) {
    if (surface.piece[seed] >= 0) continue;
    surface.piece[seed] = pieces;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (int e = 0; e < 3; ++e) {
        const int twin = surface.twin[3 * t + e];
        if (twin < 0 || surface.piece[twin / 3] >= 0) continue;
        surface.piece[twin / 3] = pieces;
        stack.push_back(twin / 3);
      }
    }
    ++pieces;
  }
}

}  // namespace

Surface make_surface(TriangleMesh mesh, const std::string& name) {
  check_mesh(mesh, name);
  Surface surface;
  surface.mesh = std::move(mesh);
  link_twins(surface);
  measure_edges(surface);
  measure_triangles(surface);
  number_pieces(surface);
  return surface;
}

SurfacePoint checked(const Surface& surface, const SurfacePoint& point) {
  if (point.triangle < 0 || point.triangle >= surface.mesh.triangle_count())
    throw Error("geodesic: point on triangle " + std::to_string(point.triangle) + ", but the surface has " +
                std::to_string(surface.mesh.triangle_count()) +
                "; project the point onto this surface first");
  if (!point.barycentric.allFinite() || point.barycentric.cwiseMax(0.0).sum() <= 0.0)
    throw Error("geodesic: point on triangle " + std::to_string(point.triangle) +
                " has no valid barycentric weights; project the point onto this surface first");
  SurfacePoint clean = point;
  clean.barycentric = clean.barycentric.cwiseMax(0.0);
  clean.barycentric /= clean.barycentric.sum();
  for (int i = 0; i < 3; ++i)
    if (clean.barycentric[i] < 1e-12) clean.barycentric[i] = 0.0;
  clean.barycentric /= clean.barycentric.sum();
  return clean;
}

SurfacePoint across(const Surface& surface, int half_edge, const SurfacePoint& point) {
  const int twin = surface.twin[half_edge];
  SurfacePoint moved;
  moved.triangle = twin / 3;
  moved.barycentric[twin % 3] = point.barycentric[Surface::next(half_edge) % 3];
  moved.barycentric[Surface::next(twin) % 3] = point.barycentric[half_edge % 3];
  return moved;
}

SurfacePoint point_on_edge(int half_edge, double fraction) {
  SurfacePoint point;
  point.triangle = half_edge / 3;
  point.barycentric[half_edge % 3] = 1.0 - fraction;
  point.barycentric[Surface::next(half_edge) % 3] = fraction;
  return point;
}

double total_angle(const Surface& surface, int half_edge, bool* boundary) {
  if (boundary) *boundary = false;
  double sum = 0.0;
  int at = half_edge;
  do {
    sum += surface.angle[at];
    at = surface.twin[Surface::previous(at)];
  } while (at >= 0 && at != half_edge);
  if (at == half_edge) return sum;
  if (boundary) *boundary = true;
  for (at = surface.twin[half_edge]; at >= 0; at = surface.twin[at]) {
    at = Surface::next(at);
    sum += surface.angle[at];
  }
  return sum;
}

}  // namespace fascia::geodesics
