#pragma once

#include <limits>
#include <vector>

#include "sim/curvature.h"
#include "sim/jaw.h"
#include "sim/lattice.h"
#include "sim/vector.h"

namespace fascia::sim {

/// Where a point may lie to be in contact with a facing lip or lid, metres.
struct FacingRange {
  double before = 0.0;  ///< in front of the surface
  double behind = 0.0;  ///< behind it; deeper points belong to another surface
  double beside = 0.0;  ///< beside it
};

/// Contact parameters. Contacts are penalties: a node closer than its margin is pushed back by the stiffness
/// times the violation. A margin is never larger than the distance at rest, so that rest remains an
/// equilibrium. The defaults are those of a rig without `mechanics` (rig/spec/FASCIA_tissue).
struct ContactOptions {
  double globe_stiffness = 200.0;   ///< newton per metre a node
  double bone_stiffness = 150.0;    ///< newton per metre a node
  double facing_stiffness = 150.0;  ///< newton per metre a node
  double thickness = 0.0004;        ///< metres: margin between skin and bone, lip and lip
  double lid_thickness =
      -0.0003;  ///< between the lids: their margins overlap slightly, so that no slit is left between nodes
  double friction = 0.3;           ///< Coulomb coefficient of moist mucosa and skin; in time steps only
  double stickiness = 0.0;         ///< 0..1: adhesion of lips in contact before they part; in time steps only
  double sticky_reach = 0.003;     ///< metres: gap at which lips part at stickiness 1
  double sticky_stiffness = 20.0;  ///< newton per metre a node, at stickiness 1
  FacingRange lips = {0.006, 0.0025, 0.0015};
  FacingRange lids = {0.014, 0.0040, 0.0040};  ///< wider: edges meet head on across the whole fissure
};

/// A signed distance field of a bone on a grid in the bone's frame.
class DistanceField {
 public:
  /// Field `index` of the lattice, which must be valid.
  DistanceField(const Lattice& lattice, size_t index);
  /// Distance in metres at `point`, negative inside, and its gradient: quadratic B-splines on the grid, so
  /// the gradient is continuous. Outside the grid it is extrapolated.
  double sample(const Vec3& point, Vec3& gradient) const;
  /// Upper bound of the gradient's length: how much the distance may change over a metre. 1 for an exact
  /// field of one solid; its grid, its rounding and surfaces thinner than a cell make it more.
  double steepness() const { return steepness_; }

 private:
  double largest_slope() const;

  std::span<const uint8_t> values_;
  std::array<uint32_t, 3> size_;
  Vec3 origin_;
  double spacing_, step_, steepness_ = 1.0;
};

/// A contact pair of a node and a triangle of the facing lip or lid, both free to move; the normal is fixed
/// during one solve.
struct FacingPair {
  static constexpr uint32_t none = std::numeric_limits<uint32_t>::max();
  uint32_t node = none;
  std::array<uint32_t, 3> corners{none, none, none};  ///< none: no contact
  Vec3 weights = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, outward, interpolated between the normals of the triangle's corners
  double margin = 0.0;         ///< minimum gap
  bool is_found() const { return corners[0] != none; }
  /// False if it has a node index beyond `nodes`.
  bool fits(size_t nodes) const {
    const auto known = [nodes](uint32_t index) { return index < nodes; };
    if (corners[0] == none) return known(node) || node == none;
    return known(node) && known(corners[0]) && known(corners[1]) && known(corners[2]);
  }
  double gap(const Vec3* x) const {
    Vec3 place = Vec3::Zero();
    for (size_t k = 0; k < 3; ++k)
      place += weights[static_cast<int>(k)] * x[corners[k]];
    return normal.dot(x[node] - place);
  }
};

/// A friction constraint of a node in contact, for one time step: W = stiffness/2 |P (x - place - anchor)|^2,
/// P projecting out the normal. Also the adhesion of sticky lips, with a normal component.
struct Grip {
  uint32_t node = 0;
  std::array<uint32_t, 3> corners{FacingPair::none, FacingPair::none,
                                  FacingPair::none};  ///< none: the other side is a bone
  Vec3 weights = Vec3::Zero(), normal = Vec3::Zero(), anchor = Vec3::Zero();
  double stiffness = 0.0, normal_stiffness = 0.0;
};

/// Workspace of a search for contact pairs.
struct FacingSearch {
  size_t side = 6;            ///< the side of the triangles; 6: none yet
  size_t bundle = 8;          ///< neighbouring triangles per cluster
  std::vector<Vec3> centres;  ///< of each cluster
  std::vector<double> radii, squared;
  std::vector<Vec3> middles;    ///< of each triangle
  std::vector<double> reaches;  ///< of each triangle, from its middle to its farthest corner
  std::vector<Vec3> normals;    ///< of the side's nodes, unit
};

/// All contact of a face; created once and shared by every instance.
class Contacts {
 public:
  Contacts() = default;
  Contacts(const Lattice& lattice, const std::vector<Vec3>& rest, const ContactOptions& options);

  /// Energies of nodes against eyeballs and bones, joules; adds to the gradient.
  double energy(const RigidTransform& mandible, const Vec3* x, Vec3* gradient) const;
  /// Energy of found pairs. The same for pairs and friction constraints, independent of the solver's storage:
  /// `place(node)` returns a node's position, and `add(node, force, stiffness)` adds to its gradient and to
  /// the bound of its added stiffness (newton per metre).
  template <class Place, class Add>
  double facing_energy(std::span<const FacingPair> pairs, const Place& place, const Add& add) const;
  template <class Place, class Add>
  static double grip_energy(std::span<const Grip> grips, const Place& place, const Add& add);

  /// A node against a surface: depth beyond the margin (negative: distance to it), metres, and the surface's
  /// normal.
  struct Touch {
    double depth = 0.0;
    Vec3 normal = Vec3::Zero();
  };
  /// For a contact with bone, at the node's position in the bone's frame; the normal, in the same frame, is
  /// the field's gradient, of unit length up to interpolation error.
  Touch bone_touch(size_t contact, const Vec3& local) const {
    Touch touch;
    touch.depth = bone_margins_[contact] - bone_field(contact).sample(local, touch.normal);
    return touch;
  }

  /// Adds the contributions of globes, bones, pairs and friction to the Hessian, without the surfaces'
  /// curvature.
  void add_curvature(const RigidTransform& mandible, std::span<const FacingPair> pairs,
                     std::span<const Grip> grips, const Vec3* x, Curvature& out) const;

  /// Finds the closest point of the other side for each facing node at the configuration `x`. #facing nodes;
  /// returns the largest change of a gap against the previous pairs, metres. With `every` above 1 only the
  /// pairs first, first + every, ... are updated.
  double find_facing(const Vec3* x, std::span<FacingPair> pairs, FacingSearch& search, size_t first = 0,
                     size_t every = 1) const;
  /// A workspace of sufficient size.
  FacingSearch make_search() const;
  /// Finds the friction constraints after a step from `before` to `x`, both #nodes, for the next step;
  /// returns their number in `grips`. `mandible_step` is the bones' motion in the next step; `near_bones` are
  /// the contacts with bone to test, by default all.
  size_t find_grips(const RigidTransform& mandible, const RigidTransform& mandible_step,
                    std::span<const FacingPair> pairs, const Vec3* before, const Vec3* x,
                    std::span<Grip> grips, const std::vector<uint32_t>* near_bones = nullptr) const;

  size_t facing_count() const { return facing_nodes_.size(); }
  size_t grip_capacity() const { return globe_nodes_.size() + bone_nodes_.size() + facing_nodes_.size(); }
  std::span<const uint32_t> globe_nodes() const { return globe_nodes_; }
  std::span<const uint32_t> bone_nodes() const { return bone_nodes_; }
  std::span<const uint32_t> soft_nodes() const {
    return soft_nodes_;
  }  ///< against eyeballs, and of surfaces that face others
  bool bone_moves(size_t contact) const {
    return field_bones_[bone_fields_[contact]] == 1;
  }  ///< with the mandible
  const DistanceField& bone_field(size_t contact) const { return fields_[bone_fields_[contact]]; }
  std::span<const Vec3> globe_centres() const { return globe_centres_; }  ///< of each contact, as the radii
  std::span<const double> globe_radii() const { return globe_radii_; }
  const ContactOptions& options() const { return options_; }

  /// Largest penetration beyond a margin, metres.
  double deepest(const RigidTransform& mandible, const Vec3* x) const;

 private:
  struct Side {
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<std::array<uint32_t, 3>> corners;  ///< of each triangle: its corners' places in `fans`
    std::vector<std::vector<uint32_t>> fans;       ///< of each node: the side's triangles around it
  };
  Touch globe_touch(size_t contact, const Vec3* x) const;
  Touch bone_touch(size_t contact, const RigidTransform& mandible, const Vec3* x) const;
  static Vec3 fan_area(const Side& side, uint32_t fan, const Vec3* x);
  void look_at_side(size_t side, const Vec3* x, FacingSearch& search) const;
  void pair_of(size_t contact, const Vec3* x, FacingSearch& search, FacingPair& pair) const;

  ContactOptions options_;
  std::vector<uint32_t> globe_nodes_;
  std::vector<Vec3> globe_centres_;  ///< of each contact
  std::vector<double> globe_radii_;  ///< of each contact
  std::vector<DistanceField> fields_;
  std::vector<uint8_t> field_bones_;
  std::vector<uint32_t> bone_nodes_, bone_fields_;
  std::vector<double> bone_margins_;
  std::array<Side, 6> sides_;
  std::vector<uint32_t> soft_nodes_;
  std::vector<uint32_t> facing_nodes_;
  std::vector<uint8_t> facing_sides_;
  std::vector<double> facing_margins_;
  std::vector<uint32_t> facing_fans_;  ///< of each facing node: its place in its side's `fans`
};

template <class Place, class Add>
double Contacts::facing_energy(std::span<const FacingPair> pairs, const Place& place, const Add& add) const {
  double energy = 0.0;
  for (const FacingPair& pair : pairs) {
    if (!pair.is_found()) continue;
    Vec3 gap = place(pair.node);
    for (size_t k = 0; k < 3; ++k)
      gap -= pair.weights[static_cast<int>(k)] * place(pair.corners[k]);
    const double depth = pair.margin - pair.normal.dot(gap);
    if (depth <= 0.0) continue;
    const Vec3 push = (options_.facing_stiffness * depth) * pair.normal;
    const double stiffness = 2.0 * options_.facing_stiffness;  // both sides are deformable
    energy += 0.5 * options_.facing_stiffness * depth * depth;
    add(pair.node, -push, stiffness);
    for (size_t k = 0; k < 3; ++k) {
      const double weight = pair.weights[static_cast<int>(k)];
      add(pair.corners[k], weight * push, weight * stiffness);
    }
  }
  return energy;
}

template <class Place, class Add>
double Contacts::grip_energy(std::span<const Grip> grips, const Place& place, const Add& add) {
  double energy = 0.0;
  for (const Grip& grip : grips) {
    Vec3 slip = place(grip.node) - grip.anchor;
    const bool facing = grip.corners[0] != FacingPair::none;
    for (size_t k = 0; facing && k < 3; ++k)
      slip -= grip.weights[static_cast<int>(k)] * place(grip.corners[k]);
    const double along = grip.normal.dot(slip);
    const Vec3 force =
        grip.stiffness * (slip - along * grip.normal) + (grip.normal_stiffness * along) * grip.normal;
    energy += 0.5 * force.dot(slip);
    add(grip.node, force, grip.stiffness + grip.normal_stiffness);
    for (size_t k = 0; facing && k < 3; ++k)
      add(grip.corners[k], -grip.weights[static_cast<int>(k)] * force, 0.0);
  }
  return energy;
}

}  // namespace fascia::sim
