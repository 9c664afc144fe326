#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "sim/face_model.h"
#include "sim/lanes/instruction_set.h"
#include "sim/realtime/dissection.h"
#include "sim/realtime/floats.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {

/// Workspace of a solve, shared by faces.
struct Workspace {
  static constexpr size_t history = 6;
  Floats carried, start, begun_places, gradient, tether_normals, carrier_pulls,
      fibre_scratch;  // places and batches
  Floats solve_scratch;
  Floats packed, direction, moved, damped, last_gradient, begun, ballistic, scaling;  // unknowns
  std::vector<Floats> steps, changes;                                                 // `history` of unknowns
  Positions nodes, nodes_before;                                                      // #nodes, for contact
  std::vector<float> values;                                                          // by channel
  std::vector<Grip> grips;
  FacingSearch facing_search;
  std::vector<uint32_t> near_bones;  // contacts that may touch
};

/// A face model with the data layout of the loops: the same energies in single precision, with factors of its
/// own. Immutable except for its pool of workspaces, so any number of faces and threads may use it.
class Model {
 public:
  /// `face` must be valid and outlive this. If its factors cannot be computed, `fault()` is set, and the
  /// model must not be used.
  explicit Model(const FaceModel& face, lanes::InstructionSet instructions = lanes::instruction_set());

  const FaceModel& face() const { return *face_; }
  const Packed& packed() const { return packed_; }
  const Loops& loops() const { return *loops_; }
  size_t places() const { return packed_.places; }  ///< floats of a list of positions
  size_t unknowns() const { return slots_.size(); }
  size_t unknown_floats() const { return unknown_floats_; }     ///< of a list of unknowns
  const std::vector<int32_t>& slots() const { return slots_; }  ///< of each unknown in the factors' order
  /// Of each unknown in the factors' order: which one of the face model's it is.
  const std::vector<uint32_t>& order() const { return order_; }
  const std::vector<int32_t>& prescribed_slots() const {
    return prescribed_slots_;
  }  ///< of nodes that move rigidly with their bones
  int32_t slot_of(size_t node) const {
    const size_t columns = face_->lattice().columns;
    return static_cast<int32_t>(16 * (node % columns) + 4 * (node / columns));
  }
  Panels pose_factor() const { return pose_factor_.view(); }
  Panels step_factor() const { return step_factor_.view(); }
  const float* pose_diagonal() const {
    return pose_diagonal_.data();
  }  ///< of the factored matrices, each unknown's
  const float* step_diagonal() const { return step_diagonal_.data(); }
  SparseRows stiffness() const { return {slots_.size(), begin_.data(), column_.data(), value_.data()}; }
  Unknowns unknown_list() const {
    Unknowns list{};
    list.count = slots_.size();
    list.slot = slots_.data();
    list.mass = masses_.data();
    list.rest = packed_.rest;
    return list;
  }
  /// The element of batch b and lane l, or one past the last: the order of triangles in the batches.
  size_t triangle_at(size_t batch, size_t lane) const { return lane * packed_.triangle_batches + batch; }
  size_t factor_entries() const { return pose_factor_.entries(); }
  bool valid() const { return fault_.empty(); }
  const std::string& fault() const { return fault_; }

  /// Boundary conditions of a solve; points into `work` and must be set before use.
  Boundary boundary(Workspace& work) const;
  /// Sets the controls; see FaceModel::place. `values` one per channel, finite.
  void set_jaw(const JawPose& jaw, Boundary& boundary) const;

  std::unique_ptr<Workspace> borrow() const;
  void give_back(std::unique_ptr<Workspace> work) const;

 private:
  void pack_triangles();
  void pack_edges();
  void pack_held();
  void pack_fibres();
  bool find_balance();  ///< false if it is not finite
  Eigen::SparseMatrix<double, Eigen::RowMajor> fibre_stiffness() const;
  bool make_factors();

  const FaceModel* face_;
  const Loops* loops_;
  Packed packed_{};
  std::vector<TriangleBatch> triangles_;
  std::vector<EdgeBatch> edges_;
  std::vector<LooseSpringBatch> springs_;
  std::vector<TetherBatch> tethers_;
  std::vector<CarrierBatch> carriers_;
  std::vector<GlobeBatch> globes_;
  std::vector<FibreBatch> fibres_;
  std::vector<FibrePointBatch> fibre_points_;
  std::vector<PressureBatch> pressures_;
  Floats rest_, balance_, jaw_share_;
  size_t longest_fibre_ = 0, channels_ = 0, unknown_floats_ = 0;
  std::vector<uint32_t> order_;
  std::vector<int32_t> slots_, prescribed_slots_;
  std::vector<float> masses_;
  std::vector<uint32_t> begin_;
  std::vector<int32_t> column_;
  std::vector<float> value_;
  PanelFactor pose_factor_, step_factor_;
  std::vector<float> pose_diagonal_, step_diagonal_;
  std::string fault_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Workspace>> workspaces_;
};

/// The reason why `lattice` with `jaw` cannot be simulated, or empty; creates a complete model and discards
/// it, which takes as long as creating the first face (about 100 ms at medium detail).
std::string model_fault(const Lattice& lattice, const Jaw& jaw);

}  // namespace fascia::sim::realtime
