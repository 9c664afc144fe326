#pragma once

// Data of a face's loops: plain numbers only, so that no inline library function is compiled for an
// unavailable instruction set.
//
// A position is four floats (x, y, z, unused). The positions of a column share a cache line: skin, SMAS,
// inner layer and an unused one; `at` in the lists below is 16 * column + 4 * layer. Elements are in batches
// of sixteen, each member of a batch being sixteen consecutive floats; the last batch is padded with elements
// without stiffness.

#include <cstddef>
#include <cstdint>

namespace fascia::sim::realtime {

constexpr size_t batch_width = 16;
using Sixteen = float[batch_width];
using SixteenAt = int32_t[batch_width];

/// A membrane at rest: see sim/energies.h. The inverse of its rest edges is upper triangular: (a, b; 0, c).
struct alignas(64) MembraneBatch {
  Sixteen a, b, c, area_mu, area_lambda;
};
struct alignas(64) PrismBatch {
  Sixteen volume, inverse_volume, stiffness, guard;
};
/// Two triangles of columns from skin to inner layer: both membranes, both prisms.
struct alignas(64) TriangleBatch {
  SixteenAt column[3];
  MembraneBatch membrane[2];
  PrismBatch prism[2];
};
struct alignas(64) HingeBatch {
  Sixteen weight[3];  ///< of the edge's second end and the opposite corners; that of the first makes the
                      ///< sum zero
  Sixteen stiffness, bend, scale_a, scale_b;
};
struct alignas(64) SpringBatch {
  Sixteen length, stiffness, limit, extra;
};
/// The springs of an edge: from its first column, in this layer, to its second, in that.
constexpr size_t edge_springs = 4;
constexpr size_t edge_spring_layers[edge_springs][2] = {{0, 1}, {1, 0}, {1, 2}, {2, 1}};
/// Both hinges of an edge between two triangles of columns, and the springs across it.
struct alignas(64) EdgeBatch {
  SixteenAt column[4];  ///< the edge's ends, then the corners opposite to it
  HingeBatch hinge[2];
  SpringBatch spring[edge_springs];
};
struct alignas(64) LooseSpringBatch {
  SixteenAt at[2];
  SpringBatch spring;
  Sixteen slack;  ///< stretch below which there is no force: -1 km, or 0 when one-sided
};
/// Anisotropic tethers to positions that move with the bones; carriers are tethers with an additional force.
struct alignas(64) TetherBatch {
  SixteenAt at;
  Sixteen normal[3], tangential, extra;
};
struct alignas(64) CarrierBatch {
  SixteenAt at;
  Sixteen origin[3], axis[3], angle, reverse, stiffness, pull_stiffness;
  SixteenAt channel;
};
struct alignas(64) GlobeBatch {
  SixteenAt at;
  Sixteen centre[3], radius, stiffness;
};
/// Points of sixteen fibres, point after point along them.
struct alignas(64) FibrePointBatch {
  SixteenAt at[3];
  Sixteen weight[3], base[3];
  Sixteen taper;     ///< of the segment that begins here; 0 at and past a fibre's end
  Sixteen mandible;  ///< 1: goes with it
};
struct alignas(64) FibreBatch {
  uint32_t first, count = 0;  ///< of its point batches
  Sixteen length, shortest, strength;
  SixteenAt channel;
};
struct alignas(64) PressureBatch {
  SixteenAt at[3];
  Sixteen pressure;
  SixteenAt channel;
};

/// The data of a model shared by its faces.
struct Packed {
  const TriangleBatch* triangles;
  const EdgeBatch* edges;
  const LooseSpringBatch* springs;
  const TetherBatch* tethers;
  const CarrierBatch* carriers;
  const GlobeBatch* globes;
  const FibreBatch* fibres;
  const FibrePointBatch* fibre_points;
  const PressureBatch* pressures;
  size_t triangle_batches, edge_batches, spring_batches, tether_batches, carrier_batches, globe_batches,
      fibre_batches, pressure_batches;
  size_t places;               ///< 4 * columns
  double initial_force_slope;  ///< see formulas::activation_force
  const float* rest;           ///< places
  const float* balance;        ///< positions: gradient at rest; null while it is computed
  const float* jaw_share;      ///< #positions, one float each: jaw weight
};

/// Boundary conditions of a solve: bones, actuators and channel values.
struct Boundary {
  const float* values;  ///< by channel
  float jaw_origin[3], jaw_up[3], jaw_lateral[3];
  float turn_open, turn_lateral;              ///< radians at share 1: about lateral, then about up
  float glide[3];                             ///< at share 1
  float jaw_rotation[9], jaw_translation[3];  ///< of the mandible itself, rows
  bool jaw_at_rest;
  float* carried;         ///< positions: under the rigid motion of the bones
  float* tether_normals;  ///< 3 x 16 a batch
  float* carrier_pulls;   ///< 3 x 16 a batch
  float* fibre_scratch;   ///< 3 x 16 per point of the longest batch
};

/// A sparse matrix over unknowns, the same for x, y and z. Rows are padded to a multiple of four entries.
struct SparseRows {
  size_t size;
  const uint32_t* begin;  ///< size + 1
  const int32_t* column;  ///< 4 * unknown
  const float* value;
};

/// A Cholesky factor by fronts, see dissection.h. A front with the diagonal block A and the block B below it
/// is stored as F = (A^-1; -B A^-1), so that forward substitution is one product with F and backward
/// substitution one with its transpose. Numbers have 16 bits: a solve is limited by memory bandwidth, and a
/// preconditioner may be rounded; both products use the same rounded numbers, so that it remains symmetric
/// and definite.
struct Panels {
  struct Front {
    uint32_t first, width;  ///< its unknowns
    uint32_t blocks;        ///< of sixteen rows of F
    uint32_t rows;          ///< into `row`: 16 * blocks, its own first
    uint32_t values;  ///< into `value`: block after block by columns, sixteen numbers each; columns after a
                      ///< block's last own row are left out
    uint32_t columns(uint32_t block) const {
      const auto last = static_cast<uint32_t>(batch_width) * (block + 1);
      return last < width ? last : width;
    }
  };
  size_t size, fronts;
  const Front* front;
  const int32_t* row;     ///< 4 * unknown, or 4 * size for none
  const uint16_t* value;  ///< the upper halves of floats
};

/// The unknowns of a solve, with the forces of inertia, damping and acceleration.
struct Unknowns {
  size_t count;
  const int32_t* slot;  ///< of each, into places
  const float* mass;
  const float* diagonal;             ///< of the factored matrix
  const float *rest, *x, *gradient;  ///< places
  const float *ballistic, *begun;    ///< by unknown: inertial prediction; position under the rigid motion of
                                     ///< the bones at the beginning
  float acceleration[3];
  float per_mass, drag, stiff;  ///< 1 / h^2 and dampings over h; all 0 in a static pose
};

/// One iteration without line search: each node moves along the direction with a step size of its own.
struct NodeSteps {
  size_t count;            ///< unknowns
  const int32_t* slot;     ///< of each, into places
  const float* direction;  ///< 4 an unknown
  bool judges;             ///< whether step sizes are updated
  /// Gradients now and before the last step, 4 per unknown; the latter is null if the last step was in
  /// another substep.
  const float *gradient, *gradient_before;
  float* last;  ///< 4 an unknown: each node's last step, possibly of another solve; on return the current one
  float* step_scale;  ///< of each unknown, 0.02 to 1: its step size; smaller where a step overshot
  float* x;           ///< places
};

/// The initial guess of a time step.
struct StepStart {
  size_t count;
  const int32_t* slot;
  const float *velocity, *carried, *carried_before, *step_scale;
  float seconds;
  float* x;                  ///< positions; unknowns are set to the initial guess
  float *ballistic, *begun;  ///< by unknown
  float* begun_places;       ///< as `begun`, by place
};

struct Loops {
  /// Updates rigidly moved positions, tether normals and carrier forces.
  void (*place)(const Packed&, const Boundary&);
  /// Energy of everything but contact with bones and lips at `x` (places), joules; writes the gradient
  /// (positions), and in each fourth float a bound of the stiffness added relative to rest, newton per metre,
  /// by barriers and stiffened springs.
  double (*energy)(const Packed&, const Boundary&, const float* x, float* gradient);
  /// The same gradient without the energy: 0 is returned.
  double (*gradient)(const Packed&, const Boundary&, const float* x, float* gradient);
  /// Volume of a batch's prisms at `x`, relative to rest: 16 outer ones, then 16 inner ones.
  void (*volume_ratios)(const Packed&, size_t batch, const float* x, float* shares);
  /// out = matrix * x over unknowns.
  void (*multiply)(const SparseRows&, const float* x, float* out);
  /// Displacement of the unknowns relative to the rigid motion of the bones.
  void (*subtract)(const Unknowns&, float* moved);
  /// Gradient over unknowns with inertia, damping and acceleration, whose energy is returned. `scaling`: S of
  /// a step S P^-1 S with S^2 = p / (p + more), which reduces the step of nodes that are stiffer than in the
  /// factor; one per float of `packed`.
  double (*collect)(const Unknowns&, const float* moved, const float* damped, float* packed, float* scaling);
  /// out = factors * list, number by number; the two may be one.
  void (*scale)(const float* factors, const float* list, float* out, size_t count);
  /// Solves in place over unknowns (4 x (size + 1) floats, the last position unused). `scratch` of the size
  /// PanelFactor::scratch.
  void (*solve)(const Panels&, float* values, float* scratch);
  /// One iteration without line search, with two safeguards: a bound on the displacement of a node, and a
  /// step size for each node. Within a substep it is the secant's along the node's last step (Barzilai &
  /// Borwein 1988, node by node), between bounds; where a substep has one iteration it shrinks where steps
  /// reverse and grows back where they do not (resilient propagation, Riedmiller & Braun 1993).
  /// Hestenes-Stiefel momentum (Hestenes & Stiefel 1952), at most 1, over nodes whose step sizes are near 1,
  /// compensates for the missing line search along the last step.
  void (*take_steps)(const NodeSteps&);
  /// Computes the inertial prediction and the rigid motion with the bones for the unknowns, and sets x to an
  /// initial guess between the two.
  void (*begin_step)(const StepStart&);
  double (*dot)(const float* a, const float* b, size_t count);
  void (*add)(float factor, const float* a, float* to,
              size_t count);  ///< to += factor * a; counts are multiples of 16
  /// Largest squared norm.
  float (*largest)(const float* a, size_t count);
};
const Loops& loops_baseline();
const Loops& loops_avx2();
const Loops& loops_avx512();

}  // namespace fascia::sim::realtime
