#include <algorithm>
#include <cmath>
#include <map>

#include "sim/realtime/model.h"

// How a model's elements are laid in batches for the loops.

namespace fascia::sim::realtime {
namespace {

constexpr size_t wide = batch_width;
constexpr auto never = static_cast<float>(formulas::no_slack);

float f(double value) {
  return static_cast<float>(value);
}

void put(Sixteen* list, size_t lane, const Vec3& value) {
  for (size_t axis = 0; axis < 3; ++axis)
    list[axis][lane] = f(value[static_cast<int>(axis)]);
}

/// Calls `set(batch, lane, element, counts)` for every lane. Each lane takes a strip of neighbouring
/// elements, so that few places occur twice in one batch: adding to a place just written stalls on
/// store-to-load forwarding. Lanes left over repeat the last element, and are to have no stiffness (`counts`
/// false).
template <class Batch, class Set>
void lay_in_strips(std::vector<Batch>& list, size_t count, Set&& set) {
  const size_t rows = (count + wide - 1) / wide;
  list.resize(rows);
  for (size_t lane = 0; lane < wide; ++lane)
    for (size_t row = 0; row < rows; ++row) {
      const size_t i = lane * rows + row;
      set(list[row], lane, std::min(i, count - 1), i < count);
    }
}

void put_spring(SpringBatch& batch, size_t lane, const Spring& spring, bool counts) {
  batch.length[lane] = f(spring.length);
  batch.stiffness[lane] = counts ? f(spring.stiffness) : 0.0F;
  batch.limit[lane] = f(spring.limit);
  batch.extra[lane] = counts ? f(spring.second_stiffness - spring.stiffness) : 0.0F;
}

}  // namespace

void Model::pack_triangles() {
  const auto& columns = face_->lattice().triangles;
  lay_in_strips(triangles_, columns.size(), [&](TriangleBatch& batch, size_t lane, size_t i, bool counts) {
    for (size_t k = 0; k < 3; ++k)
      batch.column[k][lane] = static_cast<int32_t>(16 * columns[i][k]);
    for (size_t layer = 0; layer < 2; ++layer) {
      const Membrane& m = face_->membranes()[layer * columns.size() + i];
      MembraneBatch& membrane = batch.membrane[layer];
      membrane.a[lane] = f(m.inverse_rest(0, 0));
      membrane.b[lane] = f(m.inverse_rest(0, 1));
      membrane.c[lane] = f(m.inverse_rest(1, 1));
      membrane.area_mu[lane] = counts ? f(m.area * m.mu) : 0.0F;
      membrane.area_lambda[lane] = counts ? f(m.area * m.lambda) : 0.0F;
      const Prism& p = face_->prisms()[layer * columns.size() + i];
      PrismBatch& prism = batch.prism[layer];
      prism.volume[lane] = f(p.volume);
      prism.inverse_volume[lane] = f(1.0 / std::max(std::abs(p.volume), 1e-12));
      prism.stiffness[lane] = counts ? f(p.stiffness) : 0.0F;
      prism.guard[lane] = counts && p.volume > 0.0 ? f(formulas::turn_modulus) : 0.0F;
    }
  });
  packed_.triangles = triangles_.data();
  packed_.triangle_batches = triangles_.size();
}

/// Hinges of both layers on the same four columns together with the springs that cross the edge between the
/// first two.
void Model::pack_edges() {
  const uint32_t columns = face_->lattice().columns;
  struct Edge {
    std::array<uint32_t, 4> columns;
    const Hinge* hinge[2] = {nullptr, nullptr};
    const Spring* spring[edge_springs] = {nullptr, nullptr, nullptr, nullptr};
  };
  std::vector<Edge> edges;
  std::map<std::array<uint32_t, 4>, size_t> by_hinge;
  std::map<std::array<uint32_t, 2>, size_t> by_ends;
  for (const Hinge& hinge : face_->hinges()) {
    std::array<uint32_t, 4> nodes = hinge.nodes;
    const uint32_t layer = nodes[0] / columns;
    for (uint32_t& node : nodes)
      node -= layer * columns;
    const auto [at, is_new] = by_hinge.try_emplace(nodes, edges.size());
    if (is_new) edges.push_back({nodes});
    edges[at->second].hinge[layer] = &hinge;
    by_ends.try_emplace({nodes[0], nodes[1]}, at->second);
  }
  std::vector<const Spring*> others;
  for (const Spring& spring : face_->springs()) {
    if (face_->prescribed(spring.nodes[0]) && face_->prescribed(spring.nodes[1])) continue;
    const std::array<uint32_t, 2> ends{spring.nodes[0] % columns, spring.nodes[1] % columns};
    std::array<uint32_t, 2> layers{spring.nodes[0] / columns, spring.nodes[1] / columns};
    auto at = by_ends.find(ends);
    if (at == by_ends.end()) {
      at = by_ends.find({ends[1], ends[0]});
      std::swap(layers[0], layers[1]);
    }
    const Spring** slot = nullptr;
    for (size_t k = 0; k < edge_springs && at != by_ends.end() && !spring.one_sided; ++k)
      if (layers[0] == edge_spring_layers[k][0] && layers[1] == edge_spring_layers[k][1])
        slot = &edges[at->second].spring[k];
    if (slot != nullptr && *slot == nullptr)
      *slot = &spring;
    else
      others.push_back(&spring);
  }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& a, const Edge& b) { return a.columns < b.columns; });
  lay_in_strips(edges_, edges.size(), [&](EdgeBatch& batch, size_t lane, size_t i, bool counts) {
    const Edge& edge = edges[i];
    for (size_t k = 0; k < 4; ++k)
      batch.column[k][lane] = static_cast<int32_t>(16 * edge.columns[k]);
    for (size_t layer = 0; layer < 2; ++layer) {
      const Hinge* h = edge.hinge[layer];
      if (h == nullptr) continue;
      HingeBatch& hinge = batch.hinge[layer];
      for (size_t k = 0; k < 3; ++k)
        hinge.weight[k][lane] = f(h->weights[k + 1]);
      hinge.stiffness[lane] = counts ? f(h->stiffness) : 0.0F;
      hinge.bend[lane] = f(h->bend);
      hinge.scale_a[lane] = f(h->scale_a);
      hinge.scale_b[lane] = f(h->scale_b);
    }
    for (size_t k = 0; k < edge_springs; ++k)
      if (edge.spring[k] != nullptr) put_spring(batch.spring[k], lane, *edge.spring[k], counts);
  });
  packed_.edges = edges_.data();
  packed_.edge_batches = edges_.size();

  std::stable_sort(others.begin(), others.end(), [this](const Spring* a, const Spring* b) {
    return slot_of(a->nodes[0]) < slot_of(b->nodes[0]);
  });
  lay_in_strips(springs_, others.size(), [&](LooseSpringBatch& batch, size_t lane, size_t i, bool counts) {
    for (size_t k = 0; k < 2; ++k)
      batch.at[k][lane] = slot_of(others[i]->nodes[k]);
    put_spring(batch.spring, lane, *others[i], counts);
    batch.slack[lane] = others[i]->one_sided ? 0.0F : never;
  });
  packed_.springs = springs_.data();
  packed_.spring_batches = springs_.size();
}

void Model::pack_held() {
  const Lattice& lattice = face_->lattice();
  const auto& tethers = face_->tethers();
  lay_in_strips(tethers_, tethers.size(), [&](TetherBatch& batch, size_t lane, size_t i, bool counts) {
    const Tether& t = tethers[i];
    batch.at[lane] = slot_of(t.node);
    put(batch.normal, lane, t.normal);
    batch.tangential[lane] = counts ? f(t.tangential_stiffness) : 0.0F;
    batch.extra[lane] = counts ? f(t.normal_stiffness - t.tangential_stiffness) : 0.0F;
  });
  packed_.tethers = tethers_.data();
  packed_.tether_batches = tethers_.size();

  lay_in_strips(carriers_, lattice.carrier_node.size(),
                [&](CarrierBatch& batch, size_t lane, size_t from, bool counts) {
                  Vec3 axis = lattice.carrier_axis[from].cast<double>();
                  axis = axis.norm() > 1e-9 ? Vec3(axis.normalized()) : Vec3(Vec3::UnitX());
                  batch.at[lane] = slot_of(lattice.carrier_node[from]);
                  put(batch.origin, lane, lattice.carrier_origin[from].cast<double>());
                  put(batch.axis, lane, axis);
                  batch.angle[lane] = lattice.carrier_angle[from];
                  batch.reverse[lane] = lattice.carrier_reverse[from];
                  batch.stiffness[lane] = counts ? lattice.carrier_stiffness[from] : 0.0F;
                  batch.pull_stiffness[lane] = counts ? lattice.carrier_drive[from] : 0.0F;
                  batch.channel[lane] = static_cast<int32_t>(lattice.carrier_channel[from]);
                });
  packed_.carriers = carriers_.data();
  packed_.carrier_batches = carriers_.size();

  const Contacts& contacts = face_->contacts();
  lay_in_strips(globes_, contacts.globe_nodes().size(),
                [&](GlobeBatch& batch, size_t lane, size_t from, bool counts) {
                  batch.at[lane] = slot_of(contacts.globe_nodes()[from]);
                  put(batch.centre, lane, contacts.globe_centres()[from]);
                  batch.radius[lane] = f(contacts.globe_radii()[from]);
                  batch.stiffness[lane] = counts ? f(contacts.options().globe_stiffness) : 0.0F;
                });
  packed_.globes = globes_.data();
  packed_.globe_batches = globes_.size();

  lay_in_strips(pressures_, lattice.pressure_prism.size(),
                [&](PressureBatch& batch, size_t lane, size_t from, bool counts) {
                  for (size_t k = 0; k < 3; ++k)
                    batch.at[k][lane] =
                        slot_of(lattice.columns + lattice.triangles[lattice.pressure_prism[from]][k]);
                  batch.pressure[lane] = counts ? lattice.pressure[from] : 0.0F;
                  batch.channel[lane] = static_cast<int32_t>(lattice.pressure_channel[from]);
                });
  packed_.pressures = pressures_.data();
  packed_.pressure_batches = pressures_.size();
}

void Model::pack_fibres() {
  const Lattice& lattice = face_->lattice();
  std::vector<uint32_t> order;
  const auto points_of = [&](uint32_t fibre) {
    return lattice.fibre_offsets[fibre + 1] - lattice.fibre_offsets[fibre];
  };
  for (uint32_t fibre = 0; fibre < lattice.fibre_count(); ++fibre)
    if (points_of(fibre) > 1 && face_->fibre_lengths()[fibre] > 0.0) order.push_back(fibre);
  // Grouped by muscle, so that inactive ones are skipped, then by length, to fill lanes.
  std::map<uint32_t, uint32_t> longest;
  for (const uint32_t fibre : order)
    longest[lattice.fibre_channel[fibre]] = std::max(longest[lattice.fibre_channel[fibre]], points_of(fibre));
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const uint32_t channel_a = lattice.fibre_channel[a], channel_b = lattice.fibre_channel[b];
    return std::make_pair(longest[channel_a], channel_a) < std::make_pair(longest[channel_b], channel_b);
  });
  fibres_.resize((order.size() + wide - 1) / wide);
  for (size_t b = 0; b < fibres_.size(); ++b) {
    FibreBatch& batch = fibres_[b];
    const size_t end = std::min((b + 1) * wide, order.size());
    batch.first = static_cast<uint32_t>(fibre_points_.size());
    for (size_t i = b * wide; i < end; ++i)
      batch.count = std::max(batch.count, points_of(order[i]));
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
  packed_.initial_force_slope = face_->options().initial_force_slope;
}

}  // namespace fascia::sim::realtime
