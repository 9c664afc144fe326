#pragma once

#include <cmath>
#include <functional>

#include "builder/geodesics/path.h"
#include "geometry/mesh.h"

namespace fascia::geodesics {

constexpr double kPi = 3.14159265358979323846;

/// A grid of `nu` by `nv` cells over [0,1]², carried by `place`; closed in u when `wrap`.
inline TriangleMesh grid(int nu, int nv, const std::function<Vec3(double, double)>& place,
                         bool wrap = false) {
  TriangleMesh mesh;
  const int columns = wrap ? nu : nu + 1;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i < columns; ++i)
      mesh.vertices.push_back(place(double(i) / nu, double(j) / nv));
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      const int a = j * columns + i, b = j * columns + (i + 1) % columns, c = a + columns, d = b + columns;
      if ((i + j) % 2) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, d, c});
      }
    }
  return mesh;
}

inline TriangleMesh plane(int n) {
  return grid(n, n, [](double u, double v) { return Vec3(u, v, 0.0); });
}

inline TriangleMesh cylinder(int around, int along, double radius, double height) {
  return grid(
      around, along,
      [&](double u, double v) {
        return Vec3(radius * std::cos(2 * kPi * u), radius * std::sin(2 * kPi * u), height * v);
      },
      true);
}

/// Unit cube, each face in two triangles.
inline TriangleMesh cube() {
  return {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 1),
           Vec3(1, 1, 1), Vec3(0, 1, 1)},
          {{0, 2, 1},
           {0, 3, 2},
           {4, 5, 6},
           {4, 6, 7},
           {0, 1, 5},
           {0, 5, 4},
           {1, 2, 6},
           {1, 6, 5},
           {2, 3, 7},
           {2, 7, 6},
           {3, 0, 4},
           {3, 4, 7}}};
}

inline TriangleMesh tetrahedron() {
  return {{Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)},
          {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

/// Nine equilateral triangles around vertex 0, a saddle of total angle 3π: its spokes, all of length √2,
/// are a closed walk of nine steps between neighbouring corners of a cuboctahedron, 60° each.
inline TriangleMesh saddle() {
  TriangleMesh mesh;
  mesh.vertices = {Vec3(0, 0, 0),  Vec3(1, 1, 0),  Vec3(0, 1, -1), Vec3(-1, 0, -1), Vec3(-1, -1, 0),
                   Vec3(-1, 0, 1), Vec3(0, -1, 1), Vec3(1, -1, 0), Vec3(0, -1, -1), Vec3(1, 0, -1)};
  for (int i = 0; i < 9; ++i)
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % 9});
  return mesh;
}

inline SurfacePoint at_vertex(const TriangleMesh& mesh, int vertex) {
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (mesh.triangles[t][e] == vertex) {
        SurfacePoint point;
        point.triangle = t;
        point.barycentric[e] = 1.0;
        return point;
      }
  return {};
}

inline SurfacePoint at(int triangle, double a, double b, double c) {
  return {triangle, Vec3(a, b, c)};
}

/// The point of `mesh` whose place along +Z from (x, y) it is; for height fields.
inline SurfacePoint below(const TriangleMesh& mesh, double x, double y) {
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& c = mesh.triangles[t];
    const Vec3 &p = mesh.vertices[c[0]], &q = mesh.vertices[c[1]], &r = mesh.vertices[c[2]];
    const double whole = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    const double b = ((x - p[0]) * (r[1] - p[1]) - (y - p[1]) * (r[0] - p[0])) / whole;
    const double d = ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / whole;
    if (b >= -1e-12 && d >= -1e-12 && b + d <= 1 + 1e-12) return {t, Vec3(1 - b - d, b, d)};
  }
  return {};
}

/// A geodesic sphere: an octahedron divided `levels` times, radius 1.
inline TriangleMesh sphere(int levels) {
  TriangleMesh mesh{
      {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::vector<Triangle> finer;
    std::vector<std::array<int, 3>> middles;  // low, high, middle; small meshes only
    const auto middle = [&](int a, int b) {
      const int low = std::min(a, b), high = std::max(a, b);
      for (auto it = middles.rbegin(); it != middles.rend(); ++it)
        if ((*it)[0] == low && (*it)[1] == high) return (*it)[2];
      mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      middles.push_back({low, high, mesh.vertex_count() - 1});
      return mesh.vertex_count() - 1;
    };
    for (const Triangle& t : mesh.triangles) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.push_back({t[0], ab, ca});
      finer.push_back({t[1], bc, ab});
      finer.push_back({t[2], ca, bc});
      finer.push_back({ab, bc, ca});
    }
    mesh.triangles = finer;
  }
  return mesh;
}

}  // namespace fascia::geodesics
