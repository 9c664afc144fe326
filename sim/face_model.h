#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "sim/activation.h"
#include "sim/contact.h"
#include "sim/energies.h"
#include "sim/jaw.h"
#include "sim/lattice.h"
#include "sim/rest_factor.h"

namespace fascia::sim {

/// Constants of a face that are the same for its whole tissue. The defaults are those of a rig without
/// `mechanics` (rig/spec/FASCIA_tissue).
struct FaceModelOptions {
  double substep = 1.0 / 120.0;       ///< seconds; frames are divided into these
  double stiffness_damping = 0.004;   ///< seconds: damping force per stiffness force and unit of rate
  double mass_damping = 8.0;          ///< per second
  double initial_force_slope = 0.45;  ///< see formulas::activation_force
  ActivationDynamics dynamics;
  ContactOptions contact;
};

/// The options of a rig's tissue, whose `mechanics` is an optional struct with these names.
template <class Tissue>
FaceModelOptions face_options_of(const Tissue& tissue) {
  FaceModelOptions options;
  if (!tissue.mechanics) return options;
  const auto& from = *tissue.mechanics;
  options.stiffness_damping = from.stiffness_damping;
  options.mass_damping = from.mass_damping;
  options.initial_force_slope = from.initial_force_slope;
  options.dynamics = {from.activation_rise, from.activation_decay};
  ContactOptions& contact = options.contact;
  contact.globe_stiffness = from.globe_stiffness;
  contact.bone_stiffness = from.bone_stiffness;
  contact.facing_stiffness = from.facing_stiffness;
  contact.thickness = from.contact_thickness;
  contact.lid_thickness = from.lid_thickness;
  contact.friction = from.friction;
  contact.sticky_reach = from.sticky_reach;
  contact.sticky_stiffness = from.sticky_stiffness;
  contact.lips = {from.lip_range.before, from.lip_range.behind, from.lip_range.beside};
  contact.lids = {from.lid_range.before, from.lid_range.behind, from.lid_range.beside};
  return options;
}

/// An external force on one node, newton in the head's frame.
struct NodeForce {
  uint32_t node = 0;
  Vec3 force = Vec3::Zero();
};

/// Energy of external forces, joules relative to rest; `place` and `add` as in Contacts::facing_energy.
template <class Place, class Add>
double touch_energy(std::span<const NodeForce> touches, const Positions& rest, const Place& place,
                    const Add& add) {
  double energy = 0.0;
  for (const NodeForce& touch : touches) {
    if (touch.node >= rest.size() || !touch.force.allFinite()) continue;
    add(touch.node, -touch.force, 0.0);
    energy -= touch.force.dot(place(touch.node) - rest[touch.node]);
  }
  return energy;
}

/// The inputs of a face at one moment: channel values, the jaw, external forces.
struct Controls {
  std::span<const float> activations;  ///< one per channel; missing channels are 0
  JawPose jaw;
  Vec3 acceleration = Vec3::Zero();  ///< of free tissue in the head's frame, m/s^2 (gravity change, inertia)
  std::span<const NodeForce> touches = {};  ///< must outlive the solve

  /// The activation of channel `c`; 0 beyond the end, and for NaN.
  float activation(size_t c) const {
    return c < activations.size() && std::isfinite(activations[c]) ? activations[c] : 0.0F;
  }
  /// True if the acceleration and the first `channels` activations are finite.
  bool is_finite(size_t channels) const {
    const auto known = activations.first(std::min(channels, activations.size()));
    return acceleration.allFinite() &&
           std::all_of(known.begin(), known.end(), [](float value) { return std::isfinite(value); });
  }
};

/// Boundary conditions of a solve: bones and kinematic guides (carriers) for the controls.
struct Frame {
  Positions carried;                ///< #nodes: position under the rigid motion of its bones
  Positions tether_normals;         ///< #tethers
  Positions carrier_pulls;          ///< #carriers: force in newton
  Positions fibre_anchors;          ///< #fibre points; meaningful where anchored to a bone
  std::vector<double> fibre_pulls;  ///< #fibres, newton at rest length
  std::vector<double> pressures;    ///< #pressures, pascal
  Vec3 acceleration = Vec3::Zero();
  RigidTransform mandible;
  std::vector<FacingPair> facing;  ///< contact pairs of lips and lids: see FaceModel::find_facing
  FacingSearch facing_search;
  std::vector<Grip> grips;  ///< preallocated; friction, in time steps
  size_t grip_count = 0;
  std::span<const NodeForce> touches;
};

/// Energy of a configuration by element type, joules; `total` is their sum, as returned by FaceModel::energy.
struct EnergyShares {
  double springs = 0.0, membranes = 0.0, bending = 0.0, volume = 0.0, tethers = 0.0, fibres = 0.0;
  double others =
      0.0;  ///< carriers, pressure, contact, touches, acceleration, and the correction of the rest forces
  double total = 0.0;
};

/// A face prepared for solving: elements at rest and factors, shared by all instances. Immutable, so any
/// number of instances and threads may use it. It keeps the spans of `lattice`, whose arrays must outlive it.
class FaceModel {
 public:
  /// Creates the model; for an invalid lattice `fault()` is set and the model must not be used.
  FaceModel(const Lattice& lattice, const Jaw& jaw, const FaceModelOptions& options = {});

  bool valid() const { return fault_.empty(); }
  const std::string& fault() const { return fault_; }

  /// A frame of the right sizes, at rest.
  Frame make_frame() const;
  /// Moves bones and carriers of `frame` to `controls`. Allocates nothing.
  void place(const Controls& controls, Frame& frame) const;

  /// Updates the contact pairs of lips and lids at `x`; returns the largest change of a gap, metres.
  double find_facing(const Vec3* x, Frame& frame) const {
    return contacts_.find_facing(x, frame.facing, frame.facing_search);
  }

  /// Joules of the configuration `x` (#nodes), above those of the rest pose; writes the gradient in newtons
  /// (#nodes, zero for prescribed nodes). The same energies are used for poses and steps.
  double energy(const Frame& frame, const Vec3* x, Vec3* gradient) const;

  /// The same energy by element type. Allocates.
  EnergyShares energy_shares(const Frame& frame, const Vec3* x) const;
  /// Tension of a fibre at `x`, newton.
  double fibre_tension(const Frame& frame, uint32_t fibre, const Vec3* x) const;

  /// The same without linear two-sided springs, for a solver that has springs of its own.
  double energy_beside_links(const Frame& frame, const Vec3* x, Vec3* gradient) const;

  /// Hessian-vector product H(x) v, by central differences of the gradient in double precision (error about
  /// 1e-8 of its size). `work` holds 3 x #nodes.
  void hessian_times(const Frame& frame, const Vec3* x, const Vec3* direction, Vec3* result,
                     Positions& work) const;

  /// Assembles a positive semidefinite approximation of the Hessian at `x`, for Newton steps: the projected
  /// Hessians of all elements except pressures. Allocates while `out` grows to its size.
  void find_curvature(const Frame& frame, const Vec3* x, Curvature& out) const;

  /// Adds, for each channel, lambda . d gradient / d activation at `x`: fibres, carriers and pressures (the
  /// jaw and eyes move bones and are not among them). `frame` must be placed for `controls`; `lambda` is
  /// #nodes, zero where prescribed.
  void channel_slopes(const Frame& frame, const Controls& controls, const Vec3* x, const Vec3* lambda,
                      std::span<double> by_channel) const;

  const Lattice& lattice() const { return lattice_; }
  const Jaw& jaw() const { return jaw_; }
  const FaceModelOptions& options() const { return options_; }
  const Positions& rest() const { return rest_; }
  const std::vector<uint32_t>& unknowns() const { return unknowns_; }        ///< free nodes
  bool prescribed(size_t node) const { return unknown_of_node_[node] < 0; }  ///< moves rigidly with its bone
  const std::vector<double>& masses() const { return masses_; }              ///< #nodes
  /// Factors in double precision, of the rest stiffness, and of mass, damping and stiffness of a substep.
  /// Computed on first use, thread-safe; used only by the reference solver.
  const RestFactor& pose_factor() const;
  const RestFactor& step_factor() const;
  /// False when the rest stiffness is not positive definite: some part is not constrained.
  bool has_factors() const { return pose_factor().size() == unknowns_.size(); }
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& stiffness() const {
    return stiffness_;
  }  ///< over unknowns
  const Contacts& contacts() const { return contacts_; }
  const std::vector<double>& column_areas() const {
    return column_areas_;
  }  ///< #columns, of the skin's triangles around each
  const std::vector<Spring>& springs() const { return springs_; }
  const std::vector<Prism>& prisms() const { return prisms_; }
  const std::vector<Membrane>& membranes() const { return membranes_; }  ///< skin first, then SMAS
  const std::vector<Hinge>& hinges() const { return hinges_; }           ///< skin first, then SMAS
  const std::vector<Tether>& tethers() const { return tethers_; }
  const std::vector<double>& fibre_lengths() const { return fibre_lengths_; }  ///< taper-weighted, at rest

 private:
  void make_elements();
  void make_hinges();
  void assemble_stiffness();
  double raw_energy(const Frame& frame, const Vec3* x, Vec3* gradient) const;
  double energy_beside_springs(const Frame& frame, const Vec3* x, Vec3* gradient) const;
  double balanced(double energy, const Vec3* x, Vec3* gradient) const;
  void add_fibre_curvature(const Frame& frame, uint32_t fibre, const Vec3* x, Curvature& out) const;
  double fibre_energy(const Frame& frame, const Vec3* x, Vec3* gradient) const;
  template <class Force>
  double pull_fibre(const Frame& frame, uint32_t fibre, double pull, const Vec3* x, Force&& add_force) const;
  Vec3 carrier_pull(size_t carrier, double value, const Vec3& carried) const;
  /// The volume swept by the SMAS over one pressurised triangle, relative to the rigid motion of its bones.
  struct SweptPrism {
    std::array<Vec3, 6> corners;      ///< of the SMAS: current, then under the rigid motion of its bones
    std::array<uint32_t, 3> nodes{};  ///< of the SMAS
  };
  SweptPrism swept_prism(const Frame& frame, size_t pressure, const Vec3* x) const;
  double actuator_energy(const Frame& frame, const Vec3* x, Vec3* gradient) const;
  Vec3 fibre_point(const Frame& frame, size_t point, const Vec3* x) const;

  Lattice lattice_;
  Jaw jaw_;
  FaceModelOptions options_;
  std::string fault_;
  Positions rest_;
  std::vector<double> masses_;
  std::vector<uint32_t> unknowns_;
  std::vector<int32_t> unknown_of_node_;
  std::vector<Spring> springs_;
  std::vector<Membrane> membranes_;
  std::vector<Hinge> hinges_;
  std::vector<Prism> prisms_;
  std::vector<Tether> tethers_;
  std::vector<double> fibre_lengths_;  // taper-weighted, at rest
  Contacts contacts_;
  std::vector<double> column_areas_;
  Positions balance_;  // gradient at rest: subtracted so that rest is an exact equilibrium
  Eigen::SparseMatrix<double, Eigen::RowMajor> stiffness_;
  mutable std::once_flag pose_once_, step_once_;
  mutable RestFactor pose_factor_, step_factor_;
};

}  // namespace fascia::sim
