#include "sim/energies.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fascia::sim {
namespace {

constexpr double tiny_area = 1e-16;  // square metres: an edge of 10 nanometres
// Metres, of a triangle over a hinge's edge: what is narrower than a quarter of the skin's thickness does not
// bend as a plate.
constexpr double least_height = 4e-4;

struct HingeFrame {
  Vec3 edge, normal_a, normal_b;  // normals scaled by twice the areas
  double length, area_a, area_b;  // areas squared times four
};

HingeFrame hinge_frame(const std::array<uint32_t, 4>& n, const Vec3* x) {
  HingeFrame f;
  f.edge = x[n[1]] - x[n[0]];
  f.normal_a = f.edge.cross(x[n[2]] - x[n[0]]);
  f.normal_b = (x[n[3]] - x[n[0]]).cross(f.edge);
  f.length = std::max(f.edge.norm(), 1e-9);
  f.area_a = std::max(f.normal_a.squaredNorm(), tiny_area * tiny_area);
  f.area_b = std::max(f.normal_b.squaredNorm(), tiny_area * tiny_area);
  return f;
}

double angle_of(const HingeFrame& f) {
  return std::atan2(f.normal_a.cross(f.normal_b).dot(f.edge) / f.length, f.normal_a.dot(f.normal_b));
}

}  // namespace

double spring_energy(const Spring& s, const Vec3* x, Vec3* gradient) {
  double energy = 0.0, stiffer = 0.0;
  const Vec3 pull = vec3(formulas::spring(s.rest(), s.one_sided ? 0.0 : formulas::no_slack,
                                          three(x[s.nodes[1]] - x[s.nodes[0]]), stiffer, energy));
  gradient[s.nodes[0]] -= pull;
  gradient[s.nodes[1]] += pull;
  return energy;
}

Membrane make_membrane(std::array<uint32_t, 3> nodes, double youngs_thickness, double nu, const Vec3* rest) {
  const Vec3 first = rest[nodes[1]] - rest[nodes[0]], second = rest[nodes[2]] - rest[nodes[0]];
  const double length = std::max(first.norm(), 1e-9), along = first.dot(second) / length;
  const double height = std::max(first.cross(second).norm() / length, 1e-9);
  Eigen::Matrix2d edges;
  edges << length, along, 0.0, height;
  Membrane m;
  m.nodes = nodes;
  m.inverse_rest = edges.inverse();
  m.area = 0.5 * length * height;
  m.mu = youngs_thickness / (2.0 * (1.0 + nu));
  m.lambda = youngs_thickness * nu / (1.0 - nu * nu);
  return m;
}

formulas::Wall<double> membrane_crush(const Membrane& m, double ratio) {
  const formulas::Wall<double> wall = formulas::wall_at(ratio, formulas::crush_begin, formulas::crush_end);
  return {m.mu * wall.value, m.mu * wall.slope, m.mu * wall.curvature};
}

double membrane_energy(const Membrane& m, const Vec3* x, Vec3* gradient) {
  const formulas::MembraneRest<double> rest{m.inverse_rest(0, 0), m.inverse_rest(0, 1), m.inverse_rest(1, 1),
                                            m.area * m.mu, m.area * m.lambda};
  formulas::Three<double> place[3], force[3] = {};
  double energy = 0.0, stiffer[3] = {};
  for (size_t k = 0; k < 3; ++k)
    place[k] = three(x[m.nodes[k]]);
  formulas::membrane(rest, place, force, stiffer, energy);
  for (size_t k = 0; k < 3; ++k)
    gradient[m.nodes[k]] += vec3(force[k]);
  return energy;
}

double hinge_angle(const std::array<uint32_t, 4>& nodes, const Vec3* x) {
  return angle_of(hinge_frame(nodes, x));
}

Hinge make_hinge(std::array<uint32_t, 4> nodes, double rigidity, const Vec3* rest) {
  const HingeFrame f = hinge_frame(nodes, rest);
  const double twice_a = std::sqrt(f.area_a), twice_b = std::sqrt(f.area_b);
  Hinge hinge;
  hinge.nodes = nodes;
  // Towards a sliver the weights grow without bound, and with them the stiffness of its nodes.
  const double least = std::max(f.length * least_height, tiny_area);
  const double areas = std::max(0.5 * (twice_a + twice_b), least);
  const double narrow = std::min(1.0, std::min(twice_a, twice_b) / least);
  hinge.stiffness = rigidity * f.length * f.length / areas * narrow * narrow;
  // Unit vectors from the edge to the corners, as weights of the four places.
  const Vec3 unit = f.edge / f.length;
  const double over_a = f.length / twice_a, over_b = f.length / twice_b;
  const double along_a = (rest[nodes[2]] - rest[nodes[0]]).dot(unit) / f.length;
  const double along_b = (rest[nodes[3]] - rest[nodes[0]]).dot(unit) / f.length;
  hinge.weights = {-(1.0 - along_a) * over_a - (1.0 - along_b) * over_b, -along_a * over_a - along_b * over_b,
                   over_a, over_b};
  hinge.scale_a = 1.0 / twice_a;
  hinge.scale_b = 1.0 / twice_b;
  Vec3 away = Vec3::Zero();
  for (size_t i = 0; i < 4; ++i)
    away += hinge.weights[i] * rest[nodes[i]];
  const Vec3 normal = hinge.scale_a * f.normal_a + hinge.scale_b * f.normal_b;
  const double length = std::sqrt(normal.squaredNorm() + formulas::fold_softness);
  hinge.bend = away.dot(normal) * length / std::max(normal.squaredNorm(), formulas::fold_softness);
  if (std::abs(hinge.bend) < 1e-9) hinge.bend = 0.0;
  return hinge;
}

bool is_folded_shut(const std::array<uint32_t, 4>& nodes, const Vec3* rest) {
  const HingeFrame f = hinge_frame(nodes, rest);
  return (f.normal_a / std::sqrt(f.area_a) + f.normal_b / std::sqrt(f.area_b)).squaredNorm() <
         formulas::fold_softness;
}

HingeNormal hinge_normal(const Hinge& h, const Vec3* x) {
  const auto& n = h.nodes;
  double inverse_length = 0.0;
  const formulas::Three<double> unit =
      formulas::hinge_normal(h.scale_a, h.scale_b, three(x[n[1]] - x[n[0]]), three(x[n[2]] - x[n[0]]),
                             three(x[n[3]] - x[n[0]]), inverse_length);
  return {vec3(unit), 1.0 / inverse_length};
}

double hinge_energy(const Hinge& h, const Vec3* x, Vec3* gradient) {
  const formulas::HingeRest<double> rest{h.weights[1], h.weights[2], h.weights[3], h.stiffness,
                                         h.bend,       h.scale_a,    h.scale_b};
  formulas::Three<double> place[4], force[4];
  double energy = 0.0;
  for (size_t k = 0; k < 4; ++k)
    place[k] = three(x[h.nodes[k]]);
  formulas::hinge(rest, place, force, energy);
  for (size_t k = 0; k < 4; ++k)
    gradient[h.nodes[k]] += vec3(force[k]);
  return energy;
}

namespace {

/// Volume of a prism and six times its gradient by its nodes.
double volume_with_gradient(const std::array<uint32_t, 6>& nodes, const Vec3* x,
                            formulas::Three<double>* gradient) {
  formulas::Three<double> place[6];
  for (size_t k = 0; k < 6; ++k)
    place[k] = three(x[nodes[k]]);
  return formulas::prism_volume<true>(place, place + 3, gradient, gradient + 3);
}

formulas::PrismRest<double> at_rest(const Prism& p) {
  return {p.volume, 1.0 / std::max(std::abs(p.volume), 1e-12), p.stiffness,
          p.volume > 0.0 ? formulas::turn_modulus : 0.0};
}

}  // namespace

double prism_volume(const std::array<uint32_t, 6>& nodes, const Vec3* x) {
  formulas::Three<double> gradient[6];
  return volume_with_gradient(nodes, x, gradient);
}

std::array<Vec3, 6> prism_volume_gradient(const std::array<uint32_t, 6>& nodes, const Vec3* x) {
  formulas::Three<double> gradient[6];
  volume_with_gradient(nodes, x, gradient);
  std::array<Vec3, 6> out;
  for (size_t k = 0; k < 6; ++k)
    out[k] = vec3(gradient[k]) / 6.0;
  return out;
}

Prism make_prism(std::array<uint32_t, 6> nodes, double stiffness, const Vec3* rest) {
  return {nodes, prism_volume(nodes, rest), stiffness};
}

PrismPressure prism_pressure(const Prism& p, double volume) {
  PrismPressure out;
  bool has_wall = false;
  const formulas::PrismRest<double> rest = at_rest(p);
  const double wall = formulas::prism_pressure(rest, volume, out.pressure, has_wall, out.energy);
  out.slope = rest.stiffness * rest.inverse_volume + wall;
  return out;
}

double prism_energy(const Prism& p, const Vec3* x, Vec3* gradient) {
  formulas::Three<double> place[6], force[6] = {};
  double energy = 0.0, stiffer[6] = {};
  for (size_t k = 0; k < 6; ++k)
    place[k] = three(x[p.nodes[k]]);
  formulas::prism(at_rest(p), place, place + 3, force, force + 3, stiffer, stiffer + 3, energy);
  for (size_t k = 0; k < 6; ++k)
    gradient[p.nodes[k]] += vec3(force[k]);
  return energy;
}

double tether_energy(const Tether& t, const Vec3& place, const Vec3& normal, const Vec3* x, Vec3* gradient) {
  double energy = 0.0;
  gradient[t.node] +=
      vec3(formulas::tether(t.tangential_stiffness, t.normal_stiffness - t.tangential_stiffness,
                            three(normal), three(x[t.node] - place), energy));
  return energy;
}

}  // namespace fascia::sim
