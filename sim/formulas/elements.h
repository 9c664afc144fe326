// The energy of each kind of element with its gradient, for doubles and for lanes (numbers.h). Energies are
// in joules and are added to `energy`, gradients in newtons are added to `gradient`. `stiffer` of a node is
// increased by an upper bound of the diagonal of the curvature added relative to rest, newton per metre, for
// solvers that use the stiffness matrix of the rest pose.

#pragma once

#include "sim/formulas/numbers.h"

namespace fascia::sim::formulas {

// Limits of the barriers.
constexpr double crush_begin = 0.5;  ///< ratio to its rest area below which a membrane has a barrier
constexpr double crush_end = 0.1;    ///< share below which its resistance goes on as a parabola
constexpr double turn_begin =
    0.4;  ///< ratio to its rest volume below which a prism has a barrier against inversion
constexpr double turn_end = 0.1;              ///< share below which its resistance goes on as a parabola
constexpr double turn_modulus = 800.0;        ///< pascal: modulus of that barrier
constexpr double segment_rounding = 6.25e-8;  ///< square metres: smooths the length of short fibre segments
constexpr double fold_softness = 0.01;  ///< where a hinge's mean normal is faded out: folds within 6 degrees

/// Factor that bounds an element's curvature by its diagonal blocks.
constexpr double corner_bound = 2.0;

/// A barrier as a function of the ratio to rest, with its first two derivatives.
template <class N>
struct Wall {
  N value, slope, curvature;
};
/// (begin / ratio - 1)^2 below `begin`; below `end` its osculating parabola, so that inverted elements can
/// recover.
template <class N>
FASCIA_INLINE Wall<N> wall_at(const N& ratio, double wall_begin, double wall_end) {
  const N begin = like(ratio, wall_begin), none = like(ratio, 0.0), r = greater(ratio, wall_end),
          inverse = 1.0 / r;
  const N share = begin * inverse, lack = positive(share - 1.0), below = ratio - r;
  const N slope = -2.0 * lack * share * inverse;
  const N curvature =
      where_below(ratio, begin, 2.0 * share * (3.0 * share - 2.0) * (inverse * inverse), none);
  return {where_below(ratio, begin, lack * lack + slope * below + 0.5 * curvature * below * below, none),
          where_below(ratio, begin, slope + curvature * below, none), curvature};
}

/// A constant-strain triangle at rest. The inverse of its rest edges, in its own plane, is upper triangular:
/// (a, b; 0, c), per metre. `mu` and `lambda` are times its area, newton metre.
template <class N>
struct MembraneRest {
  N a, b, c, mu, lambda;
};
/// Corotated linear elasticity in plane stress: W = area (mu |F - R|^2 + lambda/2 (tr S - 2)^2), F = R S
/// (Sifakis & Barbic 2012, section 3.3), and a barrier mu (1 / (2 J) - 1)^2 against collapse.
template <class N>
FASCIA_INLINE void membrane(const MembraneRest<N>& m, const Three<N>* x, Three<N>* gradient, N* stiffer,
                            N& energy) {
  const Three<N> first = x[1] - x[0], second = x[2] - x[0];
  const Three<N> f0 = m.a * first, f1 = m.b * first + m.c * second;
  Three<N> normal = cross(f0, f1);
  const N ratio = square_root(dot(normal, normal));
  normal = (1.0 / greater(ratio, 1e-14)) * normal;
  // For a 3 x 2 matrix tr S = sqrt(|F|^2 + 2 det S), and R = (F + cofactor of F) / tr S.
  const N trace = greater(square_root(dot(f0, f0) + dot(f1, f1) + 2.0 * ratio), 1e-12), inverse = 1.0 / trace;
  const Three<N> cofactor_0 = cross(f1, normal), cofactor_1 = cross(normal, f0);
  const Three<N> r0 = inverse * (f0 + cofactor_0), r1 = inverse * (f1 + cofactor_1);
  const Three<N> off0 = f0 - r0, off1 = f1 - r1;
  const N spread = trace - 2.0, along = m.lambda * spread, twice = 2.0 * m.mu;
  Three<N> s0 = twice * off0 + along * r0, s1 = twice * off1 + along * r1;
  energy += m.mu * (dot(off0, off0) + dot(off1, off1)) + 0.5 * along * spread;
  if (any_below(ratio, like(ratio, crush_begin))) {
    const Wall<N> wall = wall_at(ratio, crush_begin, crush_end);
    const N slope = m.mu * wall.slope, bound = corner_bound * m.mu * wall.curvature;
    s0 += slope * cofactor_0;
    s1 += slope * cofactor_1;
    energy += m.mu * wall.value;
    const Three<N> by_1 = m.a * cofactor_0 + m.b * cofactor_1, by_2 = m.c * cofactor_1, by_0 = by_1 + by_2;
    stiffer[0] += bound * dot(by_0, by_0);
    stiffer[1] += bound * dot(by_1, by_1);
    stiffer[2] += bound * dot(by_2, by_2);
  }
  const Three<N> force_1 = m.a * s0 + m.b * s1, force_2 = m.c * s1;
  gradient[0] -= force_1 + force_2;
  gradient[1] += force_1;
  gradient[2] += force_2;
}

/// Volume of the prism between the outer corners p and the inner ones q, cubic metres, and six times its
/// gradient by both (for q only on request). The closed surface has each bilinear side as the mean of its two
/// diagonal splits; everything is taken from p[0].
template <bool both, class N>
FASCIA_INLINE N prism_volume(const Three<N>* p, const Three<N>* q, Three<N>* by_p, Three<N>* by_q) {
  const Three<N> p1 = p[1] - p[0], p2 = p[2] - p[0], q0 = q[0] - p[0], q1 = q[1] - p[0], q2 = q[2] - p[0];
  const Three<N> s1 = p1 + q1, s2 = p2 + q2, c1 = cross(q1, p1), c2 = cross(q2, p2);
  const N half = like(p1.x, 0.5);
  by_p[0] = cross(p1, p2) + half * (cross(q0, s1 - s2) + c1 - c2);
  by_p[1] = half * (cross(q1, s2 - q0) + c2);
  by_p[2] = half * (cross(q2, q0 - s1) - c1);
  Three<N> own_q[3];
  Three<N>* const g = both ? by_q : own_q;
  g[1] = cross(q0, q2) + half * (cross(p1, q0 - s2) + c2);
  g[2] = cross(q1, q0) + half * (cross(p2, s1 - q0) - c1);
  g[0] = cross(q2, q1) + half * (c1 - c2);
  return (dot(p1, by_p[1]) + dot(p2, by_p[2]) + dot(q0, g[0]) + dot(q1, g[1]) + dot(q2, g[2])) * (1.0 / 18.0);
}

/// A prism at rest: volume in cubic metres and its inverse (of its size, never zero), stiffness in pascal,
/// and `guard`, the modulus of the barrier against inversion: turn_modulus, or 0 if it is inverted at rest.
template <class N>
struct PrismRest {
  N volume, inverse_volume, stiffness, guard;
};
/// W = stiffness/(2 V0) (V - V0)^2 and a barrier against inversion, guard V0 (0.4 V0 / V - 1)^2. `pressure`
/// is dW/dV, pascal; the result is d2W/dV2 of the barrier alone.
template <class N>
FASCIA_INLINE N prism_pressure(const PrismRest<N>& m, const N& volume, N& pressure, bool& has_wall,
                               N& energy) {
  const N excess = volume - m.volume, stiff = m.stiffness * m.inverse_volume * excess;
  energy += 0.5 * stiff * excess;
  pressure = stiff;
  const N ratio = volume * m.inverse_volume;
  has_wall = any_below(ratio, like(ratio, turn_begin));
  if (!has_wall) return like(ratio, 0.0);
  const Wall<N> wall = wall_at(ratio, turn_begin, turn_end);
  energy += m.guard * wall.value * positive(m.volume);
  pressure += m.guard * wall.slope;
  return m.guard * m.inverse_volume * wall.curvature;
}
template <class N>
FASCIA_INLINE void prism(const PrismRest<N>& m, const Three<N>* p, const Three<N>* q, Three<N>* by_p,
                         Three<N>* by_q, N* stiffer_p, N* stiffer_q, N& energy) {
  Three<N> outer[3], inner[3];
  const N volume = prism_volume<true>(p, q, outer, inner);
  N pressure;
  bool has_wall;
  const N curvature = prism_pressure(m, volume, pressure, has_wall, energy);
  if (has_wall) {
    const N bound = (corner_bound / 36.0) * curvature;
    for (int k = 0; k < 3; ++k) {
      stiffer_p[k] += bound * dot(outer[k], outer[k]);
      stiffer_q[k] += bound * dot(inner[k], inner[k]);
    }
  }
  const N share = pressure * (1.0 / 6.0);
  for (int k = 0; k < 3; ++k) {
    by_p[k] += share * outer[k];
    by_q[k] += share * inner[k];
  }
}

/// An edge with two triangles at rest: weights (per metre) of its second end and of the corners opposite to
/// it, that of the first end makes the sum zero; see sim::Hinge.
template <class N>
struct HingeRest {
  N weight_1, weight_2, weight_3, stiffness, bend, scale_a, scale_b;
};
/// The mean normal of a hinge's triangles, faded out where they fold onto each other: shorter than 1 there.
template <class N>
FASCIA_INLINE Three<N> hinge_normal(const N& scale_a, const N& scale_b, const Three<N>& edge,
                                    const Three<N>& arm_a, const Three<N>& arm_b, N& inverse_length) {
  const Three<N> normal = scale_a * cross(edge, arm_a) + scale_b * cross(arm_b, edge);
  inverse_length = 1.0 / square_root(dot(normal, normal) + fold_softness);
  return inverse_length * normal;
}
/// W = stiffness/2 |L - bend n|^2, L the weighted sum of the four positions: quadratic for a flat rest shape
/// (Bergou et al. 2006), smooth for a curved one even when its triangles shrink or fold (Garg et al. 2007).
/// `x` and `gradient` are of the edge's ends, then of the opposite corners; the gradient is set, not added
/// to.
template <class N>
FASCIA_INLINE void hinge(const HingeRest<N>& h, const Three<N>* x, Three<N>* gradient, N& energy) {
  const Three<N> edge = x[1] - x[0], arm_a = x[2] - x[0], arm_b = x[3] - x[0];
  N inverse;
  const Three<N> normal = hinge_normal(h.scale_a, h.scale_b, edge, arm_a, arm_b, inverse);
  const Three<N> miss = h.weight_1 * edge + h.weight_2 * arm_a + h.weight_3 * arm_b - h.bend * normal;
  const Three<N> force = h.stiffness * miss;
  // The normal turns with the triangles: d(normal) = (I - normal normal^T) d(sum of normals) / length.
  const Three<N> turn = (-(h.bend * inverse)) * (force - dot(normal, force) * normal);
  const Three<N> turn_a = h.scale_a * turn, turn_b = h.scale_b * turn;
  const Three<N> by_1 = h.weight_1 * force + cross(arm_a, turn_a) - cross(arm_b, turn_b);
  const Three<N> by_2 = h.weight_2 * force + cross(turn_a, edge),
                 by_3 = h.weight_3 * force + cross(edge, turn_b);
  gradient[0] = -(by_1 + by_2 + by_3);
  gradient[1] = by_1;
  gradient[2] = by_2;
  gradient[3] = by_3;
  energy += 0.5 * dot(force, miss);
}

/// A spring at rest: metres, newton per metre; `extra` is the additional stiffness beyond the stretch
/// `limit`.
template <class N>
struct SpringRest {
  N length, stiffness, limit, extra;
};
/// Its tension at a `stretch`, of which `beyond` exceeds the limit.
template <class N>
FASCIA_INLINE N spring_tension(const SpringRest<N>& s, const N& stretch, const N& beyond) {
  return s.stiffness * stretch + s.extra * beyond;
}
/// Force on the first end; the second has the opposite. `slack` is the stretch below which it is zero: 0 for
/// a one-sided spring, else no_slack.
constexpr double no_slack = -1e3;
template <class N>
FASCIA_INLINE Three<N> spring(const SpringRest<N>& s, const N& slack, const Three<N>& along, N& stiffer,
                              N& energy) {
  const N length = greater(square_root(dot(along, along)), 1e-12),
          stretch = greater(length - s.length, slack);
  const N beyond = positive(stretch - s.limit), none = like(length, 0.0);
  const N force = spring_tension(s, stretch, beyond);
  stiffer = where_below(none, beyond, s.extra, none);
  energy += 0.5 * (s.stiffness * stretch * stretch + s.extra * beyond * beyond);
  return (force / length) * along;
}

/// Force of a tether with the offset `away` from its anchor: `tangential` newton per metre, plus `extra`
/// along the unit `normal`.
template <class N>
FASCIA_INLINE Three<N> tether(const N& tangential, const N& extra, const Three<N>& normal,
                              const Three<N>& away, N& energy) {
  const N along = dot(away, normal);
  energy += 0.5 * (tangential * dot(away, away) + extra * along * along);
  return tangential * away + (extra * along) * normal;
}

/// Force of a carrier: a tether with the offset `away` from its rigidly moved position, and the pull of an
/// actuator.
template <class N>
FASCIA_INLINE Three<N> held_and_pulled(const N& stiffness, const Three<N>& pull, const Three<N>& away,
                                       N& energy) {
  const Three<N> hold = stiffness * away;
  energy += 0.5 * dot(hold, away) - dot(pull, away);
  return hold - pull;
}

/// Penetration depth of a node with the offset `away` from the centre of a ball, 0 outside, and its distance.
template <class N>
FASCIA_INLINE N depth_in_ball(const N& radius, const Three<N>& away, N& distance) {
  distance = greater(square_root(dot(away, away)), 1e-12);
  return positive(radius - distance);
}

/// Length of a fibre segment, smoothed below a quarter of a millimetre: the direction of a collapsed segment
/// is undefined, and without smoothing its force would be discontinuous.
template <class N>
FASCIA_INLINE N segment_length(const Three<N>& along) {
  return square_root(dot(along, along) + segment_rounding);
}
/// Tension of a fibre of the length `length`: its force (newton at rest length) decreases with its length to
/// zero at its minimum length, the ascending limb of the force-length curve as a line. The integral is convex
/// in length.
template <class N>
FASCIA_INLINE N fibre_tension(const N& pull, const N& length, const N& rest_length, const N& shortest,
                              N& energy) {
  const N range = 1.0 - shortest, left = positive(length / rest_length - shortest),
          tension = pull * left / range;
  energy += 0.5 * rest_length * (tension * left - pull * range);
  return tension;
}

}  // namespace fascia::sim::formulas
