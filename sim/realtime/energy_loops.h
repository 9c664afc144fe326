#pragma once

// The energies of a face and their gradients. They are those of sim/energies.h and sim/face_energy.cpp, where
// they are written to be read; see sim/realtime/loops.h.

#include "sim/lanes/lanes.h"
#include "sim/realtime/loops_common.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

/// Bounds an element's curvature by that of its corners alone: neighbours pull along.
constexpr float corner_bound = 2.0F;

/// What resists as a share of the rest falls below where it begins, with both derivatives by the share.
struct Wall {
  Lanes value, slope, bend;
};
/// (begin / ratio - 1)^2; from `end` on its parabola, so that a step gone too far has a way back.
FASCIA_INLINE Wall wall_at(float wall_begin, float wall_end, const Lanes& ratio) {
  const Lanes begin = splat(wall_begin), r = greater(ratio, wall_end), inverse = 1.0F / r, none = splat(0.0F);
  const Lanes share = begin * inverse, lack = positive(share - 1.0F), below = ratio - r;
  const Lanes slope = -2.0F * lack * share * inverse;
  const Lanes bend =
      where_below(ratio, begin, 2.0F * share * (3.0F * share - 2.0F) * (inverse * inverse), none);
  return {where_below(ratio, begin, lack * lack + slope * below + 0.5F * bend * below * below, none),
          where_below(ratio, begin, slope + bend * below, none), bend};
}

FASCIA_INLINE void membrane(const MembraneBatch& m, const Packed& packed, const Lanes3* x, Lanes3* gradient,
                            Lanes* stiffer, Lanes& energy) {
  const Lanes a = load(m.a), b = load(m.b), c = load(m.c), mu = load(m.area_mu), lambda = load(m.area_lambda);
  const Lanes3 first = x[1] - x[0], second = x[2] - x[0];
  const Lanes3 f0 = a * first, f1 = b * first + c * second;
  Lanes3 normal = cross(f0, f1);
  const Lanes ratio = square_root(dot(normal, normal));
  normal = (1.0F / greater(ratio, 1e-14F)) * normal;
  const Lanes trace = greater(square_root(dot(f0, f0) + dot(f1, f1) + 2.0F * ratio), 1e-12F),
              inverse = 1.0F / trace;
  const Lanes3 turned_1 = cross(f1, normal), turned_0 = cross(normal, f0);
  const Lanes3 r0 = inverse * (f0 + turned_1), r1 = inverse * (f1 + turned_0);
  const Lanes3 off0 = f0 - r0, off1 = f1 - r1;
  const Lanes spread = trace - 2.0F, along = lambda * spread, twice = 2.0F * mu;
  Lanes3 s0 = twice * off0 + along * r0, s1 = twice * off1 + along * r1;
  energy += mu * (dot(off0, off0) + dot(off1, off1)) + 0.5F * along * spread;
  if (any_below(ratio, splat(packed.crush_begin))) {
    const Wall wall = wall_at(packed.crush_begin, packed.crush_end, ratio);
    const Lanes slope = mu * wall.slope, bend = corner_bound * mu * wall.bend;
    s0 += slope * turned_1;
    s1 += slope * turned_0;
    energy += mu * wall.value;
    const Lanes3 by_1 = a * turned_1 + b * turned_0, by_2 = c * turned_0, by_0 = by_1 + by_2;
    stiffer[0] += bend * dot(by_0, by_0);
    stiffer[1] += bend * dot(by_1, by_1);
    stiffer[2] += bend * dot(by_2, by_2);
  }
  const Lanes3 force_1 = a * s0 + b * s1, force_2 = c * s1;
  gradient[0] -= force_1 + force_2;
  gradient[1] += force_1;
  gradient[2] += force_2;
}

/// Six times the volume's gradient by the outer corners p and, when asked for, the inner ones q, and the
/// volume; all from p[0]. The closed surface has each bilinear side as the mean of its two splits.
template <bool both>
FASCIA_INLINE Lanes prism_volume(const Lanes3* p, const Lanes3* q, Lanes3* by_p, Lanes3* by_q) {
  const Lanes3 p1 = p[1] - p[0], p2 = p[2] - p[0], q0 = q[0] - p[0], q1 = q[1] - p[0], q2 = q[2] - p[0];
  const Lanes3 s1 = p1 + q1, s2 = p2 + q2, c1 = cross(q1, p1), c2 = cross(q2, p2);
  const Lanes half = splat(0.5F);
  by_p[0] = cross(p1, p2) + half * (cross(q0, s1 - s2) + c1 - c2);
  by_p[1] = half * (cross(q1, s2 - q0) + c2);
  by_p[2] = half * (cross(q2, q0 - s1) - c1);
  Lanes3 own_q[3];
  Lanes3* const g = both ? by_q : own_q;
  g[1] = cross(q0, q2) + half * (cross(p1, q0 - s2) + c2);
  g[2] = cross(q1, q0) + half * (cross(p2, s1 - q0) - c1);
  g[0] = cross(q2, q1) + half * (c1 - c2);
  return (dot(p1, by_p[1]) + dot(p2, by_p[2]) + dot(q0, g[0]) + dot(q1, g[1]) + dot(q2, g[2])) *
         (1.0F / 18.0F);
}

FASCIA_INLINE void prism(const PrismBatch& m, const Packed& packed, const Lanes3* p, const Lanes3* q,
                         Lanes3* by_p, Lanes3* by_q, Lanes* stiffer_p, Lanes* stiffer_q, Lanes& energy) {
  Lanes3 outer[3], inner[3];
  const Lanes volume = prism_volume<true>(p, q, outer, inner);
  const Lanes inverse = load(m.inverse_volume), excess = volume - load(m.volume);
  const Lanes stiff = load(m.stiffness) * inverse * excess, guard = load(m.guard);
  energy += 0.5F * stiff * excess;
  Lanes pressure = stiff * (1.0F / 6.0F);
  const Lanes ratio = volume * inverse;
  if (any_below(ratio, splat(packed.turn_begin))) {
    const Wall wall = wall_at(packed.turn_begin, packed.turn_end, ratio);
    energy += guard * wall.value * greater(load(m.volume), 0.0F);
    pressure += (guard * wall.slope) * (1.0F / 6.0F);
    const Lanes bend = (corner_bound / 36.0F) * guard * inverse * wall.bend;
    for (size_t k = 0; k < 3; ++k) {
      stiffer_p[k] += bend * dot(outer[k], outer[k]);
      stiffer_q[k] += bend * dot(inner[k], inner[k]);
    }
  }
  for (size_t k = 0; k < 3; ++k) {
    by_p[k] += pressure * outer[k];
    by_q[k] += pressure * inner[k];
  }
}

void shares_left(const Packed& packed, size_t b, const float* x, float* shares) {
  const TriangleBatch& batch = packed.triangles[b];
  Lanes3 place[3][3], by_outer[3], by_inner[3];
  for (size_t layer = 0; layer < 3; ++layer)
    for (size_t k = 0; k < 3; ++k)
      place[layer][k] = gather(x + 4 * layer, batch.column[k]);
  for (size_t layer = 0; layer < 2; ++layer)
    store(shares + batch_width * layer,
          prism_volume<true>(place[layer], place[layer + 1], by_outer, by_inner) *
              load(batch.prism[layer].inverse_volume));
}

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
      membrane(batch.membrane[layer], packed, place[layer], force[layer], stiffer[layer], energy);
      prism(batch.prism[layer], packed, place[layer], place[layer + 1], force[layer], force[layer + 1],
            stiffer[layer], stiffer[layer + 1], energy);
    }
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < 3; ++k)
        scatter_add(gradient + 4 * layer, batch.column[k], force[layer][k], stiffer[layer][k]);
  }
  return energy;
}

/// Forces on the edge's ends and opposite corners, all but the first from the first.
FASCIA_INLINE void hinge(const HingeBatch& h, const Packed& packed, const Lanes3* x, Lanes3* gradient,
                         Lanes& energy) {
  const Lanes3 edge = x[1] - x[0], arm_a = x[2] - x[0], arm_b = x[3] - x[0];
  const Lanes w1 = load(h.weight[0]), w2 = load(h.weight[1]), w3 = load(h.weight[2]);
  const Lanes scale_a = load(h.scale_a), scale_b = load(h.scale_b), stiffness = load(h.stiffness),
              bend = load(h.bend);
  Lanes3 normal = scale_a * cross(edge, arm_a) + scale_b * cross(arm_b, edge);
  const Lanes inverse = 1.0F / square_root(dot(normal, normal) + packed.fold_softness);
  normal = inverse * normal;
  const Lanes3 miss = w1 * edge + w2 * arm_a + w3 * arm_b - bend * normal;
  const Lanes3 force = stiffness * miss;
  const Lanes3 turn = (-(bend * inverse)) * (force - dot(normal, force) * normal);
  const Lanes3 turn_a = scale_a * turn, turn_b = scale_b * turn;
  const Lanes3 by_1 = w1 * force + cross(arm_a, turn_a) - cross(arm_b, turn_b);
  gradient[2] = w2 * force + cross(turn_a, edge);
  gradient[3] = w3 * force + cross(edge, turn_b);
  gradient[0] -= by_1 + gradient[2] + gradient[3];
  gradient[1] += by_1;
  energy += 0.5F * dot(force, miss);
}

/// Pull on the first end, against it on the second.
FASCIA_INLINE Lanes3 spring(const SpringBatch& s, const Lanes& slack, const Lanes3& along, Lanes& stiffer,
                            Lanes& energy) {
  const Lanes length = greater(square_root(dot(along, along)), 1e-12F),
              stretch = greater(length - load(s.length), slack);
  const Lanes beyond = positive(stretch - load(s.limit)), extra = load(s.extra),
              stiffness = load(s.stiffness);
  const Lanes force = stiffness * stretch + extra * beyond;
  stiffer = where_below(splat(0.0F), beyond, extra, splat(0.0F));
  energy += 0.5F * (stiffness * stretch * stretch + extra * beyond * beyond);
  return (force / length) * along;
}

Lanes edge_energy(const Packed& packed, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.edge_batches; ++b) {
    const EdgeBatch& batch = packed.edges[b];
    Lanes3 place[3][4], force[3][4];
    Lanes stiffer[3][2];
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < (layer < 2 ? 4 : 2); ++k) {
        place[layer][k] = gather(x + 4 * layer, batch.column[k]);
        force[layer][k] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
        if (k < 2) stiffer[layer][k] = splat(0.0F);
      }
    for (size_t layer = 0; layer < 2; ++layer)
      hinge(batch.hinge[layer], packed, place[layer], force[layer], energy);
    for (size_t k = 0; k < edge_springs; ++k) {
      const size_t first = edge_spring_layers[k][0], second = edge_spring_layers[k][1];
      Lanes more;
      const Lanes3 pull =
          spring(batch.spring[k], splat(-1e3F), place[second][1] - place[first][0], more, energy);
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
  return energy;
}

Lanes spring_energy(const Packed& packed, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.spring_batches; ++b) {
    const LooseSpringBatch& s = packed.springs[b];
    Lanes stiffer;
    const Lanes3 pull =
        spring(s.spring, load(s.slack), gather(x, s.at[1]) - gather(x, s.at[0]), stiffer, energy);
    scatter_add(gradient, s.at[0], splat(-1.0F) * pull, stiffer);
    scatter_add(gradient, s.at[1], pull, stiffer);
  }
  return energy;
}

Lanes held_energy(const Packed& packed, const Driven& driven, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.tether_batches; ++b) {
    const TetherBatch& t = packed.tethers[b];
    const float* n = driven.tether_normals + 3 * batch_width * b;
    const Lanes3 normal{load(n), load(n + batch_width), load(n + 2 * batch_width)};
    const Lanes3 away = gather(x, t.at) - gather(driven.carried, t.at);
    const Lanes along = dot(away, normal), tangential = load(t.tangential), extra = load(t.extra);
    scatter_add(gradient, t.at, tangential * away + (extra * along) * normal);
    energy += 0.5F * (tangential * dot(away, away) + extra * along * along);
  }
  for (size_t b = 0; b < packed.carrier_batches; ++b) {
    const CarrierBatch& c = packed.carriers[b];
    const float* p = driven.carrier_pulls + 3 * batch_width * b;
    const Lanes3 pull{load(p), load(p + batch_width), load(p + 2 * batch_width)};
    const Lanes3 away = gather(x, c.at) - gather(driven.carried, c.at), hold = load(c.stiffness) * away;
    scatter_add(gradient, c.at, hold - pull);
    energy += 0.5F * dot(hold, away) - dot(pull, away);
  }
  for (size_t b = 0; b < packed.globe_batches; ++b) {
    const GlobeBatch& g = packed.globes[b];
    const Lanes3 away = gather(x, g.at) - load3(g.centre);
    const Lanes distance = greater(square_root(dot(away, away)), 1e-12F),
                depth = positive(load(g.radius) - distance);
    const Lanes push = load(g.stiffness) * depth;
    if (!any_below(splat(0.0F), depth)) continue;
    scatter_add(gradient, g.at, (-(push / distance)) * away,
                where_below(splat(0.0F), depth, load(g.stiffness), splat(0.0F)));
    energy += 0.5F * push * depth;
  }
  return energy;
}

Lanes pressure_energy(const Packed& packed, const Driven& driven, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.pressure_batches; ++b) {
    const PressureBatch& batch = packed.pressures[b];
    const Lanes pressure = load(batch.pressure) * channel_values(driven.values, batch.channel);
    if (!any_below(splat(0.0F), pressure) && !any_below(pressure, splat(0.0F))) continue;
    Lanes3 place[3], carried[3], push[3];
    for (size_t k = 0; k < 3; ++k) {
      place[k] = gather(x, batch.at[k]);
      carried[k] = gather(driven.carried, batch.at[k]);
    }
    energy -= pressure * prism_volume<false>(place, carried, push, nullptr);
    const Lanes share = -(pressure * (1.0F / 6.0F));
    for (size_t k = 0; k < 3; ++k)
      scatter_add(gradient, batch.at[k], share * push[k]);
  }
  return energy;
}

/// Where the points of sixteen fibres are.
FASCIA_INLINE Lanes3 fibre_point(const FibrePointBatch& p, const Driven& driven, const float* x) {
  Lanes3 place = load3(p.base);
  if (!driven.jaw_at_rest) {
    const float* r = driven.jaw_rotation;
    const Lanes goes = load(p.mandible);
    const Lanes3 moved{r[0] * place.x + r[1] * place.y + r[2] * place.z + driven.jaw_translation[0],
                       r[3] * place.x + r[4] * place.y + r[5] * place.z + driven.jaw_translation[1],
                       r[6] * place.x + r[7] * place.y + r[8] * place.z + driven.jaw_translation[2]};
    place += goes * (moved - place);
  }
  for (size_t k = 0; k < 3; ++k)
    place += load(p.weight[k]) * gather(x, p.at[k]);
  return place;
}

Lanes fibre_energy(const Packed& packed, const Driven& driven, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.fibre_batches; ++b) {
    const FibreBatch& f = packed.fibres[b];
    const Lanes pull = positive(channel_values(driven.values, f.channel)) * load(f.strength);
    if (!any_below(splat(0.0F), pull)) continue;
    const FibrePointBatch* points = packed.fibre_points + f.first;
    // First where they run and how long they are; each segment's direction is kept.
    Lanes length = splat(0.0F);
    Lanes3 last = fibre_point(points[0], driven, x);
    for (uint32_t p = 0; p + 1 < f.count; ++p) {
      const Lanes3 next = fibre_point(points[p + 1], driven, x), along = next - last;
      const Lanes segment = square_root(dot(along, along) + packed.segment_rounding),
                  taper = load(points[p].taper);
      length += taper * segment;
      float* kept = driven.fibre_scratch + 3 * batch_width * p;
      const Lanes3 way = (taper / segment) * along;
      store(kept, way.x);
      store(kept + batch_width, way.y);
      store(kept + 2 * batch_width, way.z);
      last = next;
    }
    const Lanes rest = load(f.length), shortest = load(f.shortest), range = 1.0F - shortest;
    const Lanes left = positive(length / rest - shortest), tension = pull * left / range;
    energy += 0.5F * rest * (tension * left - pull * range);
    Lanes3 before{splat(0.0F), splat(0.0F), splat(0.0F)};
    for (uint32_t p = 0; p < f.count; ++p) {
      Lanes3 after{splat(0.0F), splat(0.0F), splat(0.0F)};
      if (p + 1 < f.count) {
        const float* kept = driven.fibre_scratch + 3 * batch_width * p;
        after = tension * Lanes3{load(kept), load(kept + batch_width), load(kept + 2 * batch_width)};
      }
      const Lanes3 force = before - after;
      for (size_t k = 0; k < 3; ++k)
        scatter_add(gradient, points[p].at[k], load(points[p].weight[k]) * force);
      before = after;
    }
  }
  return energy;
}

double total_energy(const Packed& packed, const Driven& driven, const float* x, float* gradient) {
  for (size_t i = 0; i < packed.places; i += 16)
    store(gradient + i, splat(0.0F));
  double energy = static_cast<double>(total(triangle_energy(packed, x, gradient)));
  energy += static_cast<double>(total(edge_energy(packed, x, gradient)));
  energy += static_cast<double>(total(spring_energy(packed, x, gradient)));
  energy += static_cast<double>(total(held_energy(packed, driven, x, gradient)));
  energy += static_cast<double>(total(pressure_energy(packed, driven, x, gradient)));
  energy += static_cast<double>(total(fibre_energy(packed, driven, x, gradient)));
  if (packed.balance == nullptr) return energy;
  Lanes work = splat(0.0F);
  for (size_t i = 0; i < packed.places; i += 16) {
    const Lanes balance = load(packed.balance + i);
    store(gradient + i, load(gradient + i) - balance);
    work += balance * (load(x + i) - load(packed.rest + i));
  }
  return energy - static_cast<double>(total(work));
}

}  // namespace
}  // namespace fascia::sim::realtime
