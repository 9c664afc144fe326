#include "sim/face_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "sim/formulas/elements.h"
#include "sim/rest_stiffness.h"

namespace fascia::sim {
namespace {

bool moves_with_bone(uint8_t kind) {
  const auto k = static_cast<NodeKind>(kind);
  return k == NodeKind::fixed || k == NodeKind::fixed_cranium || k == NodeKind::fixed_mandible;
}

}  // namespace

FaceModel::FaceModel(const Lattice& lattice, const Jaw& jaw, const FaceModelOptions& options)
    : lattice_(lattice), jaw_(jaw), options_(options) {
  const char* fault = lattice_fault(lattice);
  if (fault == nullptr) fault = jaw_fault(jaw);
  if (fault != nullptr) {
    fault_ = fault;
    return;
  }
  make_elements();
  make_hinges();
  const Frame frame = make_frame();
  Positions gradient(rest_.size());
  raw_energy(frame, rest_.data(), gradient.data());
  balance_ = gradient;
  if (!std::all_of(balance_.begin(), balance_.end(), [](const Vec3& force) { return force.allFinite(); })) {
    fault_ = "an element pulls at rest with a force that is not finite";
    return;
  }
  assemble_stiffness();
}

void FaceModel::make_elements() {
  const uint32_t nodes = lattice_.node_count(), columns = lattice_.columns;
  rest_.resize(nodes);
  masses_.resize(nodes);
  unknown_of_node_.assign(nodes, -1);
  for (uint32_t i = 0; i < nodes; ++i) {
    rest_[i] = lattice_.rest[i].cast<double>();
    masses_[i] = lattice_.masses[i];
    if (moves_with_bone(lattice_.kinds[i])) continue;
    unknown_of_node_[i] = static_cast<int32_t>(unknowns_.size());
    unknowns_.push_back(i);
  }
  for (size_t s = 0; s < lattice_.spring_nodes.size(); ++s) {
    const auto& pair = lattice_.spring_nodes[s];
    const double length = (rest_[pair[1]] - rest_[pair[0]]).norm();
    springs_.push_back({pair, length, lattice_.spring_stiffness[s], lattice_.spring_limit_strain[s] * length,
                        lattice_.spring_second_stiffness[s], lattice_.spring_one_sided[s] != 0});
  }
  for (uint32_t layer = 0; layer < 2; ++layer) {
    const auto& moduli = layer == 0 ? lattice_.skin_membrane : lattice_.smas_membrane;
    for (size_t t = 0; t < lattice_.triangles.size(); ++t) {
      std::array<uint32_t, 3> corners = lattice_.triangles[t];
      for (uint32_t& corner : corners)
        corner += layer * columns;
      membranes_.push_back(make_membrane(corners, moduli[t], lattice_.poisson_ratio, rest_.data()));
    }
    for (size_t t = 0; t < lattice_.triangles.size(); ++t) {
      const auto& corners = lattice_.triangles[t];
      std::array<uint32_t, 6> prism{};
      for (size_t k = 0; k < 3; ++k) {
        prism[k] = corners[k] + layer * columns;
        prism[k + 3] = corners[k] + (layer + 1) * columns;
      }
      const auto& stiffness = layer == 0 ? lattice_.volume_stiffness : lattice_.inner_volume_stiffness;
      prisms_.push_back(make_prism(prism, stiffness[t], rest_.data()));
    }
  }
  for (size_t t = 0; t < lattice_.tether_nodes.size(); ++t) {
    Vec3 normal = lattice_.tether_normals[t].cast<double>();
    normal = normal.norm() > 1e-9 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
    tethers_.push_back({lattice_.tether_nodes[t], normal, lattice_.tether_normal_stiffness[t],
                        lattice_.tether_tangential_stiffness[t]});
  }
  column_areas_.assign(columns, 0.0);
  for (size_t t = 0; t < lattice_.triangles.size(); ++t)
    for (const uint32_t column : lattice_.triangles[t])
      column_areas_[column] += membranes_[t].area;
  contacts_ = Contacts(lattice_, rest_, options_.contact);
  Frame frame;
  frame.fibre_anchors.resize(lattice_.fibre_nodes.size());
  for (size_t p = 0; p < frame.fibre_anchors.size(); ++p)
    frame.fibre_anchors[p] = lattice_.fibre_rest[p].cast<double>();
  for (uint32_t f = 0; f < lattice_.fibre_count(); ++f) {
    double length = 0.0;
    for (uint32_t p = lattice_.fibre_offsets[f]; p + 1 < lattice_.fibre_offsets[f + 1]; ++p)
      length += lattice_.fibre_taper[p] *
                formulas::segment_length(
                    three(fibre_point(frame, p + 1, rest_.data()) - fibre_point(frame, p, rest_.data())));
    fibre_lengths_.push_back(length);
  }
}

/// Whether a hinge's triangles lie on each other to within 6 degrees: it has no mean normal that says where
/// it bends to, and what it pulled with at rest would throw it open at the least disturbance.
static bool is_folded_shut(const std::array<uint32_t, 4>& n, const Positions& rest) {
  const Vec3 edge = rest[n[1]] - rest[n[0]];
  const Vec3 a = edge.cross(rest[n[2]] - rest[n[0]]), b = (rest[n[3]] - rest[n[0]]).cross(edge);
  return (a.stableNormalized() + b.stableNormalized()).squaredNorm() < formulas::fold_softness;
}

void FaceModel::make_hinges() {
  // Opposite corner and first triangle's direction of every edge; the second triangle closes the hinge.
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> opposite;
  for (const auto& t : lattice_.triangles)
    for (size_t e = 0; e < 3; ++e)
      opposite[{t[e], t[(e + 1) % 3]}] = t[(e + 2) % 3];
  for (uint32_t layer = 0; layer < 2; ++layer) {
    const auto& rigidity = layer == 0 ? lattice_.skin_bending : lattice_.smas_bending;
    const uint32_t first = layer * lattice_.columns;
    for (const auto& [edge, corner] : opposite) {
      const auto [a, b] = edge;
      const auto other = opposite.find({b, a});
      if (a > b || other == opposite.end()) continue;
      const double mean = 0.5 * (static_cast<double>(rigidity[a]) + rigidity[b]);
      if (mean == 0.0) continue;
      const std::array<uint32_t, 4> nodes = {first + a, first + b, first + corner, first + other->second};
      if (!is_folded_shut(nodes, rest_)) hinges_.push_back(make_hinge(nodes, mean, rest_.data()));
    }
  }
}

Frame FaceModel::make_frame() const {
  Frame frame;
  frame.carried.resize(rest_.size());
  frame.tether_normals.resize(tethers_.size());
  frame.carrier_pulls.resize(lattice_.carrier_node.size());
  frame.fibre_anchors.resize(lattice_.fibre_nodes.size());
  frame.fibre_pulls.resize(lattice_.fibre_count());
  frame.pressures.resize(lattice_.pressure_prism.size());
  frame.facing.resize(contacts_.facing_count());
  frame.facing_search = contacts_.make_search();
  frame.grips.resize(contacts_.grip_capacity());
  place({}, frame);
  return frame;
}

void FaceModel::assemble_stiffness() {
  RestTerms terms{springs_, membranes_, hinges_,          prisms_,
                  tethers_, rest_,      unknown_of_node_, unknowns_.size()};
  Eigen::SparseMatrix<double> matrix = assemble_rest_stiffness(terms);
  for (size_t c = 0; c < lattice_.carrier_node.size(); ++c) {
    const int32_t unknown = unknown_of_node_[lattice_.carrier_node[c]];
    if (unknown >= 0) matrix.coeffRef(unknown, unknown) += lattice_.carrier_stiffness[c];
  }
  for (const uint32_t node : contacts_.globe_nodes()) {
    const int32_t unknown = unknown_of_node_[node];
    if (unknown >= 0) matrix.coeffRef(unknown, unknown) += 0.1 * options_.contact.globe_stiffness;
  }
  stiffness_ = matrix;
}

const RestFactor& FaceModel::pose_factor() const {
  std::call_once(pose_once_, [this] { pose_factor_.compute(stiffness_); });
  return pose_factor_;
}

const RestFactor& FaceModel::step_factor() const {
  std::call_once(step_once_, [this] {
    const double h = options_.substep;
    Eigen::SparseMatrix<double> step = (1.0 + options_.stiffness_damping / h) * stiffness_;
    for (size_t i = 0; i < unknowns_.size(); ++i) {
      const auto k = static_cast<int>(i);
      step.coeffRef(k, k) += masses_[unknowns_[i]] * (1.0 / (h * h) + options_.mass_damping / h);
    }
    step_factor_.compute(step);  // as the pose's is positive definite, so is this
  });
  return step_factor_;
}

}  // namespace fascia::sim
