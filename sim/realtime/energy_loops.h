#pragma once

// The energies of a face and their gradients: the formulas of sim/formulas on batches of sixteen elements;
// see sim/realtime/loops.h.

#include "sim/formulas/activation_force.h"
#include "sim/formulas/elements.h"
#include "sim/lanes/lanes.h"
#include "sim/realtime/loops_common.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

FASCIA_INLINE formulas::MembraneRest<Lanes> load_rest(const MembraneBatch& m) {
  return {load(m.a), load(m.b), load(m.c), load(m.area_mu), load(m.area_lambda)};
}
FASCIA_INLINE formulas::PrismRest<Lanes> load_rest(const PrismBatch& m) {
  return {load(m.volume), load(m.inverse_volume), load(m.stiffness), load(m.guard)};
}
FASCIA_INLINE formulas::HingeRest<Lanes> load_rest(const HingeBatch& h) {
  return {load(h.weight[0]), load(h.weight[1]), load(h.weight[2]), load(h.stiffness),
          load(h.bend),      load(h.scale_a),   load(h.scale_b)};
}
FASCIA_INLINE formulas::SpringRest<Lanes> load_rest(const SpringBatch& s) {
  return {load(s.length), load(s.stiffness), load(s.limit), load(s.extra)};
}

void volume_ratios(const Packed& packed, size_t b, const float* x, float* shares) {
  const TriangleBatch& batch = packed.triangles[b];
  Lanes3 place[3][3], by_outer[3], by_inner[3];
  for (size_t layer = 0; layer < 3; ++layer)
    for (size_t k = 0; k < 3; ++k)
      place[layer][k] = gather(x + 4 * layer, batch.column[k]);
  for (size_t layer = 0; layer < 2; ++layer)
    store(shares + batch_width * layer,
          formulas::prism_volume<true>(place[layer], place[layer + 1], by_outer, by_inner) *
              load(batch.prism[layer].inverse_volume));
}

template <bool is_wanted>
Lanes triangle_energy(const Packed& packed, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.triangle_batches; ++b) {
    const TriangleBatch& batch = packed.triangles[b];
    Lanes3 place[3][3], force[3][3];
    Lanes stiffer[3][3];
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < 3; ++k) {
        place[layer][k] = gather(x + 4 * layer, batch.column[k]);
        force[layer][k] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
        stiffer[layer][k] = splat(0.0F);
      }
    for (size_t layer = 0; layer < 2; ++layer) {
      formulas::membrane(load_rest(batch.membrane[layer]), place[layer], force[layer], stiffer[layer],
                         energy);
      formulas::prism(load_rest(batch.prism[layer]), place[layer], place[layer + 1], force[layer],
                      force[layer + 1], stiffer[layer], stiffer[layer + 1], energy);
    }
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < 3; ++k)
        scatter_add(gradient + 4 * layer, batch.column[k], force[layer][k], stiffer[layer][k]);
  }
  return is_wanted ? energy : splat(0.0F);
}

template <bool is_wanted>
Lanes edge_energy(const Packed& packed, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.edge_batches; ++b) {
    const EdgeBatch& batch = packed.edges[b];
    Lanes3 place[3][4], force[3][4];
    Lanes stiffer[3][2];
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < (layer < 2 ? 4 : 2); ++k) {
        place[layer][k] = gather(x + 4 * layer, batch.column[k]);
        if (layer == 2) force[layer][k] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
        if (k < 2) stiffer[layer][k] = splat(0.0F);
      }
    for (size_t layer = 0; layer < 2; ++layer)
      formulas::hinge(load_rest(batch.hinge[layer]), place[layer], force[layer], energy);
    for (size_t k = 0; k < edge_springs; ++k) {
      const size_t first = edge_spring_layers[k][0], second = edge_spring_layers[k][1];
      Lanes more;
      const Lanes3 pull =
          formulas::spring(load_rest(batch.spring[k]), splat(static_cast<float>(formulas::no_slack)),
                           place[second][1] - place[first][0], more, energy);
      force[first][0] -= pull;
      force[second][1] += pull;
      stiffer[first][0] += more;
      stiffer[second][1] += more;
    }
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < (layer < 2 ? 4 : 2); ++k)
        scatter_add(gradient + 4 * layer, batch.column[k], force[layer][k],
                    k < 2 ? stiffer[layer][k] : splat(0.0F));
  }
  return is_wanted ? energy : splat(0.0F);
}

template <bool is_wanted>
Lanes spring_energy(const Packed& packed, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.spring_batches; ++b) {
    const LooseSpringBatch& s = packed.springs[b];
    Lanes stiffer;
    const Lanes3 pull = formulas::spring(load_rest(s.spring), load(s.slack),
                                         gather(x, s.at[1]) - gather(x, s.at[0]), stiffer, energy);
    scatter_add(gradient, s.at[0], splat(-1.0F) * pull, stiffer);
    scatter_add(gradient, s.at[1], pull, stiffer);
  }
  return is_wanted ? energy : splat(0.0F);
}

template <bool is_wanted>
Lanes held_energy(const Packed& packed, const Boundary& boundary, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.tether_batches; ++b) {
    const TetherBatch& t = packed.tethers[b];
    const float* n = boundary.tether_normals + 3 * batch_width * b;
    const Lanes3 normal{load(n), load(n + batch_width), load(n + 2 * batch_width)};
    const Lanes3 away = gather(x, t.at) - gather(boundary.carried, t.at);
    scatter_add(gradient, t.at, formulas::tether(load(t.tangential), load(t.extra), normal, away, energy));
  }
  for (size_t b = 0; b < packed.carrier_batches; ++b) {
    const CarrierBatch& c = packed.carriers[b];
    const float* p = boundary.carrier_pulls + 3 * batch_width * b;
    const Lanes3 pull{load(p), load(p + batch_width), load(p + 2 * batch_width)};
    const Lanes3 away = gather(x, c.at) - gather(boundary.carried, c.at);
    scatter_add(gradient, c.at, formulas::held_and_pulled(load(c.stiffness), pull, away, energy));
  }
  for (size_t b = 0; b < packed.globe_batches; ++b) {
    const GlobeBatch& g = packed.globes[b];
    const Lanes3 away = gather(x, g.at) - load3(g.centre);
    Lanes distance;
    const Lanes depth = formulas::depth_in_ball(load(g.radius), away, distance);
    const Lanes push = load(g.stiffness) * depth;
    if (!any_below(splat(0.0F), depth)) continue;
    scatter_add(gradient, g.at, (-(push / distance)) * away,
                where_below(splat(0.0F), depth, load(g.stiffness), splat(0.0F)));
    energy += 0.5F * push * depth;
  }
  return is_wanted ? energy : splat(0.0F);
}

template <bool is_wanted>
Lanes pressure_energy(const Packed& packed, const Boundary& boundary, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.pressure_batches; ++b) {
    const PressureBatch& batch = packed.pressures[b];
    const Lanes pressure = load(batch.pressure) * channel_values(boundary.values, batch.channel);
    if (!any_below(splat(0.0F), pressure) && !any_below(pressure, splat(0.0F))) continue;
    Lanes3 place[3], carried[3], push[3];
    for (size_t k = 0; k < 3; ++k) {
      place[k] = gather(x, batch.at[k]);
      carried[k] = gather(boundary.carried, batch.at[k]);
    }
    energy -= pressure * formulas::prism_volume<false>(place, carried, push, static_cast<Lanes3*>(nullptr));
    const Lanes share = -(pressure * (1.0F / 6.0F));
    for (size_t k = 0; k < 3; ++k)
      scatter_add(gradient, batch.at[k], share * push[k]);
  }
  return is_wanted ? energy : splat(0.0F);
}

/// Positions of the points of sixteen fibres.
FASCIA_INLINE Lanes3 fibre_point(const FibrePointBatch& p, const Boundary& boundary, const float* x) {
  Lanes3 place = load3(p.base);
  if (!boundary.jaw_at_rest) {
    const float* r = boundary.jaw_rotation;
    const Lanes goes = load(p.mandible);
    const Lanes3 moved{r[0] * place.x + r[1] * place.y + r[2] * place.z + boundary.jaw_translation[0],
                       r[3] * place.x + r[4] * place.y + r[5] * place.z + boundary.jaw_translation[1],
                       r[6] * place.x + r[7] * place.y + r[8] * place.z + boundary.jaw_translation[2]};
    place += goes * (moved - place);
  }
  for (size_t k = 0; k < 3; ++k)
    place += load(p.weight[k]) * gather(x, p.at[k]);
  return place;
}

template <bool is_wanted>
Lanes fibre_energy(const Packed& packed, const Boundary& boundary, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.fibre_batches; ++b) {
    const FibreBatch& f = packed.fibres[b];
    const Lanes activation = positive(channel_values(boundary.values, f.channel));
    const Lanes pull = formulas::activation_force(activation, packed.initial_force_slope) * load(f.strength);
    if (!any_below(splat(0.0F), pull)) continue;
    const FibrePointBatch* points = packed.fibre_points + f.first;
    // First the positions and lengths; the direction of each segment is kept.
    Lanes length = splat(0.0F);
    Lanes3 last = fibre_point(points[0], boundary, x);
    for (uint32_t p = 0; p + 1 < f.count; ++p) {
      const Lanes3 next = fibre_point(points[p + 1], boundary, x), along = next - last;
      const Lanes segment = formulas::segment_length(along), taper = load(points[p].taper);
      length += taper * segment;
      float* kept = boundary.fibre_scratch + 3 * batch_width * p;
      const Lanes3 way = (taper / segment) * along;
      store(kept, way.x);
      store(kept + batch_width, way.y);
      store(kept + 2 * batch_width, way.z);
      last = next;
    }
    const Lanes tension = formulas::fibre_tension(pull, length, load(f.length), load(f.shortest), energy);
    Lanes3 before{splat(0.0F), splat(0.0F), splat(0.0F)};
    for (uint32_t p = 0; p < f.count; ++p) {
      Lanes3 after{splat(0.0F), splat(0.0F), splat(0.0F)};
      if (p + 1 < f.count) {
        const float* kept = boundary.fibre_scratch + 3 * batch_width * p;
        after = tension * Lanes3{load(kept), load(kept + batch_width), load(kept + 2 * batch_width)};
      }
      const Lanes3 force = before - after;
      for (size_t k = 0; k < 3; ++k)
        scatter_add(gradient, points[p].at[k], load(points[p].weight[k]) * force);
      before = after;
    }
  }
  return is_wanted ? energy : splat(0.0F);
}

/// If `is_wanted` is false the energy is not summed, and 0 is returned; the gradient is bit-identical.
template <bool is_wanted>
double total_energy(const Packed& packed, const Boundary& boundary, const float* x, float* gradient) {
  for (size_t i = 0; i < packed.places; i += 16)
    store(gradient + i, splat(0.0F));
  double energy = static_cast<double>(total(triangle_energy<is_wanted>(packed, x, gradient)));
  energy += static_cast<double>(total(edge_energy<is_wanted>(packed, x, gradient)));
  energy += static_cast<double>(total(spring_energy<is_wanted>(packed, x, gradient)));
  energy += static_cast<double>(total(held_energy<is_wanted>(packed, boundary, x, gradient)));
  energy += static_cast<double>(total(pressure_energy<is_wanted>(packed, boundary, x, gradient)));
  energy += static_cast<double>(total(fibre_energy<is_wanted>(packed, boundary, x, gradient)));
  if (packed.balance == nullptr) return energy;
  Lanes work = splat(0.0F);
  for (size_t i = 0; i < packed.places; i += 16) {
    const Lanes balance = load(packed.balance + i);
    store(gradient + i, load(gradient + i) - balance);
    work += balance * (load(x + i) - load(packed.rest + i));
  }
  return is_wanted ? energy - static_cast<double>(total(work)) : 0.0;
}

}  // namespace
}  // namespace fascia::sim::realtime
