#pragma once

#include <array>
#include <cstdint>

#include "sim/vector.h"

/// The energies of one element each. All return joules and add the gradient (newtons) of the nodes
/// they touch to `gradient`, which is indexed as `x` is, by node.
namespace fascia::sim {

/// A spring that may stiffen: `stiffness` up to `limit` metres of stretch, `second_stiffness` beyond.
/// A one-sided one is slack when shorter than `length`.
struct Spring {
  std::array<uint32_t, 2> nodes;
  double length, stiffness, limit, second_stiffness;
  bool one_sided;
};

/// A constant-strain triangle of corotated linear elasticity in plane stress.
/// W = area (mu |F - R|^2 + lambda/2 (tr S - 2)^2), F = R S (Sifakis & Barbic 2012, section 3.3).
struct Membrane {
  std::array<uint32_t, 3> nodes;
  Eigen::Matrix2d inverse_rest;  ///< of the rest edges in the triangle's own plane
  double area, mu, lambda;       ///< mu and lambda in newton per metre
};

/// An edge with two triangles: W = stiffness/2 (angle - rest angle)^2 (Grinspun et al. 2003).
/// `nodes` are the edge's two ends and the opposite corners of its first and second triangle.
struct Hinge {
  std::array<uint32_t, 4> nodes;
  double angle, stiffness;
};

/// The prism between two layers: W = stiffness/(2 V0) (V - V0)^2, sides bilinear.
struct Prism {
  std::array<uint32_t, 6> nodes;  ///< outer triangle, then inner, same column order
  double volume, stiffness;       ///< cubic metres, pascal
};

/// A node held to a place: `normal_stiffness` along a normal, `tangential_stiffness` across it.
struct Tether {
  uint32_t node;
  Vec3 normal;
  double normal_stiffness, tangential_stiffness;
};

double spring_energy(const Spring& spring, const Vec3* x, Vec3* gradient);
double membrane_energy(const Membrane& membrane, const Vec3* x, Vec3* gradient);
double hinge_energy(const Hinge& hinge, const Vec3* x, Vec3* gradient);
double prism_energy(const Prism& prism, const Vec3* x, Vec3* gradient);
double tether_energy(const Tether& tether, const Vec3& place, const Vec3& normal, const Vec3* x, Vec3* gradient);

/// A node outside an eyeball: W = stiffness/2 depth^2 while it is within `radius` of `centre`.
double globe_energy(uint32_t node, const Vec3& centre, double radius, double stiffness, const Vec3* x, Vec3* gradient);

/// The element at rest in `rest`; `youngs_thickness` in newton per metre.
Membrane make_membrane(std::array<uint32_t, 3> nodes, double youngs_thickness, double poisson_ratio, const Vec3* rest);
/// The element at rest; `rigidity` in newton metre. Stiffness = rigidity |edge|^2 / (both areas), which on a
/// mesh of equilateral triangles is a thin plate's (Seung & Nelson 1988).
Hinge make_hinge(std::array<uint32_t, 4> nodes, double rigidity, const Vec3* rest);
Prism make_prism(std::array<uint32_t, 6> nodes, double stiffness, const Vec3* rest);

/// Angle in radians between the planes of a hinge, 0 flat, positive where the edge stands out.
double hinge_angle(const std::array<uint32_t, 4>& nodes, const Vec3* x);
/// Volume of a prism in cubic metres.
double prism_volume(const std::array<uint32_t, 6>& nodes, const Vec3* x);
/// The gradient of that volume with respect to the six nodes.
std::array<Vec3, 6> prism_volume_gradient(const std::array<uint32_t, 6>& nodes, const Vec3* x);

}  // namespace fascia::sim
