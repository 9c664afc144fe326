#include "sim/realtime/model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace fascia::sim::realtime {
namespace {

constexpr size_t wide = batch_width;
constexpr float never = -1e3F;  // metres: no spring is that much shorter than at rest

size_t batches(size_t count) { return (count + wide - 1) / wide; }
float f(double value) { return static_cast<float>(value); }

const Loops& loops_for([[maybe_unused]] lanes::InstructionSet instructions) {
#if defined(__x86_64__)
  switch (instructions) {
    case lanes::InstructionSet::avx512: return loops_avx512();
    case lanes::InstructionSet::avx2: return loops_avx2();
    case lanes::InstructionSet::baseline: break;
  }
#endif
  return loops_baseline();
}

void put(Sixteen* list, size_t lane, const Vec3& value) {
  for (size_t axis = 0; axis < 3; ++axis) list[axis][lane] = f(value[static_cast<int>(axis)]);
}

/// Fills what is left of the last batch with copies of its last element, which `weaken(batch, lane)` then robs of all stiffness.
template <class Batch, class Weaken>
void fill_up(std::vector<Batch>& list, size_t count, Weaken&& weaken) {
  if (count % wide == 0) return;
  for (size_t lane = count % wide; lane < wide; ++lane) weaken(list.back(), lane);
}

}  // namespace

Model::Model(const FaceModel& face, lanes::InstructionSet instructions) : face_(&face), loops_(&loops_for(instructions)) {
  const Lattice& lattice = face.lattice();
  packed_.places = (16 * static_cast<size_t>(lattice.columns) + 4 * wide - 1) / (4 * wide) * (4 * wide);
  rest_ = Floats(packed_.places);
  balance_ = Floats(packed_.places);
  jaw_share_ = Floats(packed_.places / 4);
  for (size_t i = 0; i < face.rest().size(); ++i) {
    const auto at = static_cast<size_t>(slot_of(i));
    for (size_t axis = 0; axis < 3; ++axis) rest_.data()[at + axis] = lattice.rest[i][static_cast<int>(axis)];
    const auto kind = static_cast<NodeKind>(lattice.kinds[i]);
    const bool still = kind == NodeKind::fixed || kind == NodeKind::fixed_cranium;
    jaw_share_.data()[at / 4] = still ? 0.0F : lattice.jaw_weights[i];
  }
  packed_.rest = rest_.data();
  packed_.jaw_share = jaw_share_.data();
  packed_.crush_begin = f(crush_begin);
  packed_.crush_end = f(crush_end);
  packed_.turn_begin = f(turn_begin);
  packed_.turn_end = f(turn_end);
  packed_.segment_rounding = f(segment_rounding);
  packed_.fold_softness = f(fold_softness);
  for (const auto* list : {&lattice.fibre_channel, &lattice.carrier_channel, &lattice.pressure_channel})
    for (const uint32_t channel : *list) channels_ = std::max<size_t>(channels_, channel + 1);
  pack_triangles();
  pack_hinges();
  pack_springs();
  pack_held();
  pack_fibres();
  valid_ = make_factors();
  if (valid_) find_balance();
}

void Model::pack_triangles() {
  const auto& columns = face_->lattice().triangles;
  const size_t count = columns.size();
  triangles_.resize(batches(count));
  for (size_t i = 0; i < count; ++i) {
    TriangleBatch& batch = triangles_[i / wide];
    const size_t lane = i % wide;
    const auto set = [&](size_t l) {
      for (size_t k = 0; k < 3; ++k) batch.column[k][l] = static_cast<int32_t>(16 * columns[i][k]);
      for (size_t layer = 0; layer < 2; ++layer) {
        const Membrane& m = face_->membranes()[layer * count + i];
        batch.membrane[layer].a[l] = f(m.inverse_rest(0, 0));
        batch.membrane[layer].b[l] = f(m.inverse_rest(0, 1));
        batch.membrane[layer].c[l] = f(m.inverse_rest(1, 1));
        batch.membrane[layer].area_mu[l] = f(m.area * m.mu);
        batch.membrane[layer].area_lambda[l] = f(m.area * m.lambda);
        const Prism& p = face_->prisms()[layer * count + i];
        const double size = std::max(std::abs(p.volume), 1e-12);
        batch.prism[layer].volume[l] = f(p.volume);
        batch.prism[layer].inverse_volume[l] = f(1.0 / size);
        batch.prism[layer].stiffness[l] = f(p.stiffness);
        batch.prism[layer].guard[l] = p.volume > 0.0 ? f(turn_modulus) : 0.0F;
      }
    };
    set(lane);
    if (i + 1 == count)
      for (size_t l = lane + 1; l < wide; ++l) set(l);
  }
  fill_up(triangles_, count, [](TriangleBatch& batch, size_t lane) {
    for (size_t layer = 0; layer < 2; ++layer) {
      batch.membrane[layer].area_mu[lane] = batch.membrane[layer].area_lambda[lane] = 0.0F;
      batch.prism[layer].stiffness[lane] = batch.prism[layer].guard[lane] = 0.0F;
    }
  });
  packed_.triangles = triangles_.data();
  packed_.triangle_batches = triangles_.size();
}

void Model::pack_hinges() {
  const uint32_t columns = face_->lattice().columns;
  struct Pair {
    const Hinge* layer[2] = {nullptr, nullptr};
  };
  std::map<std::array<uint32_t, 4>, Pair> pairs;
  for (const Hinge& hinge : face_->hinges()) {
    std::array<uint32_t, 4> nodes = hinge.nodes;
    const uint32_t layer = nodes[0] / columns;
    for (uint32_t& node : nodes) node -= layer * columns;
    pairs[nodes].layer[layer] = &hinge;
  }
  hinges_.resize(batches(pairs.size()));
  size_t i = 0;
  for (const auto& [nodes, pair] : pairs) {
    const bool last = i + 1 == pairs.size();
    for (size_t lane = i % wide; lane < (last ? wide : i % wide + 1); ++lane) {
      HingeBatch& batch = hinges_[i / wide];
      const bool counts = lane == i % wide;
      for (size_t k = 0; k < 4; ++k) batch.column[k][lane] = static_cast<int32_t>(16 * nodes[k]);
      for (size_t layer = 0; layer < 2; ++layer) {
        const Hinge* h = pair.layer[layer];
        if (h == nullptr) continue;
        auto& to = batch.layer[layer];
        for (size_t k = 0; k < 3; ++k) to.weight[k][lane] = f(h->weights[k + 1]);
        to.stiffness[lane] = counts ? f(h->stiffness) : 0.0F;
        to.bend[lane] = f(h->bend);
        to.scale_a[lane] = f(h->scale_a);
        to.scale_b[lane] = f(h->scale_b);
      }
    }
    ++i;
  }
  packed_.hinges = hinges_.data();
  packed_.hinge_batches = hinges_.size();
}

void Model::pack_springs() {
  std::vector<Spring> springs;
  for (const Spring& s : face_->springs())
    if (!face_->prescribed(s.nodes[0]) || !face_->prescribed(s.nodes[1])) springs.push_back(s);
  std::stable_sort(springs.begin(), springs.end(), [this](const Spring& a, const Spring& b) { return slot_of(a.nodes[0]) < slot_of(b.nodes[0]); });
  const size_t count = springs.size();
  springs_.resize(batches(count));
  for (size_t i = 0; i < springs_.size() * wide; ++i) {
    const Spring& s = springs[std::min(i, count - 1)];
    SpringBatch& batch = springs_[i / wide];
    const size_t lane = i % wide;
    const bool counts = i < count;
    for (size_t k = 0; k < 2; ++k) batch.at[k][lane] = slot_of(s.nodes[k]);
    batch.length[lane] = f(s.length);
    batch.stiffness[lane] = counts ? f(s.stiffness) : 0.0F;
    batch.limit[lane] = f(s.limit);
    batch.extra[lane] = counts ? f(s.second_stiffness - s.stiffness) : 0.0F;
    batch.slack[lane] = s.one_sided ? 0.0F : never;
  }
  packed_.springs = springs_.data();
  packed_.spring_batches = springs_.size();
}

void Model::pack_held() {
  const Lattice& lattice = face_->lattice();
  const auto& tethers = face_->tethers();
  tethers_.resize(batches(tethers.size()));
  for (size_t i = 0; i < tethers_.size() * wide; ++i) {
    const Tether& t = tethers[std::min(i, tethers.size() - 1)];
    TetherBatch& batch = tethers_[i / wide];
    const size_t lane = i % wide;
    const bool counts = i < tethers.size();
    batch.at[lane] = slot_of(t.node);
    put(batch.normal, lane, t.normal);
    batch.tangential[lane] = counts ? f(t.tangential_stiffness) : 0.0F;
    batch.extra[lane] = counts ? f(t.normal_stiffness - t.tangential_stiffness) : 0.0F;
  }
  packed_.tethers = tethers_.data();
  packed_.tether_batches = tethers_.size();

  const size_t carriers = lattice.carrier_node.size();
  carriers_.resize(batches(carriers));
  for (size_t i = 0; i < carriers_.size() * wide; ++i) {
    const size_t from = std::min(i, carriers - 1), lane = i % wide;
    CarrierBatch& batch = carriers_[i / wide];
    const bool counts = i < carriers;
    Vec3 axis = lattice.carrier_axis[from].cast<double>();
    axis = axis.norm() > 1e-9 ? Vec3(axis.normalized()) : Vec3(Vec3::UnitX());
    batch.at[lane] = slot_of(lattice.carrier_node[from]);
    put(batch.origin, lane, lattice.carrier_origin[from].cast<double>());
    put(batch.axis, lane, axis);
    batch.angle[lane] = lattice.carrier_angle[from];
    batch.reverse[lane] = lattice.carrier_reverse[from];
    batch.stiffness[lane] = counts ? lattice.carrier_stiffness[from] : 0.0F;
    batch.drive[lane] = counts ? lattice.carrier_drive[from] : 0.0F;
    batch.channel[lane] = static_cast<int32_t>(lattice.carrier_channel[from]);
  }
  packed_.carriers = carriers_.data();
  packed_.carrier_batches = carriers_.size();

  const Contacts& contacts = face_->contacts();
  const size_t globes = contacts.globe_nodes().size();
  globes_.resize(batches(globes));
  for (size_t i = 0; i < globes_.size() * wide; ++i) {
    const size_t from = std::min(i, globes - 1), lane = i % wide;
    GlobeBatch& batch = globes_[i / wide];
    batch.at[lane] = slot_of(contacts.globe_nodes()[from]);
    put(batch.centre, lane, contacts.globe_centres()[from]);
    batch.radius[lane] = f(contacts.globe_radii()[from]);
    batch.stiffness[lane] = i < globes ? f(contacts.options().globe_stiffness) : 0.0F;
  }
  packed_.globes = globes_.data();
  packed_.globe_batches = globes_.size();

  const size_t pressures = lattice.pressure_prism.size();
  pressures_.resize(batches(pressures));
  for (size_t i = 0; i < pressures_.size() * wide; ++i) {
    const size_t from = std::min(i, pressures - 1), lane = i % wide;
    PressureBatch& batch = pressures_[i / wide];
    for (size_t k = 0; k < 3; ++k)
      batch.at[k][lane] = slot_of(lattice.columns + lattice.triangles[lattice.pressure_prism[from]][k]);
    batch.pressure[lane] = i < pressures ? lattice.pressure[from] : 0.0F;
    batch.channel[lane] = static_cast<int32_t>(lattice.pressure_channel[from]);
  }
  packed_.pressures = pressures_.data();
  packed_.pressure_batches = pressures_.size();
}

void Model::pack_fibres() {
  const Lattice& lattice = face_->lattice();
  std::vector<uint32_t> order;
  const auto points_of = [&](uint32_t fibre) { return lattice.fibre_offsets[fibre + 1] - lattice.fibre_offsets[fibre]; };
  for (uint32_t fibre = 0; fibre < lattice.fibre_count(); ++fibre)
    if (points_of(fibre) > 1 && face_->fibre_lengths()[fibre] > 0.0) order.push_back(fibre);
  // Of like length together, so that few lanes idle.
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return points_of(a) < points_of(b); });
  fibres_.resize(batches(order.size()));
  for (size_t b = 0; b < fibres_.size(); ++b) {
    FibreBatch& batch = fibres_[b];
    const size_t end = std::min((b + 1) * wide, order.size());
    batch.first = static_cast<uint32_t>(fibre_points_.size());
    batch.count = points_of(order[end - 1]);
    longest_fibre_ = std::max<size_t>(longest_fibre_, batch.count);
    fibre_points_.resize(fibre_points_.size() + batch.count);
    for (size_t lane = 0; lane < wide; ++lane) {
      const bool counts = b * wide + lane < end;
      const uint32_t fibre = order[std::min(b * wide + lane, end - 1)];
      batch.length[lane] = f(face_->fibre_lengths()[fibre]);
      batch.shortest[lane] = lattice.fibre_shortest[fibre];
      batch.strength[lane] = counts ? lattice.fibre_strength[fibre] : 0.0F;
      batch.channel[lane] = static_cast<int32_t>(lattice.fibre_channel[fibre]);
      const uint32_t first = lattice.fibre_offsets[fibre], last = lattice.fibre_offsets[fibre + 1] - 1;
      for (uint32_t p = 0; p < batch.count; ++p) {
        FibrePointBatch& point = fibre_points_[batch.first + p];
        const uint32_t from = std::min(first + p, last);
        const auto anchor = static_cast<FibreAnchor>(lattice.fibre_anchor[from]);
        const bool on_bone = anchor == FibreAnchor::cranium || anchor == FibreAnchor::mandible;
        Vec3 base = lattice.fibre_rest[from].cast<double>();
        for (size_t k = 0; k < 3; ++k) {
          const uint32_t node = lattice.fibre_nodes[from][k];
          const double weight = on_bone ? 0.0 : lattice.fibre_weights[from][static_cast<int>(k)];
          point.at[k][lane] = slot_of(node);
          point.weight[k][lane] = f(weight);
          base -= weight * face_->rest()[node];
        }
        put(point.base, lane, base);
        point.taper[lane] = first + p < last ? lattice.fibre_taper[first + p] : 0.0F;
        point.mandible[lane] = anchor == FibreAnchor::mandible ? 1.0F : 0.0F;
      }
    }
  }
  packed_.fibres = fibres_.data();
  packed_.fibre_points = fibre_points_.data();
  packed_.fibre_batches = fibres_.size();
}

/// What fibres that pull add to the stiffness of the rest pose: each segment is a string under tension. At a middling
/// activation; the factors need only be near.
Eigen::SparseMatrix<double, Eigen::RowMajor> Model::fibre_stiffness() const {
  constexpr double middling = 0.25;
  const Lattice& lattice = face_->lattice();
  std::vector<int32_t> unknown_of(face_->rest().size(), -1);
  for (size_t i = 0; i < face_->unknowns().size(); ++i) unknown_of[face_->unknowns()[i]] = static_cast<int32_t>(i);
  std::vector<Eigen::Triplet<double>> triplets;
  for (uint32_t fibre = 0; fibre < lattice.fibre_count(); ++fibre)
    for (uint32_t p = lattice.fibre_offsets[fibre]; p + 1 < lattice.fibre_offsets[fibre + 1]; ++p) {
      const double length = (lattice.fibre_rest[p + 1] - lattice.fibre_rest[p]).cast<double>().norm();
      const double stiffness = middling * lattice.fibre_strength[fibre] * lattice.fibre_taper[p] / std::max(length, 1e-3);
      std::vector<std::pair<int32_t, double>> ends;
      for (uint32_t end = 0; end < 2; ++end) {
        const auto anchor = static_cast<FibreAnchor>(lattice.fibre_anchor[p + end]);
        if (anchor == FibreAnchor::cranium || anchor == FibreAnchor::mandible) continue;
        for (size_t k = 0; k < 3; ++k) {
          const int32_t unknown = unknown_of[lattice.fibre_nodes[p + end][k]];
          if (unknown >= 0) ends.emplace_back(unknown, (end == 0 ? -1.0 : 1.0) * lattice.fibre_weights[p + end][static_cast<int>(k)]);
        }
      }
      for (const auto& [row, a] : ends)
        for (const auto& [column, b] : ends) triplets.emplace_back(row, column, stiffness * a * b);
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
  for (const uint32_t node : unknowns) places.push_back(face_->rest()[node]);
  const Dissection dissection(stiffness + fibre_stiffness(), places);
  Eigen::SparseMatrix<double, Eigen::RowMajor> pose = stiffness + fibre_stiffness();
  if (!pose_factor_.compute(dissection, pose)) return false;
  const double h = face_->options().substep;
  Eigen::SparseMatrix<double, Eigen::RowMajor> step = pose + (face_->options().stiffness_damping / h) * stiffness;
  for (size_t i = 0; i < unknowns.size(); ++i) {
    const auto k = static_cast<int>(i);
    step.coeffRef(k, k) += face_->masses()[unknowns[i]] * (1.0 / (h * h) + face_->options().mass_damping / h);
  }
  if (!step_factor_.compute(dissection, step)) return false;

  const auto& order = dissection.order();
  std::vector<uint32_t> position(order.size());
  for (uint32_t k = 0; k < order.size(); ++k) position[order[k]] = k;
  begin_.push_back(0);
  for (const uint32_t unknown : order) {
    slots_.push_back(slot_of(unknowns[unknown]));
    masses_.push_back(f(face_->masses()[unknowns[unknown]]));
    const auto k = static_cast<int>(unknown);
    pose_diagonal_.push_back(f(pose.coeff(k, k)));
    step_diagonal_.push_back(f(step.coeff(k, k)));
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(stiffness, static_cast<int>(unknown)); e; ++e) {
      column_.push_back(position[static_cast<size_t>(e.col())]);
      value_.push_back(f(e.value()));
    }
    begin_.push_back(static_cast<uint32_t>(column_.size()));
  }
  unknown_floats_ = (4 * (slots_.size() + 1) + 4 * wide - 1) / (4 * wide) * (4 * wide);
  return true;
}

void Model::find_balance() {
  const std::unique_ptr<Workspace> work = borrow();
  Driven at_rest = driven(*work);
  set_jaw({}, at_rest);
  loops_->place(packed_, at_rest);
  loops_->energy(packed_, at_rest, rest_.data(), balance_.data());
  for (size_t i = 3; i < balance_.size(); i += 4) balance_.data()[i] = 0.0F;  // what is stiffer stays so
  packed_.balance = balance_.data();
}

Driven Model::driven(Workspace& work) const {
  Driven d{};
  std::fill(work.values.begin(), work.values.end(), 0.0F);
  d.values = work.values.data();
  d.carried = work.carried.data();
  d.tether_normals = work.tether_normals.data();
  d.carrier_pulls = work.carrier_pulls.data();
  d.fibre_scratch = work.fibre_scratch.data();
  return d;
}

void Model::set_jaw(const JawPose& pose, Driven& d) const {
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
    for (int column = 0; column < 3; ++column) d.jaw_rotation[3 * row + column] = f(mandible.rotation(row, column));
  }
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
  for (Floats* list : {&work->carried, &work->start, &work->gradient}) *list = Floats(packed_.places);
  work->tether_normals = Floats(3 * wide * tethers_.size());
  work->carrier_pulls = Floats(3 * wide * carriers_.size());
  work->fibre_scratch = Floats(3 * wide * longest_fibre_);
  for (Floats* list : {&work->packed, &work->direction, &work->moved, &work->damped, &work->last_gradient, &work->begun, &work->ballistic, &work->answer})
    *list = Floats(unknown_floats_);
  for (auto* list : {&work->steps, &work->changes})
    for (size_t k = 0; k < Workspace::history; ++k) list->emplace_back(unknown_floats_);
  work->nodes.resize(face_->rest().size());
  work->nodes_before.resize(face_->rest().size());
  work->near_bones.reserve(face_->contacts().bone_nodes().size());
  work->values.resize(channels_);
  return work;
}

void Model::give_back(std::unique_ptr<Workspace> work) const {
  const std::lock_guard lock(mutex_);
  workspaces_.push_back(std::move(work));
}

}  // namespace fascia::sim::realtime
