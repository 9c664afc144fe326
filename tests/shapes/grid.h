#pragma once

#include <cmath>
#include <functional>

#include "geometry/mesh.h"

namespace fascia::testing {

/// A grid of `columns` x `rows` cells, vertex (i, j) at place(i / columns, j / rows), facing along +z when
/// place goes right with the first and up with the second.
inline TriangleMesh grid(int columns, int rows, const std::function<Vec3(double, double)>& place) {
  TriangleMesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      mesh.vertices.push_back(place(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

/// A face-like vault of 160 by 120 mm, `height(x, y)` metres above its middle's plane, cut into triangles
/// that are not alike on both sides of x = 0: its inner columns wave by `wave` metres.
inline TriangleMesh waving_vault(int columns, int rows, double wave,
                                 const std::function<double(double, double)>& height) {
  return grid(columns, rows, [&](double u, double v) {
    const double i = std::round(u * columns), j = std::round(v * rows),
                 x = 0.16 * (u - 0.5) + (i == 0.0 || i == columns ? 0.0 : wave * std::sin(1.7 * i + j)),
                 y = 0.12 * (v - 0.5);
    return Vec3(x, y, 0.05 - 6.0 * x * x - 3.0 * y * y + height(x, y));
  });
}

}  // namespace fascia::testing
