#include "sim/curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::sim {
namespace {

using Mat32 = Eigen::Matrix<double, 3, 2>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

template <size_t Count>
void apply(const std::vector<Curvature::Stencil<Count>>& list, const Vec3* v, Vec3* out) {
  for (const auto& s : list) {
    Vec3 sum = s.weights[0] * v[s.nodes[0]];
    for (size_t i = 1; i < Count; ++i)
      sum += s.weights[i] * v[s.nodes[i]];
    const Vec3 force = s.block * sum;
    for (size_t i = 0; i < Count; ++i)
      out[s.nodes[i]] += s.weights[i] * force;
  }
}

/// A matrix of outer product left * right^T as its two columns stacked.
Vec6 stacked(const Vec3& left, const Eigen::Vector2d& right) {
  Vec6 v;
  v << left * right.x(), left * right.y();
  return v;
}

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace

void Curvature::clear() {
  points.clear();
  pairs.clear();
  quads.clear();
  sixes.clear();
  plates.clear();
  bends.clear();
  volumes.clear();
  pulls.clear();
  pull_nodes.clear();
  pull_slopes.clear();
}

void Curvature::times(const Vec3* v, Vec3* out) const {
  apply(points, v, out);
  apply(pairs, v, out);
  apply(quads, v, out);
  apply(sixes, v, out);
  for (const Plate& p : plates) {
    Mat32 edges;
    edges.col(0) = v[p.nodes[1]] - v[p.nodes[0]];
    edges.col(1) = v[p.nodes[2]] - v[p.nodes[0]];
    const Mat32 change = edges * p.inverse_rest;
    Mat32 stress;
    Eigen::Map<Vec6>(stress.data()).noalias() = p.block * Eigen::Map<const Vec6>(change.data());
    const Mat32 forces = stress * p.inverse_rest.transpose();
    out[p.nodes[0]] -= forces.col(0) + forces.col(1);
    out[p.nodes[1]] += forces.col(0);
    out[p.nodes[2]] += forces.col(1);
  }
  for (const Bend& b : bends) {
    Vec3 sum = b.slopes[0] * v[b.nodes[0]];
    for (size_t i = 1; i < 4; ++i)
      sum += b.slopes[i] * v[b.nodes[i]];
    sum *= b.stiffness;
    for (size_t i = 0; i < 4; ++i)
      out[b.nodes[i]] += b.slopes[i].transpose() * sum;
  }
  for (const Volume& p : volumes) {
    double sum = 0.0;
    for (size_t i = 0; i < 6; ++i)
      sum += p.slopes[i].dot(v[p.nodes[i]]);
    sum *= p.stiffness;
    for (size_t i = 0; i < 6; ++i)
      out[p.nodes[i]] += sum * p.slopes[i];
  }
  for (const Pull& p : pulls) {
    double sum = 0.0;
    for (size_t i = p.first; i < p.first + p.count; ++i)
      sum += pull_slopes[i].dot(v[pull_nodes[i]]);
    sum *= p.stiffness;
    for (size_t i = p.first; i < p.first + p.count; ++i)
      out[pull_nodes[i]] += sum * pull_slopes[i];
  }
}

void add_spring(const Spring& s, const Vec3* x, Curvature& out) {
  const Vec3 along = x[s.nodes[1]] - x[s.nodes[0]];
  const double length = along.norm(), stretch = length - s.length;
  if ((s.one_sided && stretch <= 0.0) || length < 1e-12) return;
  const double slope = stretch > s.limit ? s.second_stiffness : s.stiffness;
  const double tension = formulas::spring_tension(s.rest(), stretch, std::max(0.0, stretch - s.limit));
  const double across = std::max(0.0, tension / length);
  const Vec3 unit = along / length;
  out.pairs.push_back(
      {s.nodes, {1.0, -1.0}, across * Mat3::Identity() + (slope - across) * unit * unit.transpose()});
}

void add_membrane(const Membrane& m, const Vec3* x, Curvature& out) {
  Mat32 edges;
  edges.col(0) = x[m.nodes[1]] - x[m.nodes[0]];
  edges.col(1) = x[m.nodes[2]] - x[m.nodes[0]];
  const Mat32 f = edges * m.inverse_rest;
  // Principal stretches and directions: an isotropic energy's Hessian is known in them (Smith, de Goes & Kim
  // 2019, "Analytic eigensystems for isotropic distortion energies"; here for surfaces).
  const double a = f.col(0).squaredNorm(), b = f.col(0).dot(f.col(1)), c = f.col(1).squaredNorm();
  const double angle = 0.5 * std::atan2(2.0 * b, a - c);
  const Eigen::Vector2d v1(std::cos(angle), std::sin(angle)), v2(-v1.y(), v1.x());
  Vec3 u1 = f * v1, u2 = f * v2;
  const double s1 = std::max(u1.norm(), 1e-9), s2 = std::max(u2.norm(), 1e-9);
  u1 /= s1;
  u2 /= s2;
  const Vec3 n = u1.cross(u2);
  const formulas::Wall<double> crush = membrane_crush(m, s1 * s2);
  const double w1 = 2.0 * m.mu * (s1 - 1.0) + m.lambda * (s1 + s2 - 2.0) + crush.slope * s2;
  const double w2 = 2.0 * m.mu * (s2 - 1.0) + m.lambda * (s1 + s2 - 2.0) + crush.slope * s1;
  Curvature::Plate plate{m.nodes, m.inverse_rest, Eigen::Matrix<double, 6, 6>::Zero()};
  const auto add = [&](const Vec6& mode, double stiffness) {
    if (stiffness > 0.0) plate.block.noalias() += (m.area * stiffness) * mode * mode.transpose();
  };
  const double w11 = 2.0 * m.mu + m.lambda + crush.curvature * s2 * s2,
               w22 = 2.0 * m.mu + m.lambda + crush.curvature * s1 * s1;
  const double w12 = m.lambda + crush.slope + crush.curvature * s1 * s2;
  const double turn = 0.5 * std::atan2(2.0 * w12, w11 - w22), mean = 0.5 * (w11 + w22),
               reach = std::hypot(0.5 * (w11 - w22), w12);
  const Vec6 first = stacked(u1, v1), second = stacked(u2, v2);
  add(std::cos(turn) * first + std::sin(turn) * second, mean + reach);
  add(-std::sin(turn) * first + std::cos(turn) * second, mean - reach);
  const double half = std::sqrt(0.5);
  add(half * (stacked(u1, v2) - stacked(u2, v1)), (w1 + w2) / (s1 + s2));
  add(half * (stacked(u1, v2) + stacked(u2, v1)), 2.0 * m.mu - crush.slope);
  add(stacked(n, v1), w1 / s1);
  add(stacked(n, v2), w2 / s2);
  out.plates.push_back(plate);
}

void add_hinge(const Hinge& h, const Vec3* x, Curvature& out) {
  const auto& n = h.nodes;
  if (h.bend == 0.0) {
    out.quads.push_back({n, h.weights, h.stiffness * Mat3::Identity()});
    return;
  }
  // Gauss-Newton: first derivatives of the residual; second-order terms are dropped.
  const Vec3 edge = x[n[1]] - x[n[0]], arm_a = x[n[2]] - x[n[0]], arm_b = x[n[3]] - x[n[0]];
  const HingeNormal normal = hinge_normal(h, x);
  const Mat3 turn = (h.bend / normal.length) * (Mat3::Identity() - normal.unit * normal.unit.transpose());
  const Mat3 by_edge = turn * (h.scale_b * cross_matrix(arm_b) - h.scale_a * cross_matrix(arm_a));
  const Mat3 by_a = h.scale_a * turn * cross_matrix(edge), by_b = -h.scale_b * turn * cross_matrix(edge);
  Curvature::Bend bend{n, {}, h.stiffness};
  for (size_t i = 0; i < 4; ++i)
    bend.slopes[i] = h.weights[i] * Mat3::Identity();
  bend.slopes[0] += by_edge + by_a + by_b;
  bend.slopes[1] -= by_edge;
  bend.slopes[2] -= by_a;
  bend.slopes[3] -= by_b;
  out.bends.push_back(bend);
}

void add_prism(const Prism& p, const Vec3* x, Curvature& out) {
  const PrismPressure pressure = prism_pressure(p, prism_volume(p.nodes, x));
  if (pressure.slope <= 0.0) return;
  out.volumes.push_back({p.nodes, prism_volume_gradient(p.nodes, x), pressure.slope});
}

void add_tether(const Tether& t, const Vec3& normal, Curvature& out) {
  const double extra = t.normal_stiffness - t.tangential_stiffness;
  out.points.push_back(
      {{t.node}, {1.0}, t.tangential_stiffness * Mat3::Identity() + extra * normal * normal.transpose()});
}

}  // namespace fascia::sim
