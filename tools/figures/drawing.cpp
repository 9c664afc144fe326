#include "tools/figures/drawing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia::figures {

using view::DrawLines;
using view::DrawSurface;

view::Image figure(const std::vector<Panel>& panels, int columns, int width, int height) {
  const view::Renderer renderer(width, height);
  std::vector<view::Tile> tiles;
  for (const Panel& panel : panels)
    tiles.push_back({renderer.draw(panel.list, panel.camera, {255, 255, 255}), panel.caption});
  return view::contact_sheet(tiles, columns);
}

Vec3 diverging(double value) {
  const double t = std::clamp(value, -1.0, 1.0);
  const Vec3 end = t > 0 ? Vec3(0.82, 0.25, 0.2) : Vec3(0.2, 0.4, 0.8);
  return Vec3(0.95, 0.94, 0.92) + std::abs(t) * (end - Vec3(0.95, 0.94, 0.92));
}

DrawSurface sheet(const std::function<Vec3(double, double)>& at, int cells,
                  const std::function<Vec3(double, double)>& colour) {
  DrawSurface out;
  out.colour = clay;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double u = static_cast<double>(i) / cells, v = static_cast<double>(j) / cells;
      out.positions.push_back(at(u, v));
      if (colour) out.vertex_colours.push_back(colour(u, v));
    }
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 2, d = a + cells + 1;
      out.triangles.push_back({a, b, c});
      out.triangles.push_back({a, c, d});
    }
  return out;
}

DrawLines grid(const std::function<Vec3(double, double)>& at, int count, const Vec3& colour, double width,
               int fine) {
  DrawLines out;
  out.colour = colour;
  out.width = width;
  for (int k = 0; k <= count; ++k) {
    std::vector<Vec3> across, along;
    for (int i = 0; i <= fine; ++i) {
      const double t = static_cast<double>(i) / fine, s = static_cast<double>(k) / count;
      across.push_back(at(t, s));
      along.push_back(at(s, t));
    }
    out.lines.push_back(std::move(across));
    out.lines.push_back(std::move(along));
  }
  return out;
}

DrawSurface ball(const Vec3& centre, double radius, const Vec3& colour) {
  DrawSurface out = sheet(
      [&](double u, double v) {
        const double a = 2 * std::numbers::pi * u, b = std::numbers::pi * (v - 0.5);
        return Vec3(centre +
                    radius * Vec3(std::cos(b) * std::cos(a), std::sin(b), -std::cos(b) * std::sin(a)));
      },
      16);
  out.colour = colour;
  return out;
}

DrawSurface arrow(const Vec3& from, const Vec3& to, double radius, const Vec3& colour) {
  const Vec3 along = (to - from).normalized();
  const Vec3 side = along.cross(std::abs(along.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  const Vec3 other = along.cross(side);
  const double length = (to - from).norm(), head = std::min(5 * radius, 0.5 * length);
  // Profile of the arrow: where along it, how wide.
  const double profile[6][2] = {
      {0, 0}, {0, radius}, {length - head, radius}, {length - head, 2.4 * radius}, {length, 0}, {length, 0}};
  DrawSurface out = sheet(
      [&](double u, double v) {
        const double a = 2 * std::numbers::pi * u;
        const double* at = profile[std::clamp(static_cast<int>(std::lround(v * 5)), 0, 5)];
        return Vec3(from + at[0] * along + at[1] * (std::cos(a) * side + std::sin(a) * other));
      },
      5);
  out.colour = colour;
  return out;
}

DrawLines line(std::vector<Vec3> points, const Vec3& colour, double width) {
  DrawLines out;
  out.lines = {std::move(points)};
  out.colour = colour;
  out.width = width;
  return out;
}

view::Camera from_above(const Vec3& target, double half) {
  view::Camera camera;
  camera.target = target;
  camera.field_of_view = 10;
  camera.distance = half / std::tan(5 * std::numbers::pi / 180);
  return camera;
}

}  // namespace fascia::figures
