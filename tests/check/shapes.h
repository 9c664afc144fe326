#pragma once

#include <cmath>

#include "check/head.h"
#include "tests/shapes/grid.h"

/// Surfaces whose measures are known beforehand. Metres.
namespace fascia::testing {

inline void append(TriangleMesh& to, const TriangleMesh& mesh) {
  const int first = to.vertex_count();
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const Triangle& t : mesh.triangles)
    to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// The subject's left eye about the origin, 24 mm across, behind lids on a ball of 25 mm: an upper and a
/// lower one whose edges lie `upper` and `lower` radians above the canthi's plane. Beyond the canthi, 70
/// degrees to both sides, the two are one.
inline check::Head eye_with_lids(double upper, double lower) {
  constexpr double radius = 0.0125, canthus = 1.22, side = 1.4, far = 0.9;
  const auto on_ball = [=](double azimuth, double elevation) {
    return Vec3(radius * Vec3(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                              std::cos(azimuth) * std::cos(elevation)));
  };
  const auto edge = [&](double azimuth, double angle) { return std::abs(azimuth) < canthus ? angle : 0.0; };
  check::Part skin{"skin", {}};
  const auto azimuth_of = [&](double u) { return side * (2.0 * u - 1.0); };
  append(skin.mesh, grid(140, 40, [&](double u, double v) {
           const double azimuth = azimuth_of(u), from = edge(azimuth, upper);
           return on_ball(azimuth, from + v * (far - from));
         }));
  append(skin.mesh, grid(140, 40, [&](double u, double v) {
           const double azimuth = azimuth_of(u), to = edge(azimuth, lower);
           return on_ball(azimuth, -far + v * (to + far));
         }));
  check::Part ball{"eye_left", grid(60, 30, [](double u, double v) {
                     const double azimuth = 2.0 * EIGEN_PI * u, elevation = EIGEN_PI * (v - 0.5);
                     return Vec3(0.012 * Vec3(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                              std::cos(azimuth) * std::cos(elevation)));
                   })};
  check::Head head;
  head.parts = {skin, ball};
  head.landmarks = {{"exocanthion_left", on_ball(canthus, 0.0)},
                    {"endocanthion_left", on_ball(-canthus, 0.0)},
                    {"palpebrale_superius_left", on_ball(0.0, upper)},
                    {"palpebrale_inferius_left", on_ball(0.0, lower)}};
  head.eyes[0] = check::Eye{Vec3::Zero(), 0.012, Vec3::UnitZ()};
  return head;
}

/// A flat face, 120 mm square, with a mouth 50 mm wide at the origin: lips .2 mm apart at rest and one beyond
/// the corners, the lower one let down by `open` in the middle and as an ellipse's half to the corners.
inline check::Head flat_mouth(double open = 0.0) {
  constexpr double half = 0.025, apart = 1e-4, side = 0.06;
  const auto depth = [&](double x) {
    const double t = x / half;
    return std::abs(t) < 1.0 - 1e-9 ? std::sqrt(1.0 - t * t) : 0.0;
  };
  check::Part skin{"skin", {}};
  append(skin.mesh, grid(120, 60, [&](double u, double v) {
           const double x = side * (2.0 * u - 1.0), low = std::abs(x) < half - 1e-9 ? apart : 0.0;
           return Vec3(x, low + v * (side - low), 0.0);
         }));
  append(skin.mesh, grid(120, 60, [&](double u, double v) {
           const double x = side * (2.0 * u - 1.0), high = std::abs(x) < half - 1e-9 ? -apart : 0.0;
           const double y = -side + v * (high + side);
           return Vec3(x, y - open * depth(x) * v, 0.0);
         }));
  check::Head head;
  head.parts = {skin};
  head.landmarks = {{"labiale_superius", Vec3(0, 0.008, 0)},
                    {"labiale_inferius", Vec3(0, -0.009, 0)},
                    {"cheilion_left", Vec3(half, 0, 0)},
                    {"cheilion_right", Vec3(-half, 0, 0)}};
  return head;
}

/// The same with lips that are 8 mm thick: from their edges the skin goes on backward, level. The lower half
/// stands `up` metres higher than .2 mm under the upper one.
inline check::Head thick_lips(double up) {
  constexpr double half = 0.025, apart = 1e-4, thick = 0.008;
  check::Head head = flat_mouth();
  TriangleMesh& skin = head.parts[0].mesh;
  const auto across = [&](double u) {
    return 0.024 * (2.0 * u - 1.0);
  };  // its vertices on those of the front
  append(skin, grid(48, 16, [&](double u, double v) { return Vec3(across(u), apart, -thick * (1.0 - v)); }));
  const int upper_end = skin.vertex_count();
  append(skin, grid(48, 16, [&](double u, double v) { return Vec3(across(u), -apart, -thick * v); }));
  const int half_of_front = 121 * 61;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const bool is_lower = (v >= half_of_front && v < 2 * half_of_front) || v >= upper_end;
    Vec3& p = skin.vertices[static_cast<size_t>(v)];
    if (is_lower && std::abs(p.x()) < half * 0.99) p.y() += up;
  }
  return head;
}

}  // namespace fascia::testing
