#include "sim/energies.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fascia::sim {
namespace {

constexpr double tiny_area = 1e-16;  // square metres: an edge of 10 nanometres

/// The closed surface of a prism as triangles with their weights: both ends, and each bilinear side
/// as the mean of its two diagonal splits. Corners 0..2 outer, 3..5 inner; outward.
struct Face {
  int a, b, c;
  double weight;
};
constexpr Face prism_faces[] = {{0, 1, 2, 1.0}, {3, 5, 4, 1.0},                                  // ends
                                {0, 3, 4, 0.5}, {0, 4, 1, 0.5}, {0, 3, 1, 0.5}, {1, 3, 4, 0.5},  // sides
                                {1, 4, 5, 0.5}, {1, 5, 2, 0.5}, {1, 4, 2, 0.5}, {2, 4, 5, 0.5},
                                {2, 5, 3, 0.5}, {2, 3, 0, 0.5}, {2, 5, 0, 0.5}, {0, 5, 3, 0.5}};

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
  const Vec3 along = x[s.nodes[1]] - x[s.nodes[0]];
  const double length = along.norm(), stretch = length - s.length;
  if ((s.one_sided && stretch <= 0.0) || length < 1e-12) return 0.0;
  const double beyond = std::max(0.0, stretch - s.limit), extra = s.second_stiffness - s.stiffness;
  double energy = 0.5 * s.stiffness * stretch * stretch, force = s.stiffness * stretch;
  if (beyond > 0.0) {
    energy += 0.5 * extra * beyond * beyond;
    force += extra * beyond;
  }
  const Vec3 pull = (force / length) * along;
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

namespace {

/// (begin / ratio - 1)^2 below `begin`, from `end` on as its parabola; with both derivatives by the ratio.
struct Wall {
  double value = 0.0, slope = 0.0, curvature = 0.0;
};
Wall wall(double ratio, double begin, double end) {
  if (ratio >= begin) return {};
  const double r = std::max(ratio, end), share = begin / r, lack = share - 1.0, below = ratio - r;
  const double slope = -2.0 * lack * share / r, curvature = 2.0 * share * (3.0 * share - 2.0) / (r * r);
  return {lack * lack + slope * below + 0.5 * curvature * below * below, slope + curvature * below,
          curvature};
}

}  // namespace

MembraneCrush membrane_crush(const Membrane& m, double ratio) {
  const Wall w = wall(ratio, crush_begin, crush_end);
  return {m.mu * w.value, m.mu * w.slope, m.mu * w.curvature};
}

double membrane_energy(const Membrane& m, const Vec3* x, Vec3* gradient) {
  using Mat32 = Eigen::Matrix<double, 3, 2>;
  Mat32 edges;
  edges.col(0) = x[m.nodes[1]] - x[m.nodes[0]];
  edges.col(1) = x[m.nodes[2]] - x[m.nodes[0]];
  const Mat32 deformation = edges * m.inverse_rest;
  const Vec3 f0 = deformation.col(0), f1 = deformation.col(1);
  Vec3 normal = f0.cross(f1);
  const double area_ratio = normal.norm();
  normal = area_ratio > 1e-14 ? Vec3(normal / area_ratio) : Vec3::Zero();
  const double squares = f0.squaredNorm() + f1.squaredNorm();
  // For a 3 x 2 matrix tr S = sqrt(|F|^2 + 2 det S), and R = (F + cofactor of F) / tr S.
  const double trace = std::max(std::sqrt(squares + 2.0 * area_ratio), 1e-12);
  Mat32 rotation;
  rotation.col(0) = (f0 + f1.cross(normal)) / trace;
  rotation.col(1) = (f1 + normal.cross(f0)) / trace;
  const double spread = trace - 2.0;
  Mat32 stress = 2.0 * m.mu * (deformation - rotation) + m.lambda * spread * rotation;
  const MembraneCrush crush = membrane_crush(m, area_ratio);
  if (crush.slope != 0.0) {
    stress.col(0) += crush.slope * f1.cross(normal);
    stress.col(1) += crush.slope * normal.cross(f0);
  }
  const Mat32 forces = m.area * stress * m.inverse_rest.transpose();
  gradient[m.nodes[0]] -= forces.col(0) + forces.col(1);
  gradient[m.nodes[1]] += forces.col(0);
  gradient[m.nodes[2]] += forces.col(1);
  return m.area * (m.mu * (squares - 2.0 * trace + 2.0) + 0.5 * m.lambda * spread * spread + crush.energy);
}

double hinge_angle(const std::array<uint32_t, 4>& nodes, const Vec3* x) {
  return angle_of(hinge_frame(nodes, x));
}

Hinge make_hinge(std::array<uint32_t, 4> nodes, double rigidity, const Vec3* rest) {
  const HingeFrame f = hinge_frame(nodes, rest);
  const double twice_a = std::sqrt(f.area_a), twice_b = std::sqrt(f.area_b),
               areas = 0.5 * (twice_a + twice_b);
  Hinge hinge;
  hinge.nodes = nodes;
  hinge.stiffness = rigidity * f.length * f.length / std::max(areas, tiny_area);
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
  const double length = std::sqrt(normal.squaredNorm() + fold_softness);
  hinge.bend = away.dot(normal) * length / std::max(normal.squaredNorm(), fold_softness);
  if (std::abs(hinge.bend) < 1e-9) hinge.bend = 0.0;
  return hinge;
}

HingeNormal hinge_normal(const Hinge& h, const Vec3* x) {
  const auto& n = h.nodes;
  const Vec3 edge = x[n[1]] - x[n[0]], arm_a = x[n[2]] - x[n[0]], arm_b = x[n[3]] - x[n[0]];
  const Vec3 normal = h.scale_a * edge.cross(arm_a) + h.scale_b * arm_b.cross(edge);
  const double length = std::sqrt(normal.squaredNorm() + fold_softness);
  return {normal / length, length};
}

double hinge_energy(const Hinge& h, const Vec3* x, Vec3* gradient) {
  const auto& n = h.nodes;
  Vec3 away = Vec3::Zero();
  for (size_t i = 0; i < 4; ++i)
    away += h.weights[i] * x[n[i]];
  if (h.bend == 0.0) {
    for (size_t i = 0; i < 4; ++i)
      gradient[n[i]] += (h.stiffness * h.weights[i]) * away;
    return 0.5 * h.stiffness * away.squaredNorm();
  }
  const Vec3 edge = x[n[1]] - x[n[0]], arm_a = x[n[2]] - x[n[0]], arm_b = x[n[3]] - x[n[0]];
  const auto [normal, length] = hinge_normal(h, x);
  const Vec3 miss = away - h.bend * normal;
  for (size_t i = 0; i < 4; ++i)
    gradient[n[i]] += (h.stiffness * h.weights[i]) * miss;
  // The normal turns with the triangles: d(normal) = (I - normal normal^T) d(sum of normals) / length.
  const Vec3 turn = (-h.stiffness * h.bend / length) * (miss - normal.dot(miss) * normal);
  const Vec3 a = h.scale_a * turn, b = h.scale_b * turn;
  const Vec3 by_edge = arm_a.cross(a) - arm_b.cross(b), by_a = a.cross(edge), by_b = edge.cross(b);
  gradient[n[1]] += by_edge;
  gradient[n[2]] += by_a;
  gradient[n[3]] += by_b;
  gradient[n[0]] -= by_edge + by_a + by_b;
  return 0.5 * h.stiffness * miss.squaredNorm();
}

double prism_volume(const std::array<uint32_t, 6>& n, const Vec3* x) {
  double volume = 0.0;
  const Vec3 origin = x[n[0]];
  for (const Face& f : prism_faces)
    volume += f.weight * (x[n[f.a]] - origin).dot((x[n[f.b]] - origin).cross(x[n[f.c]] - origin));
  return volume / 6.0;
}

std::array<Vec3, 6> prism_volume_gradient(const std::array<uint32_t, 6>& n, const Vec3* x) {
  std::array<Vec3, 6> gradient;
  gradient.fill(Vec3::Zero());
  const Vec3 origin = x[n[0]];
  for (const Face& f : prism_faces) {
    const Vec3 a = x[n[f.a]] - origin, b = x[n[f.b]] - origin, c = x[n[f.c]] - origin;
    const double weight = f.weight / 6.0;
    gradient[static_cast<size_t>(f.a)] += weight * b.cross(c);
    gradient[static_cast<size_t>(f.b)] += weight * c.cross(a);
    gradient[static_cast<size_t>(f.c)] += weight * a.cross(b);
  }
  return gradient;
}

Prism make_prism(std::array<uint32_t, 6> nodes, double stiffness, const Vec3* rest) {
  return {nodes, prism_volume(nodes, rest), stiffness};
}

PrismPressure prism_pressure(const Prism& p, double volume) {
  const double rest = std::max(std::abs(p.volume), 1e-12), excess = volume - p.volume;
  PrismPressure out{0.5 * p.stiffness * excess * excess / rest, p.stiffness * excess / rest,
                    p.stiffness / rest};
  if (p.volume <= 0.0) return out;
  const Wall w = wall(volume / rest, turn_begin, turn_end);
  out.energy += turn_modulus * rest * w.value;
  out.pressure += turn_modulus * w.slope;
  out.slope += turn_modulus * w.curvature / rest;
  return out;
}

double prism_energy(const Prism& p, const Vec3* x, Vec3* gradient) {
  const PrismPressure at = prism_pressure(p, prism_volume(p.nodes, x));
  if (at.pressure == 0.0) return at.energy;
  const auto parts = prism_volume_gradient(p.nodes, x);
  for (size_t i = 0; i < 6; ++i)
    gradient[p.nodes[i]] += at.pressure * parts[i];
  return at.energy;
}

double tether_energy(const Tether& t, const Vec3& place, const Vec3& normal, const Vec3* x, Vec3* gradient) {
  const Vec3 away = x[t.node] - place;
  const double along = away.dot(normal), extra = t.normal_stiffness - t.tangential_stiffness;
  gradient[t.node] += t.tangential_stiffness * away + (extra * along) * normal;
  return 0.5 * (t.tangential_stiffness * away.squaredNorm() + extra * along * along);
}

}  // namespace fascia::sim
