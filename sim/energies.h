#pragma once

#include <array>
#include <cstdint>

#include "sim/formulas/elements.h"
#include "sim/vector.h"

/// The energies of one element each, in double precision: the formulas of sim/formulas on nodes. All return
/// joules and add the gradient (newtons) of the nodes they touch to `gradient`, which is indexed as `x` is,
/// by node.
namespace fascia::sim {

/// A spring that may stiffen: `stiffness` up to `limit` metres of stretch, `second_stiffness` beyond.
/// A one-sided one is slack when shorter than `length`.
struct Spring {
  std::array<uint32_t, 2> nodes;
  double length, stiffness, limit, second_stiffness;
  bool one_sided;
  formulas::SpringRest<double> rest() const {
    return {length, stiffness, limit, second_stiffness - stiffness};
  }
};

/// A constant-strain triangle of corotated linear elasticity in plane stress.
/// W = area (mu |F - R|^2 + lambda/2 (tr S - 2)^2), F = R S (Sifakis & Barbic 2012, section 3.3). Below half
/// of its area a term mu (1 / (2 J) - 1)^2 is added, from a tenth on by its parabola, so that no triangle
/// collapses.
struct Membrane {
  std::array<uint32_t, 3> nodes;
  Eigen::Matrix2d inverse_rest;  ///< of the rest edges in the triangle's own plane
  double area, mu, lambda;       ///< mu and lambda in newton per metre
};

/// An edge with two triangles. L = weighted sum of positions is the sum of the two unit vectors that point
/// from the edge to its opposite corners, 2 sin(angle / 2) long and along the mean normal n: W = stiffness/2
/// |L - bend n|^2, which for a flat rest is quadratic (Bergou et al. 2006) and for a bent one (Garg et al.
/// 2007) remains smooth when its triangles shrink or fold. `nodes` are the edge's two ends and the opposite
/// corners of its first and second triangle.
struct Hinge {
  std::array<uint32_t, 4> nodes;
  std::array<double, 4> weights;  ///< per metre
  double bend, stiffness;         ///< bend: signed length of L at rest
  double scale_a, scale_b;        ///< of the triangles' normals to unit ones at rest
};

/// The prism between two layers: W = stiffness/(2 V0) (V - V0)^2, sides bilinear. Below t = 0.4 V0 a barrier
/// prevents inversion, also if the stiffness is 0: W = 800 Pa V0 (t / V - 1)^2, from 0.1 V0 on by its
/// parabola.
struct Prism {
  std::array<uint32_t, 6> nodes;  ///< outer triangle, then inner, same column order
  double volume, stiffness;       ///< cubic metres, pascal
};

/// A node tethered to a position: `normal_stiffness` along a normal, `tangential_stiffness` across it.
struct Tether {
  uint32_t node;
  Vec3 normal;
  double normal_stiffness, tangential_stiffness;
};

/// The barrier against a membrane's collapse below half its area, as a function of its ratio to the rest
/// area: energy per area, and its derivatives.
formulas::Wall<double> membrane_crush(const Membrane& membrane, double ratio);

/// The mean normal of a hinge's two triangles, faded out where they fold onto each other.
struct HingeNormal {
  Vec3 unit;      ///< shorter than 1 where it is faded out
  double length;  ///< its length before normalisation
};
HingeNormal hinge_normal(const Hinge& hinge, const Vec3* x);

/// Energy of a prism of the volume `volume`, joules, with its derivatives by the volume (pascal; pascal per
/// cubic metre).
struct PrismPressure {
  double energy = 0.0, pressure = 0.0, slope = 0.0;
};
PrismPressure prism_pressure(const Prism& prism, double volume);

double spring_energy(const Spring& spring, const Vec3* x, Vec3* gradient);
double membrane_energy(const Membrane& membrane, const Vec3* x, Vec3* gradient);
double hinge_energy(const Hinge& hinge, const Vec3* x, Vec3* gradient);
double prism_energy(const Prism& prism, const Vec3* x, Vec3* gradient);
double tether_energy(const Tether& tether, const Vec3& place, const Vec3& normal, const Vec3* x,
                     Vec3* gradient);

/// The element with the rest configuration `rest`; `youngs_thickness` in newton per metre.
Membrane make_membrane(std::array<uint32_t, 3> nodes, double youngs_thickness, double poisson_ratio,
                       const Vec3* rest);
/// The element at rest; `rigidity` in newton metre. Stiffness = rigidity |edge|^2 / (both areas), which on a
/// mesh of equilateral triangles is a thin plate's (Seung & Nelson 1988).
Hinge make_hinge(std::array<uint32_t, 4> nodes, double rigidity, const Vec3* rest);
Prism make_prism(std::array<uint32_t, 6> nodes, double stiffness, const Vec3* rest);

/// Whether a hinge's triangles are folded onto each other to within 6 degrees: its mean normal is then
/// undefined, and its rest force would make it snap open at the smallest disturbance.
bool is_folded_shut(const std::array<uint32_t, 4>& nodes, const Vec3* rest);

/// Angle in radians between the planes of a hinge, 0 flat, positive for a convex edge.
double hinge_angle(const std::array<uint32_t, 4>& nodes, const Vec3* x);
/// Volume of a prism in cubic metres.
double prism_volume(const std::array<uint32_t, 6>& nodes, const Vec3* x);
/// The gradient of that volume with respect to the six nodes.
std::array<Vec3, 6> prism_volume_gradient(const std::array<uint32_t, 6>& nodes, const Vec3* x);

}  // namespace fascia::sim
