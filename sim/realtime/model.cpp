#include "sim/realtime/model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::sim::realtime {
namespace {

constexpr size_t wide = batch_width;
float f(double value) {
  return static_cast<float>(value);
}

const Loops& loops_for([[maybe_unused]] lanes::InstructionSet instructions) {
#if defined(__x86_64__)
  switch (instructions) {
    case lanes::InstructionSet::avx512:
      return loops_avx512();
    case lanes::InstructionSet::avx2:
      return loops_avx2();
    case lanes::InstructionSet::baseline:
      break;
  }
#endif
  return loops_baseline();
}

}  // namespace

Model::Model(const FaceModel& face, lanes::InstructionSet instructions)
    : face_(&face), loops_(&loops_for(instructions)) {
  const Lattice& lattice = face.lattice();
  packed_.places = (16 * static_cast<size_t>(lattice.columns) + 4 * wide - 1) / (4 * wide) * (4 * wide);
  rest_ = Floats(packed_.places);
  balance_ = Floats(packed_.places);
  jaw_share_ = Floats(packed_.places / 4);
  for (size_t i = 0; i < face.rest().size(); ++i) {
    const auto at = static_cast<size_t>(slot_of(i));
    for (size_t axis = 0; axis < 3; ++axis)
      rest_.data()[at + axis] = lattice.rest[i][static_cast<int>(axis)];
    const auto kind = static_cast<NodeKind>(lattice.kinds[i]);
    const bool still = kind == NodeKind::fixed || kind == NodeKind::fixed_cranium;
    if (face.prescribed(i)) prescribed_slots_.push_back(static_cast<int32_t>(at));
    jaw_share_.data()[at / 4] = still ? 0.0F : lattice.jaw_weights[i];
  }
  packed_.rest = rest_.data();
  packed_.jaw_share = jaw_share_.data();
  for (const auto* list : {&lattice.fibre_channel, &lattice.carrier_channel, &lattice.pressure_channel})
    for (const uint32_t channel : *list)
      channels_ = std::max<size_t>(channels_, channel + 1);
  pack_triangles();
  pack_edges();
  pack_held();
  pack_fibres();
  if (!make_factors())
    fault_ =
        "its stiffness matrix is singular: some tissue is unconstrained, or an element is far stiffer than "
        "the others or flat at rest";
  else if (!find_balance())
    fault_ = "an element pulls at rest with a force that is not finite";
}

/// What fibres that pull add to the stiffness of the rest pose: each segment is a string under tension. At a
/// middling activation; the factors need only be near.
Eigen::SparseMatrix<double, Eigen::RowMajor> Model::fibre_stiffness() const {
  constexpr double middling = 0.25;
  const Lattice& lattice = face_->lattice();
  std::vector<int32_t> unknown_of(face_->rest().size(), -1);
  for (size_t i = 0; i < face_->unknowns().size(); ++i)
    unknown_of[face_->unknowns()[i]] = static_cast<int32_t>(i);
  std::vector<Eigen::Triplet<double>> triplets;
  for (uint32_t fibre = 0; fibre < lattice.fibre_count(); ++fibre)
    for (uint32_t p = lattice.fibre_offsets[fibre]; p + 1 < lattice.fibre_offsets[fibre + 1]; ++p) {
      const double length = (lattice.fibre_rest[p + 1] - lattice.fibre_rest[p]).cast<double>().norm();
      const double stiffness =
          middling * lattice.fibre_strength[fibre] * lattice.fibre_taper[p] / std::max(length, 1e-3);
      std::vector<std::pair<int32_t, double>> ends;
      for (uint32_t end = 0; end < 2; ++end) {
        const auto anchor = static_cast<FibreAnchor>(lattice.fibre_anchor[p + end]);
        if (anchor == FibreAnchor::cranium || anchor == FibreAnchor::mandible) continue;
        for (size_t k = 0; k < 3; ++k) {
          const int32_t unknown = unknown_of[lattice.fibre_nodes[p + end][k]];
          if (unknown >= 0)
            ends.emplace_back(unknown,
                              (end == 0 ? -1.0 : 1.0) * lattice.fibre_weights[p + end][static_cast<int>(k)]);
        }
      }
      for (const auto& [row, a] : ends)
        for (const auto& [column, b] : ends)
          triplets.emplace_back(row, column, stiffness * a * b);
    }
  const auto size = static_cast<Eigen::Index>(face_->unknowns().size());
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

bool Model::make_factors() {
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& stiffness = face_->stiffness();
  const auto& unknowns = face_->unknowns();
  Positions places;
  for (const uint32_t node : unknowns)
    places.push_back(face_->rest()[node]);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> pose = stiffness + fibre_stiffness();
  const Dissection dissection(pose, places);
  if (!pose_factor_.compute(dissection, pose)) return false;
  const double h = face_->options().substep;
  Eigen::SparseMatrix<double, Eigen::RowMajor> step =
      pose + (face_->options().stiffness_damping / h) * stiffness;
  for (size_t i = 0; i < unknowns.size(); ++i) {
    const auto k = static_cast<int>(i);
    step.coeffRef(k, k) += face_->masses()[unknowns[i]] * (1.0 / (h * h) + face_->options().mass_damping / h);
  }
  if (!step_factor_.compute(dissection, step)) return false;

  order_ = dissection.order();
  std::vector<uint32_t> position(order_.size());
  for (uint32_t k = 0; k < order_.size(); ++k)
    position[order_[k]] = k;
  begin_.push_back(0);
  for (const uint32_t unknown : order_) {
    slots_.push_back(slot_of(unknowns[unknown]));
    masses_.push_back(f(face_->masses()[unknowns[unknown]]));
    const auto k = static_cast<int>(unknown);
    pose_diagonal_.push_back(f(pose.coeff(k, k)));
    step_diagonal_.push_back(f(step.coeff(k, k)));
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(stiffness, static_cast<int>(unknown));
         e; ++e) {
      column_.push_back(static_cast<int32_t>(4 * position[static_cast<size_t>(e.col())]));
      value_.push_back(f(e.value()));
    }
    while (column_.size() % 4 != 0) {
      column_.push_back(0);
      value_.push_back(0.0F);
    }
    begin_.push_back(static_cast<uint32_t>(column_.size()));
  }
  unknown_floats_ = (4 * (slots_.size() + 1) + 4 * wide - 1) / (4 * wide) * (4 * wide);
  return true;
}

bool Model::find_balance() {
  std::unique_ptr<Workspace> work = borrow();
  Boundary at_rest = boundary(*work);
  set_jaw({}, at_rest);
  loops_->place(packed_, at_rest);
  loops_->energy(packed_, at_rest, rest_.data(), balance_.data());
  for (size_t i = 3; i < balance_.size(); i += 4)
    balance_.data()[i] = 0.0F;  // what is stiffer stays so
  packed_.balance = balance_.data();
  give_back(std::move(work));
  return std::all_of(balance_.data(), balance_.data() + balance_.size(),
                     [](float value) { return std::isfinite(value); });
}

Boundary Model::boundary(Workspace& work) const {
  Boundary d{};
  std::fill(work.values.begin(), work.values.end(), 0.0F);
  d.values = work.values.data();
  d.carried = work.carried.data();
  d.tether_normals = work.tether_normals.data();
  d.carrier_pulls = work.carrier_pulls.data();
  d.fibre_scratch = work.fibre_scratch.data();
  return d;
}

void Model::set_jaw(const JawPose& pose, Boundary& d) const {
  const Jaw& jaw = face_->jaw();
  d.jaw_at_rest = pose.at_rest();
  d.turn_open = f(pose.open * jaw.open_angle);
  d.turn_lateral = f(pose.lateral * jaw.lateral_angle);
  const RigidTransform mandible = jaw_transform(jaw, pose);
  const Vec3 glide = mandible * jaw.origin - jaw.origin;
  for (int row = 0; row < 3; ++row) {
    d.jaw_origin[row] = f(jaw.origin[row]);
    d.jaw_up[row] = f(jaw.up[row]);
    d.jaw_lateral[row] = f(jaw.lateral[row]);
    d.glide[row] = f(glide[row]);
    d.jaw_translation[row] = f(mandible.translation[row]);
    for (int column = 0; column < 3; ++column)
      d.jaw_rotation[3 * row + column] = f(mandible.rotation(row, column));
  }
}

std::string model_fault(const Lattice& lattice, const Jaw& jaw) {
  const FaceModel face(lattice, jaw);
  if (!face.valid()) return face.fault();
  return Model(face).fault();
}

std::unique_ptr<Workspace> Model::borrow() const {
  {
    const std::lock_guard lock(mutex_);
    if (!workspaces_.empty()) {
      std::unique_ptr<Workspace> work = std::move(workspaces_.back());
      workspaces_.pop_back();
      return work;
    }
  }
  auto work = std::make_unique<Workspace>();
  for (Floats* list : {&work->carried, &work->start, &work->begun_places, &work->gradient})
    *list = Floats(packed_.places);
  work->tether_normals = Floats(3 * wide * tethers_.size());
  work->carrier_pulls = Floats(3 * wide * carriers_.size());
  work->fibre_scratch = Floats(3 * wide * longest_fibre_);
  work->solve_scratch = Floats(pose_factor_.scratch());
  for (Floats* list : {&work->packed, &work->direction, &work->moved, &work->damped, &work->last_gradient,
                       &work->begun, &work->ballistic, &work->scaling})
    *list = Floats(unknown_floats_);
  for (auto* list : {&work->steps, &work->changes})
    for (size_t k = 0; k < Workspace::history; ++k)
      list->emplace_back(unknown_floats_);
  work->nodes.resize(face_->rest().size());
  work->nodes_before.resize(face_->rest().size());
  work->facing_search = face_->contacts().make_search();
  work->near_bones.reserve(face_->contacts().bone_nodes().size());
  work->values.resize(channels_);
  return work;
}

void Model::give_back(std::unique_ptr<Workspace> work) const {
  const std::lock_guard lock(mutex_);
  workspaces_.push_back(std::move(work));
}

}  // namespace fascia::sim::realtime
