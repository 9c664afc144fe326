#include <Eigen/Geometry>
#include <algorithm>

#include "sim/face_model.h"

// The face's energies once more, for Newton steps: what each element adds to the Hessian.
namespace fascia::sim {

void FaceModel::add_fibre_curvature(const Frame& frame, uint32_t f, const Vec3* x, Curvature& out) const {
  const double pull = frame.fibre_pulls[f], rest_length = fibre_lengths_[f];
  if (pull == 0.0 || rest_length <= 0.0) return;
  const uint32_t first = lattice_.fibre_offsets[f], last = lattice_.fibre_offsets[f + 1];
  double length = 0.0, energy = 0.0;
  for (uint32_t p = first; p + 1 < last; ++p)
    length += lattice_.fibre_taper[p] *
              formulas::segment_length(three(fibre_point(frame, p + 1, x) - fibre_point(frame, p, x)));
  const double shortest = lattice_.fibre_shortest[f],
               tension = formulas::fibre_tension(pull, length, rest_length, shortest, energy);
  if (tension == 0.0) return;
  const Curvature::Pull whole{out.pull_nodes.size(), 6 * static_cast<size_t>(last - first - 1),
                              pull / ((1.0 - shortest) * rest_length)};
  for (uint32_t p = first; p + 1 < last; ++p) {
    const Vec3 along = fibre_point(frame, p + 1, x) - fibre_point(frame, p, x);
    const double segment = formulas::segment_length(three(along)), taper = lattice_.fibre_taper[p];
    const Vec3 unit = along / segment;
    Curvature::Stencil<6> stencil{
        {}, {}, (tension * taper / segment) * (Mat3::Identity() - unit * unit.transpose())};
    for (size_t k = 0; k < 6; ++k) {
      const uint32_t end = k < 3 ? p : p + 1;
      const auto anchor = static_cast<FibreAnchor>(lattice_.fibre_anchor[end]);
      const bool is_held = anchor == FibreAnchor::cranium || anchor == FibreAnchor::mandible;
      const double weight =
          is_held ? 0.0 : static_cast<double>(lattice_.fibre_weights[end][static_cast<int>(k % 3)]);
      stencil.nodes[k] = lattice_.fibre_nodes[end][k % 3];
      stencil.weights[k] = k < 3 ? -weight : weight;
      out.pull_nodes.push_back(stencil.nodes[k]);
      out.pull_slopes.push_back(stencil.weights[k] * taper * unit);
    }
    out.sixes.push_back(stencil);
  }
  out.pulls.push_back(whole);
}

void FaceModel::find_curvature(const Frame& frame, const Vec3* x, Curvature& out) const {
  out.clear();
  for (const Spring& spring : springs_)
    add_spring(spring, x, out);
  for (const Membrane& membrane : membranes_)
    add_membrane(membrane, x, out);
  for (const Hinge& hinge : hinges_)
    add_hinge(hinge, x, out);
  for (const Prism& prism : prisms_)
    add_prism(prism, x, out);
  for (size_t t = 0; t < tethers_.size(); ++t)
    add_tether(tethers_[t], frame.tether_normals[t], out);
  for (uint32_t f = 0; f < lattice_.fibre_count(); ++f)
    add_fibre_curvature(frame, f, x, out);
  for (size_t c = 0; c < frame.carrier_pulls.size(); ++c)
    if (lattice_.carrier_stiffness[c] > 0.0F)
      out.points.push_back({{lattice_.carrier_node[c]},
                            {1.0},
                            static_cast<double>(lattice_.carrier_stiffness[c]) * Mat3::Identity()});
  contacts_.add_curvature(frame.mandible, frame.facing, std::span(frame.grips).first(frame.grip_count), x,
                          out);
}

}  // namespace fascia::sim
