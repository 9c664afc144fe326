// The loops of a face, included once by each of the sources that are compiled for one vector unit (see sim/lanes/lanes.h), which
// define FASCIA_LOOPS. Everything else here is local to the including source. The energies are those of sim/energies.h and
// sim/face_energy.cpp, where they are written to be read.

#include "sim/lanes/lanes.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

FASCIA_INLINE Lanes3 load3(const Sixteen* list) { return {load(list[0]), load(list[1]), load(list[2])}; }
FASCIA_INLINE Lanes3 splat3(const float* list) { return {splat(list[0]), splat(list[1]), splat(list[2])}; }
FASCIA_INLINE Lanes channel_values(const float* values, const SixteenAt& channel) {
  float list[batch_width];
  for (size_t l = 0; l < batch_width; ++l) list[l] = values[channel[l]];
  return load(list);
}
/// Bounds an element's curvature by that of its corners alone: neighbours pull along.
constexpr float corner_bound = 2.0F;

FASCIA_INLINE Lanes positive(const Lanes& a) { return greater(a, splat(0.0F)); }

/// What resists as a share of the rest falls below where it begins, with both derivatives by the share.
struct Wall {
  Lanes value, slope, bend;
};
/// (begin / ratio - 1)^2; from `end` on its parabola, so that a step gone too far has a way back.
FASCIA_INLINE Wall wall_at(float wall_begin, float wall_end, const Lanes& ratio) {
  const Lanes begin = splat(wall_begin), r = greater(ratio, wall_end), inverse = 1.0F / r, none = splat(0.0F);
  const Lanes share = begin * inverse, lack = positive(share - 1.0F), below = ratio - r;
  const Lanes slope = -2.0F * lack * share * inverse;
  const Lanes bend = where_below(ratio, begin, 2.0F * share * (3.0F * share - 2.0F) * (inverse * inverse), none);
  return {where_below(ratio, begin, lack * lack + slope * below + 0.5F * bend * below * below, none),
          where_below(ratio, begin, slope + bend * below, none), bend};
}

FASCIA_INLINE void membrane(const MembraneBatch& m, const Packed& packed, const Lanes3* x, Lanes3* gradient, Lanes* stiffer, Lanes& energy) {
  const Lanes a = load(m.a), b = load(m.b), c = load(m.c), mu = load(m.area_mu), lambda = load(m.area_lambda);
  const Lanes3 first = x[1] - x[0], second = x[2] - x[0];
  const Lanes3 f0 = a * first, f1 = b * first + c * second;
  Lanes3 normal = cross(f0, f1);
  const Lanes ratio = square_root(dot(normal, normal));
  normal = (1.0F / greater(ratio, 1e-14F)) * normal;
  const Lanes trace = greater(square_root(dot(f0, f0) + dot(f1, f1) + 2.0F * ratio), 1e-12F), inverse = 1.0F / trace;
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

/// Six times the volume's gradient by the outer corners p and, when asked for, the inner ones q, and the volume; all from p[0].
/// The closed surface has each bilinear side as the mean of its two splits.
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
  return (dot(p1, by_p[1]) + dot(p2, by_p[2]) + dot(q0, g[0]) + dot(q1, g[1]) + dot(q2, g[2])) * (1.0F / 18.0F);
}

FASCIA_INLINE void prism(const PrismBatch& m, const Packed& packed, const Lanes3* p, const Lanes3* q, Lanes3* by_p, Lanes3* by_q,
                         Lanes* stiffer_p, Lanes* stiffer_q, Lanes& energy) {
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
    for (size_t k = 0; k < 3; ++k) place[layer][k] = gather(x + 4 * layer, batch.column[k]);
  for (size_t layer = 0; layer < 2; ++layer)
    store(shares + batch_width * layer,
          prism_volume<true>(place[layer], place[layer + 1], by_outer, by_inner) * load(batch.prism[layer].inverse_volume));
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
      prism(batch.prism[layer], packed, place[layer], place[layer + 1], force[layer], force[layer + 1], stiffer[layer],
            stiffer[layer + 1], energy);
    }
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < 3; ++k) scatter_add(gradient + 4 * layer, batch.column[k], force[layer][k], stiffer[layer][k]);
  }
  return energy;
}

/// Forces on the edge's ends and opposite corners, all but the first from the first.
FASCIA_INLINE void hinge(const HingeBatch& h, const Packed& packed, const Lanes3* x, Lanes3* gradient, Lanes& energy) {
  const Lanes3 edge = x[1] - x[0], arm_a = x[2] - x[0], arm_b = x[3] - x[0];
  const Lanes w1 = load(h.weight[0]), w2 = load(h.weight[1]), w3 = load(h.weight[2]);
  const Lanes scale_a = load(h.scale_a), scale_b = load(h.scale_b), stiffness = load(h.stiffness), bend = load(h.bend);
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
FASCIA_INLINE Lanes3 spring(const SpringBatch& s, const Lanes& slack, const Lanes3& along, Lanes& stiffer, Lanes& energy) {
  const Lanes length = greater(square_root(dot(along, along)), 1e-12F), stretch = greater(length - load(s.length), slack);
  const Lanes beyond = positive(stretch - load(s.limit)), extra = load(s.extra), stiffness = load(s.stiffness);
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
    for (size_t layer = 0; layer < 2; ++layer) hinge(batch.hinge[layer], packed, place[layer], force[layer], energy);
    for (size_t k = 0; k < edge_springs; ++k) {
      const size_t first = edge_spring_layers[k][0], second = edge_spring_layers[k][1];
      Lanes more;
      const Lanes3 pull = spring(batch.spring[k], splat(-1e3F), place[second][1] - place[first][0], more, energy);
      force[first][0] -= pull;
      force[second][1] += pull;
      stiffer[first][0] += more;
      stiffer[second][1] += more;
    }
    for (size_t layer = 0; layer < 3; ++layer)
      for (size_t k = 0; k < (layer < 2 ? 4 : 2); ++k)
        scatter_add(gradient + 4 * layer, batch.column[k], force[layer][k], k < 2 ? stiffer[layer][k] : splat(0.0F));
  }
  return energy;
}

Lanes spring_energy(const Packed& packed, const float* x, float* gradient) {
  Lanes energy = splat(0.0F);
  for (size_t b = 0; b < packed.spring_batches; ++b) {
    const LooseSpringBatch& s = packed.springs[b];
    Lanes stiffer;
    const Lanes3 pull = spring(s.spring, load(s.slack), gather(x, s.at[1]) - gather(x, s.at[0]), stiffer, energy);
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
    const Lanes distance = greater(square_root(dot(away, away)), 1e-12F), depth = positive(load(g.radius) - distance);
    const Lanes push = load(g.stiffness) * depth;
    if (!any_below(splat(0.0F), depth)) continue;
    scatter_add(gradient, g.at, (-(push / distance)) * away, where_below(splat(0.0F), depth, load(g.stiffness), splat(0.0F)));
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
    for (size_t k = 0; k < 3; ++k) scatter_add(gradient, batch.at[k], share * push[k]);
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
  for (size_t k = 0; k < 3; ++k) place += load(p.weight[k]) * gather(x, p.at[k]);
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
      const Lanes segment = square_root(dot(along, along) + packed.segment_rounding), taper = load(points[p].taper);
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
      for (size_t k = 0; k < 3; ++k) scatter_add(gradient, points[p].at[k], load(points[p].weight[k]) * force);
      before = after;
    }
  }
  return energy;
}

double total_energy(const Packed& packed, const Driven& driven, const float* x, float* gradient) {
  for (size_t i = 0; i < packed.places; i += 16) store(gradient + i, splat(0.0F));
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

/// Sine and 1 - cosine up to an angle of 3.2: of the half, by their series, then doubled.
FASCIA_INLINE void turn_of(const Lanes& angle, Lanes& sine, Lanes& versine) {
  const Lanes h = 0.5F * angle, s = h * h;
  const Lanes half_sine =
      h * (1.0F - s * ((1.0F / 6) - s * ((1.0F / 120) - s * ((1.0F / 5040) - s * ((1.0F / 362880) - s * (1.0F / 39916800))))));
  const Lanes half_cosine =
      1.0F - s * (0.5F - s * ((1.0F / 24) - s * ((1.0F / 720) - s * ((1.0F / 40320) - s * ((1.0F / 3628800) - s * (1.0F / 479001600))))));
  sine = 2.0F * half_sine * half_cosine;
  versine = 2.0F * half_sine * half_sine;
}

/// What turning adds to an arm (Rodrigues).
FASCIA_INLINE Lanes3 turned(const Lanes3& axis, const Lanes& sine, const Lanes& versine, const Lanes3& arm) {
  const Lanes3 across = cross(axis, arm);
  return sine * across + versine * cross(axis, across);
}

/// What the share of the jaw's pose that a node takes adds to an arm from the joint, without the glide: see jaw_transform.
FASCIA_INLINE Lanes3 jaw_turn(const Driven& driven, const Lanes& share, const Lanes3& arm) {
  const Lanes3 up = splat3(driven.jaw_up), lateral = splat3(driven.jaw_lateral);
  Lanes sine, versine;
  turn_of(share * driven.turn_open, sine, versine);
  const Lanes3 first = turned(lateral, sine, versine, arm);
  turn_of(share * driven.turn_lateral, sine, versine);
  return first + turned(up, sine, versine, arm + first);
}

FASCIA_INLINE Lanes shares_at(const Packed& packed, const SixteenAt& at) {
  float list[batch_width];
  for (size_t l = 0; l < batch_width; ++l) list[l] = packed.jaw_share[at[l] / 4];
  return load(list);
}

void place(const Packed& packed, const Driven& driven) {
  const Lanes3 origin = splat3(driven.jaw_origin), glide = splat3(driven.glide);
  if (driven.jaw_at_rest) {
    for (size_t i = 0; i < packed.places; i += 16) store(driven.carried + i, load(packed.rest + i));
  } else {
    SixteenAt at;
    for (size_t l = 0; l < batch_width; ++l) at[l] = static_cast<int32_t>(4 * l);
    for (size_t i = 0; i < packed.places; i += 4 * batch_width) {
      const Lanes3 rest = gather(packed.rest + i, at);
      const Lanes share = load(packed.jaw_share + i / 4);
      interleave(rest + (jaw_turn(driven, share, rest - origin) + share * glide), driven.carried + i);
    }
  }
  for (size_t b = 0; b < packed.tether_batches; ++b) {
    const TetherBatch& t = packed.tethers[b];
    Lanes3 normal = load3(t.normal);
    if (!driven.jaw_at_rest) normal += jaw_turn(driven, shares_at(packed, t.at), normal);
    float* to = driven.tether_normals + 3 * batch_width * b;
    store(to, normal.x);
    store(to + batch_width, normal.y);
    store(to + 2 * batch_width, normal.z);
  }
  for (size_t b = 0; b < packed.carrier_batches; ++b) {
    const CarrierBatch& c = packed.carriers[b];
    const Lanes value = channel_values(driven.values, c.channel), none = splat(0.0F);
    const Lanes angle = where_below(value, none, -(value * load(c.reverse)), value * load(c.angle));
    Lanes sine, versine;
    turn_of(angle, sine, versine);
    const Lanes3 pull = load(c.drive) * turned(load3(c.axis), sine, versine, gather(driven.carried, c.at) - load3(c.origin));
    float* to = driven.carrier_pulls + 3 * batch_width * b;
    store(to, pull.x);
    store(to + batch_width, pull.y);
    store(to + 2 * batch_width, pull.z);
  }
}

void multiply(const SparseRows& m, const float* x, float* out) {
  for (size_t i = 0; i < m.size; ++i) {
    Lanes sums = splat(0.0F);  // of every fourth entry
    for (uint32_t e = m.begin[i]; e < m.begin[i + 1]; e += 4) sums += each_four_times(m.value + e) * four_places(x, m.column + e);
    store_quad(out + 4 * i, quarters(sums));
  }
}

void subtract(const Unknowns& u, float* moved) {
  for (size_t k = 0; k < u.count; ++k) store_quad(moved + 4 * k, load_quad(u.x + u.slot[k]) - load_quad(u.begun + 4 * k));
}

double collect(const Unknowns& u, const float* moved, const float* damped, float* packed, float* answer) {
  const Quad acceleration = {u.acceleration[0], u.acceleration[1], u.acceleration[2], 0.0F};
  Quad twice{}, work{};
  for (size_t k = 0; k < u.count; ++k) {
    const Quad gradient = load_quad(u.gradient + u.slot[k]), x = load_quad(u.x + u.slot[k]);
    const float mass = u.mass[k], more = gradient[3], s = more > 0.0F ? __builtin_sqrtf(u.diagonal[k] / (u.diagonal[k] + more)) : 1.0F;
    const Quad felt = mass * acceleration;
    Quad force = gradient - felt;
    work += felt * (x - load_quad(u.rest + u.slot[k]));
    if (u.per_mass != 0.0F) {
      const Quad off = x - load_quad(u.ballistic + 4 * k), way = load_quad(moved + 4 * k);
      const Quad inertia = (u.per_mass * mass) * off, slow = (u.drag * mass) * way + u.stiff * load_quad(damped + 4 * k);
      force += inertia + slow;
      twice += inertia * off + slow * way;
    }
    force[3] = 0.0F;
    store_quad(packed + 4 * k, force);
    store_quad(answer + 4 * k, s - Quad{});
  }
  const Quad sum = 0.5F * twice - work;
  return static_cast<double>(sum[0]) + static_cast<double>(sum[1]) + static_cast<double>(sum[2]);
}

void scale(const float* factors, float* list, size_t count) {
  for (size_t i = 0; i < count; i += batch_width) store(list + i, load(factors + i) * load(list + i));
}

/// So many accumulators of three coordinates fit a unit's registers.
constexpr size_t group_width = part_count == 1 ? 4 : part_count == 2 ? 2 : 1;

/// Adds what `count` blocks of a front, all with every column, say of its own places.
template <size_t count>
FASCIA_INLINE void spread_columns(const float* value, uint32_t columns, const float* own, const int32_t* row, float* values) {
  Lanes3 sums[count];
  for (size_t g = 0; g < count; ++g) sums[g] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
  for (uint32_t c = 0; c < columns; ++c) {
    const Lanes x = splat(own[4 * c]), y = splat(own[4 * c + 1]), z = splat(own[4 * c + 2]);
    for (size_t g = 0; g < count; ++g) sums[g] += load(value + batch_width * (g * columns + c)) * Lanes3{x, y, z};
  }
  for (size_t g = 0; g < count; ++g) scatter_add(values, row + batch_width * g, sums[g]);
}

void go_forward(const Panels& panels, const Panels::Front& front, float* values, float* own) {
  float* const from = values + 4 * static_cast<size_t>(front.first);
  for (uint32_t c = 0; c < front.width; ++c) {
    store_quad(own + 4 * c, load_quad(from + 4 * c));
    store_quad(from + 4 * c, Quad{});
  }
  const float* value = panels.value + front.values;
  const int32_t* row = panels.row + front.rows;
  for (uint32_t b = 0; b < front.blocks;) {
    const uint32_t columns = front.columns(b);
    if (columns == front.width && b + group_width <= front.blocks) {
      spread_columns<group_width>(value, columns, own, row, values);
      value += group_width * batch_width * columns;
      row += group_width * batch_width;
      b += group_width;
    } else {
      spread_columns<1>(value, columns, own, row, values);
      value += batch_width * columns;
      row += batch_width;
      ++b;
    }
  }
}

/// What `count` columns from `column` on say of the places of all rows, `places` as x, y, z of sixteen.
template <size_t count>
FASCIA_INLINE void collect_rows(const Panels::Front& front, const float* value, uint32_t block, uint32_t column, const float* places, float* own) {
  Lanes3 sums[count];
  for (size_t g = 0; g < count; ++g) sums[g] = Lanes3{splat(0.0F), splat(0.0F), splat(0.0F)};
  value += batch_width * column;
  for (uint32_t b = block; b < front.blocks; ++b) {
    const float* p = places + 3 * batch_width * b;
    const Lanes3 place{load(p), load(p + batch_width), load(p + 2 * batch_width)};
    for (size_t g = 0; g < count; ++g) sums[g] += load(value + batch_width * g) * place;
    value += batch_width * front.columns(b);
  }
  for (size_t g = 0; g < count; ++g) store_quad(own + 4 * (column + g), totals(sums[g]));
}

void go_back(const Panels& panels, const Panels::Front& front, float* values, float* places) {
  const int32_t* row = panels.row + front.rows;
  for (uint32_t b = 0; b < front.blocks; ++b) {
    const Lanes3 place = gather(values, row + batch_width * b);
    float* const to = places + 3 * batch_width * b;
    store(to, place.x);
    store(to + batch_width, place.y);
    store(to + 2 * batch_width, place.z);
  }
  float* const own = values + 4 * static_cast<size_t>(front.first);
  const float* value = panels.value + front.values;
  // Columns of one block of own rows at a time: blocks before it do not have them.
  for (uint32_t block = 0, first = 0; first < front.width; ++block, first += batch_width) {
    const uint32_t end = front.columns(block);
    uint32_t c = first;
    for (; c + group_width <= end; c += group_width) collect_rows<group_width>(front, value, block, c, places, own);
    for (; c < end; ++c) collect_rows<1>(front, value, block, c, places, own);
    value += batch_width * end;
  }
}

void solve(const Panels& panels, float* values, float* scratch) {
  for (size_t f = 0; f < panels.fronts; ++f) go_forward(panels, panels.front[f], values, scratch);
  for (size_t f = panels.fronts; f-- > 0;) go_back(panels, panels.front[f], values, scratch);
}

constexpr float farthest = 0.0015F;  // metres a node may go in one stride
constexpr float noise = 1e-5F;       // metres below which turning back means nothing
constexpr float least_trust = 0.02F;
constexpr float inertia_trusted = 0.7F, inertia_else = 0.5F;  // share of what inertia alone would do that the first guess takes

void stride(const Stride& s) {
  SixteenAt at;
  for (size_t l = 0; l < batch_width; ++l) at[l] = static_cast<int32_t>(4 * l);
  const Lanes none = splat(0.0F), one = splat(1.0F);
  for (size_t k = 0; k < s.count; k += batch_width) {  // lists of unknowns are whole batches
    Lanes trust = load(s.trust + k);
    const Lanes3 last = gather(s.last + 4 * k, at);
    Lanes3 way = gather(s.direction + 4 * k, at);
    if (s.onward > 0.0F) way += (s.onward * positive(4.0F * trust - 3.0F)) * gather(s.before + 4 * k, at);
    const Lanes squared = dot(way, way), along = dot(way, last);
    const Lanes back = where_below(along, none, where_below(splat(noise * noise), squared, one, none), none);
    const Lanes more = lesser(1.2F * trust, one), less = greater(0.5F * trust, least_trust);
    trust = where_below(none, back, less, more);
    const Lanes most = farthest / square_root(greater(squared, 1e-20F));
    trust = where_below(splat(farthest * farthest), squared * trust * trust, most, trust);
    const Lanes is_sound = where_below(squared, splat(1e6F), one, none);  // false where it is not a number
    way = {where_below(none, is_sound, way.x, none), where_below(none, is_sound, way.y, none), where_below(none, is_sound, way.z, none)};
    trust = where_below(none, is_sound, trust, load(s.trust + k));
    store(s.trust + k, trust);
    way = trust * way;
    interleave(way, s.last + 4 * k);
    interleave(way, s.direction + 4 * k);
    const size_t end = s.count - k < batch_width ? s.count : k + batch_width;
    for (size_t i = k; i < end; ++i) store_quad(s.x + s.slot[i], load_quad(s.x + s.slot[i]) + load_quad(s.direction + 4 * i));
  }
}

void set_out(const Outset& o) {
  for (size_t k = 0; k < o.count; ++k) {
    const int32_t at = o.slot[k];
    const Quad x = load_quad(o.x + at), ballistic = x + o.seconds * load_quad(o.velocity + at);
    const Quad begun = x + (load_quad(o.carried + at) - load_quad(o.carried_before + at));
    const float trust = o.trust[k], sure = 2.0F * trust - 1.0F, share = trust * (inertia_else + (inertia_trusted - inertia_else) * (sure > 0.0F ? sure : 0.0F));
    store_quad(o.ballistic + 4 * k, ballistic);
    store_quad(o.begun + 4 * k, begun);
    store_quad(o.begun_places + at, begun);
    store_quad(o.x + at, begun + share * (ballistic - begun));
  }
}

double dot_of(const float* a, const float* b, size_t count) {
  Lanes sums[4] = {splat(0.0F), splat(0.0F), splat(0.0F), splat(0.0F)};
  for (size_t i = 0, k = 0; i < count; i += batch_width, ++k) sums[k % 4] += load(a + i) * load(b + i);
  return static_cast<double>(total((sums[0] + sums[1]) + (sums[2] + sums[3])));
}

void add(float factor, const float* a, float* to, size_t count) {
  for (size_t i = 0; i < count; i += batch_width) store(to + i, load(to + i) + factor * load(a + i));
}

float largest(const float* a, size_t count) {
  Lanes most = splat(0.0F);
  SixteenAt at;
  for (size_t l = 0; l < batch_width; ++l) at[l] = static_cast<int32_t>(4 * l);
  bool finite = true;
  for (size_t i = 0; i < count; i += 4 * batch_width) {
    const Lanes3 value = gather(a + i, at);
    const Lanes squared = dot(value, value);
    most = greater(squared, most);
    const float sum = total(squared);
    finite = finite && sum == sum;
  }
  float list[batch_width], result = 0.0F;
  store(list, most);
  for (const float value : list) result = value > result ? value : result;
  return finite ? result : __builtin_nanf("");
}

}  // namespace

const Loops& FASCIA_LOOPS() {
  static constexpr Loops loops{place, total_energy, shares_left, multiply, subtract, collect, scale, solve, stride, set_out, dot_of, add, largest};
  return loops;
}

}  // namespace fascia::sim::realtime
