#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/face_model.h"
#include "sim/formulas/activation_force.h"
#include "sim/formulas/motion.h"

// The per-iteration part of FaceModel: moving bones and carriers, and summing the energies.
namespace fascia::sim {
namespace {

double value_of(std::span<const float> activations, uint32_t channel) {
  return channel < activations.size() && std::isfinite(activations[channel]) ? activations[channel] : 0.0;
}

constexpr std::array<uint32_t, 6> kSweptCorners = {0, 1, 2, 3, 4, 5};

}  // namespace

void FaceModel::place(const Controls& controls, Frame& frame) const {
  const JawPose pose = clamped(controls.jaw);
  const RigidTransform mandible = jaw_transform(jaw_, pose);
  frame.mandible = mandible;
  const auto carry = [&](float weight) {
    if (weight == 0.0F) return RigidTransform{};
    return weight == 1.0F ? mandible : jaw_transform(jaw_, pose, weight);
  };
  for (size_t i = 0; i < rest_.size(); ++i) {
    const auto kind = static_cast<NodeKind>(lattice_.kinds[i]);
    float weight = lattice_.jaw_weights[i];
    if (kind == NodeKind::fixed || kind == NodeKind::fixed_cranium) weight = 0.0F;
    frame.carried[i] = pose.at_rest() ? rest_[i] : carry(weight) * rest_[i];
  }
  for (size_t t = 0; t < tethers_.size(); ++t)
    frame.tether_normals[t] =
        pose.at_rest() ? tethers_[t].normal
                       : Vec3(carry(lattice_.jaw_weights[tethers_[t].node]).rotation * tethers_[t].normal);
  for (size_t c = 0; c < frame.carrier_pulls.size(); ++c)
    frame.carrier_pulls[c] = carrier_pull(c, value_of(controls.activations, lattice_.carrier_channel[c]),
                                          frame.carried[lattice_.carrier_node[c]]);
  for (size_t p = 0; p < frame.fibre_anchors.size(); ++p) {
    const Vec3 place = lattice_.fibre_rest[p].cast<double>();
    const bool moves = static_cast<FibreAnchor>(lattice_.fibre_anchor[p]) == FibreAnchor::mandible;
    frame.fibre_anchors[p] = moves ? mandible * place : place;
  }
  for (size_t f = 0; f < frame.fibre_pulls.size(); ++f)
    frame.fibre_pulls[f] =
        formulas::activation_force(std::max(0.0, value_of(controls.activations, lattice_.fibre_channel[f])),
                                   options_.initial_force_slope) *
        lattice_.fibre_strength[f];
  for (size_t p = 0; p < frame.pressures.size(); ++p)
    frame.pressures[p] = value_of(controls.activations, lattice_.pressure_channel[p]) * lattice_.pressure[p];
  frame.touches = controls.touches;
  frame.acceleration = controls.acceleration.allFinite() ? controls.acceleration : Vec3(Vec3::Zero());
}

Vec3 FaceModel::fibre_point(const Frame& frame, size_t point, const Vec3* x) const {
  const auto anchor = static_cast<FibreAnchor>(lattice_.fibre_anchor[point]);
  Vec3 place = frame.fibre_anchors[point];
  if (anchor == FibreAnchor::cranium || anchor == FibreAnchor::mandible) return place;
  const auto& nodes = lattice_.fibre_nodes[point];
  for (size_t k = 0; k < 3; ++k)
    place += static_cast<double>(lattice_.fibre_weights[point][static_cast<int>(k)]) *
             (x[nodes[k]] - rest_[nodes[k]]);
  return place;
}

double FaceModel::fibre_tension(const Frame& frame, uint32_t f, const Vec3* x) const {
  const double pull = frame.fibre_pulls[f], rest_length = fibre_lengths_[f];
  if (pull == 0.0 || rest_length <= 0.0) return 0.0;
  double length = 0.0, energy = 0.0;
  for (uint32_t p = lattice_.fibre_offsets[f]; p + 1 < lattice_.fibre_offsets[f + 1]; ++p)
    length += lattice_.fibre_taper[p] *
              formulas::segment_length(three(fibre_point(frame, p + 1, x) - fibre_point(frame, p, x)));
  return formulas::fibre_tension(pull, length, rest_length, static_cast<double>(lattice_.fibre_shortest[f]),
                                 energy);
}

/// Energy of one fibre; `add_force(node, force)` gets what is to be added to the gradient.
template <class Force>
double FaceModel::pull_fibre(const Frame& frame, uint32_t f, double pull, const Vec3* x,
                             Force&& add_force) const {
  const double rest_length = fibre_lengths_[f];
  if (pull == 0.0 || rest_length <= 0.0) return 0.0;
  const uint32_t first = lattice_.fibre_offsets[f], last = lattice_.fibre_offsets[f + 1];
  double length = 0.0, energy = 0.0;
  for (uint32_t p = first; p + 1 < last; ++p)
    length += lattice_.fibre_taper[p] *
              formulas::segment_length(three(fibre_point(frame, p + 1, x) - fibre_point(frame, p, x)));
  const double tension = formulas::fibre_tension(pull, length, rest_length,
                                                 static_cast<double>(lattice_.fibre_shortest[f]), energy);
  if (tension == 0.0) return energy;
  for (uint32_t p = first; p + 1 < last; ++p) {
    const Vec3 along = fibre_point(frame, p + 1, x) - fibre_point(frame, p, x);
    const double segment = formulas::segment_length(three(along));
    const Vec3 force = (tension * lattice_.fibre_taper[p] / segment) * along;
    for (const uint32_t end : {p, p + 1}) {
      const auto anchor = static_cast<FibreAnchor>(lattice_.fibre_anchor[end]);
      if (anchor == FibreAnchor::cranium || anchor == FibreAnchor::mandible) continue;
      const double sign = end == p ? -1.0 : 1.0;
      for (size_t k = 0; k < 3; ++k)
        add_force(
            lattice_.fibre_nodes[end][k],
            Vec3((sign * static_cast<double>(lattice_.fibre_weights[end][static_cast<int>(k)])) * force));
    }
  }
  return energy;
}

double FaceModel::fibre_energy(const Frame& frame, const Vec3* x, Vec3* gradient) const {
  double energy = 0.0;
  const auto add = [gradient](uint32_t node, const Vec3& force) { gradient[node] += force; };
  for (uint32_t f = 0; f < lattice_.fibre_count(); ++f)
    energy += pull_fibre(frame, f, frame.fibre_pulls[f], x, add);
  return energy;
}

Vec3 FaceModel::carrier_pull(size_t c, double value, const Vec3& carried) const {
  if (value == 0.0) return Vec3::Zero();
  Vec3 axis = lattice_.carrier_axis[c].cast<double>();
  axis = axis.norm() > 1e-9 ? Vec3(axis.normalized()) : Vec3(Vec3::UnitX());
  return vec3(formulas::rotary_pull<double>(lattice_.carrier_drive[c], value, lattice_.carrier_angle[c],
                                            lattice_.carrier_reverse[c], three(axis),
                                            three(carried - lattice_.carrier_origin[c].cast<double>())));
}

void FaceModel::channel_slopes(const Frame& frame, const Controls& controls, const Vec3* x,
                               const Vec3* lambda, std::span<double> by_channel) const {
  const auto add = [&](uint32_t channel, double slope) {
    if (channel < by_channel.size()) by_channel[channel] += slope;
  };
  for (uint32_t f = 0; f < lattice_.fibre_count(); ++f) {
    const double value = std::max(0.0, value_of(controls.activations, lattice_.fibre_channel[f]));
    const double pull =
        formulas::activation_force_slope(value, options_.initial_force_slope) * lattice_.fibre_strength[f];
    double slope = 0.0;  // the energy is linear in the pull
    pull_fibre(frame, f, pull, x, [&](uint32_t node, const Vec3& force) {
      if (!prescribed(node)) slope += lambda[node].dot(force);
    });
    add(lattice_.fibre_channel[f], slope);
  }
  for (size_t c = 0; c < lattice_.carrier_node.size(); ++c) {
    const uint32_t node = lattice_.carrier_node[c];
    if (prescribed(node)) continue;
    const double value = value_of(controls.activations, lattice_.carrier_channel[c]), step = 1e-4;
    const double low =
        value > 0.0 ? value - std::min(step, value) : value - step;  // not across the bend at 0
    const double high = value < 0.0 ? value + std::min(step, -value) : value + step;
    const Vec3 change = carrier_pull(c, high, frame.carried[node]) -
                        carrier_pull(c, value == 0.0 ? 0.0 : low, frame.carried[node]);
    add(lattice_.carrier_channel[c], -lambda[node].dot(change) / (high - (value == 0.0 ? 0.0 : low)));
  }
  for (size_t p = 0; p < lattice_.pressure_prism.size(); ++p) {
    const SweptPrism swept = swept_prism(frame, p, x);
    const auto push = prism_volume_gradient(kSweptCorners, swept.corners.data());
    double slope = 0.0;
    for (size_t k = 0; k < 3; ++k)
      if (!prescribed(swept.nodes[k])) slope -= lambda[swept.nodes[k]].dot(push[k]);
    add(lattice_.pressure_channel[p], lattice_.pressure[p] * slope);
  }
}

FaceModel::SweptPrism FaceModel::swept_prism(const Frame& frame, size_t pressure, const Vec3* x) const {
  SweptPrism swept;
  for (size_t k = 0; k < 3; ++k) {
    swept.nodes[k] = lattice_.columns + lattice_.triangles[lattice_.pressure_prism[pressure]][k];
    swept.corners[k] = x[swept.nodes[k]];
    swept.corners[k + 3] = frame.carried[swept.nodes[k]];
  }
  return swept;
}

double FaceModel::actuator_energy(const Frame& frame, const Vec3* x, Vec3* gradient) const {
  double energy = 0.0;
  for (size_t c = 0; c < frame.carrier_pulls.size(); ++c) {
    const uint32_t node = lattice_.carrier_node[c];
    const Vec3 away = x[node] - frame.carried[node];
    gradient[node] += vec3(formulas::held_and_pulled<double>(
        lattice_.carrier_stiffness[c], three(frame.carrier_pulls[c]), three(away), energy));
  }
  for (size_t p = 0; p < frame.pressures.size(); ++p) {
    if (frame.pressures[p] == 0.0) continue;
    // Work of the pressure on the swept volume: to first order a push along the triangle's normal, however
    // far the patch's rim lies from its middle.
    const SweptPrism swept = swept_prism(frame, p, x);
    energy -= frame.pressures[p] * prism_volume(kSweptCorners, swept.corners.data());
    const auto push = prism_volume_gradient(kSweptCorners, swept.corners.data());
    for (size_t k = 0; k < 3; ++k)
      gradient[swept.nodes[k]] -= frame.pressures[p] * push[k];
  }
  energy += contacts_.energy(frame.mandible, x, gradient);
  const auto place = [x](uint32_t node) -> const Vec3& { return x[node]; };
  const auto add = [gradient](uint32_t node, const Vec3& force, double /*stiffness*/) {
    gradient[node] += force;
  };
  energy += contacts_.facing_energy(frame.facing, place, add);
  energy += Contacts::grip_energy(std::span(frame.grips).first(frame.grip_count), place, add);
  energy += touch_energy(frame.touches, rest_, place, add);
  if (frame.acceleration != Vec3::Zero()) {
    for (const uint32_t node : unknowns_) {
      gradient[node] -= masses_[node] * frame.acceleration;
      energy -= masses_[node] * frame.acceleration.dot(x[node] - rest_[node]);
    }
  }
  return energy;
}

double FaceModel::energy_beside_springs(const Frame& frame, const Vec3* x, Vec3* gradient) const {
  double energy = 0.0;
  for (const Membrane& membrane : membranes_)
    energy += membrane_energy(membrane, x, gradient);
  for (const Hinge& hinge : hinges_)
    energy += hinge_energy(hinge, x, gradient);
  for (const Prism& prism : prisms_)
    energy += prism_energy(prism, x, gradient);
  for (size_t t = 0; t < tethers_.size(); ++t)
    energy +=
        tether_energy(tethers_[t], frame.carried[tethers_[t].node], frame.tether_normals[t], x, gradient);
  energy += fibre_energy(frame, x, gradient);
  return energy + actuator_energy(frame, x, gradient);
}

double FaceModel::raw_energy(const Frame& frame, const Vec3* x, Vec3* gradient) const {
  std::fill(gradient, gradient + rest_.size(), Vec3::Zero());
  double energy = 0.0;
  for (const Spring& spring : springs_)
    energy += spring_energy(spring, x, gradient);
  return energy + energy_beside_springs(frame, x, gradient);
}

double FaceModel::balanced(double energy, const Vec3* x, Vec3* gradient) const {
  for (size_t i = 0; i < rest_.size(); ++i) {
    if (unknown_of_node_[i] < 0) {
      gradient[i].setZero();
      continue;
    }
    gradient[i] -= balance_[i];
    energy -= balance_[i].dot(x[i] - rest_[i]);
  }
  return energy;
}

double FaceModel::energy(const Frame& frame, const Vec3* x, Vec3* gradient) const {
  return balanced(raw_energy(frame, x, gradient), x, gradient);
}

EnergyShares FaceModel::energy_shares(const Frame& frame, const Vec3* x) const {
  Positions gradient(rest_.size(), Vec3::Zero());
  EnergyShares shares;
  for (const Spring& spring : springs_)
    shares.springs += spring_energy(spring, x, gradient.data());
  for (const Membrane& membrane : membranes_)
    shares.membranes += membrane_energy(membrane, x, gradient.data());
  for (const Hinge& hinge : hinges_)
    shares.bending += hinge_energy(hinge, x, gradient.data());
  for (const Prism& prism : prisms_)
    shares.volume += prism_energy(prism, x, gradient.data());
  for (size_t t = 0; t < tethers_.size(); ++t)
    shares.tethers += tether_energy(tethers_[t], frame.carried[tethers_[t].node], frame.tether_normals[t], x,
                                    gradient.data());
  shares.fibres = fibre_energy(frame, x, gradient.data());
  shares.others = balanced(actuator_energy(frame, x, gradient.data()), x, gradient.data());
  shares.total = shares.springs + shares.membranes + shares.bending + shares.volume + shares.tethers +
                 shares.fibres + shares.others;
  return shares;
}

double FaceModel::energy_beside_links(const Frame& frame, const Vec3* x, Vec3* gradient) const {
  std::fill(gradient, gradient + rest_.size(), Vec3::Zero());
  double energy = 0.0;
  for (const Spring& spring : springs_) {
    Spring rest_of_it = spring;
    if (!spring.one_sided) {  // what is stiffer than a link beyond its limit
      rest_of_it.stiffness = 0.0;
      rest_of_it.second_stiffness = spring.second_stiffness - spring.stiffness;
    }
    energy += spring_energy(rest_of_it, x, gradient);
  }
  return balanced(energy + energy_beside_springs(frame, x, gradient), x, gradient);
}

void FaceModel::hessian_times(const Frame& frame, const Vec3* x, const Vec3* direction, Vec3* result,
                              Positions& work) const {
  const size_t nodes = rest_.size();
  double largest = 0.0;
  for (const uint32_t i : unknowns_)
    largest = std::max(largest, direction[i].cwiseAbs().maxCoeff());
  std::fill(result, result + nodes, Vec3::Zero());
  if (largest == 0.0) return;
  const double step = 1e-7 / largest;  // 0.1 micrometre where it moves most
  Vec3* moved = work.data();
  Vec3* ahead = moved + nodes;
  Vec3* behind = ahead + nodes;
  for (size_t i = 0; i < nodes; ++i)
    moved[i] = unknown_of_node_[i] < 0 ? x[i] : Vec3(x[i] + step * direction[i]);
  energy(frame, moved, ahead);
  for (size_t i = 0; i < nodes; ++i)
    moved[i] = unknown_of_node_[i] < 0 ? x[i] : Vec3(x[i] - step * direction[i]);
  energy(frame, moved, behind);
  for (const uint32_t i : unknowns_)
    result[i] = (ahead[i] - behind[i]) / (2.0 * step);
}

}  // namespace fascia::sim
