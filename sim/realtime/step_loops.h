#pragma once

// Loops of a time step over unknowns: initial guess, inertia, step sizes; see sim/realtime/loops.h.

#include "sim/lanes/lanes.h"
#include "sim/realtime/loops_common.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

void subtract(const Unknowns& u, float* moved) {
  for (size_t k = 0; k < u.count; ++k)
    store_quad(moved + 4 * k, load_quad(u.x + u.slot[k]) - load_quad(u.begun + 4 * k));
}

double collect(const Unknowns& u, const float* moved, const float* damped, float* packed, float* scaling) {
  const Quad acceleration = {u.acceleration[0], u.acceleration[1], u.acceleration[2], 0.0F};
  Quad twice{}, work{};
  for (size_t k = 0; k < u.count; ++k) {
    const Quad gradient = load_quad(u.gradient + u.slot[k]), x = load_quad(u.x + u.slot[k]);
    const float mass = u.mass[k], more = gradient[3],
                s = more > 0.0F ? __builtin_sqrtf(u.diagonal[k] / (u.diagonal[k] + more)) : 1.0F;
    const Quad felt = mass * acceleration;
    Quad force = gradient - felt;
    work += felt * (x - load_quad(u.rest + u.slot[k]));
    if (u.per_mass != 0.0F) {
      const Quad off = x - load_quad(u.ballistic + 4 * k), way = load_quad(moved + 4 * k);
      const Quad inertia = (u.per_mass * mass) * off,
                 slow = (u.drag * mass) * way + u.stiff * load_quad(damped + 4 * k);
      force += inertia + slow;
      twice += inertia * off + slow * way;
    }
    force[3] = 0.0F;
    store_quad(packed + 4 * k, force);
    store_quad(scaling + 4 * k, s - Quad{});
  }
  const Quad sum = 0.5F * twice - work;
  return static_cast<double>(sum[0]) + static_cast<double>(sum[1]) + static_cast<double>(sum[2]);
}

void scale(const float* factors, const float* list, float* out, size_t count) {
  for (size_t i = 0; i < count; i += batch_width)
    store(out + i, load(factors + i) * load(list + i));
}

constexpr float farthest = 0.0015F;  // metres: largest displacement of a node in one take_steps
constexpr float noise = 1e-5F;       // metres below which a reversal is ignored
constexpr float least_step_scale = 0.02F;
constexpr float inertia_steady = 0.7F,
                inertia_unsteady = 0.5F;  // fraction of the inertial motion in the initial guess

constexpr float most_growth = 1.2F, most_shrinking = 0.4F;  ///< of a step size in one iteration

/// Weight of momentum for a node of this step size: 1 from 1 on, 0 below three quarters.
FASCIA_INLINE Lanes share_of_momentum(const Lanes& step_scale) {
  return positive(4.0F * step_scale - 3.0F);
}

/// For the first or only iteration of a substep: the previous direction belongs to other loads, so only its
/// sign is used, and only if no later iteration gives a better estimate.
FASCIA_INLINE Lanes scale_by_sign(const Lanes& scale, const Lanes3& way, const Lanes3& last) {
  const Lanes none = splat(0.0F), one = splat(1.0F), squared = dot(way, way);
  const Lanes back =
      where_below(dot(way, last), none, where_below(splat(noise * noise), squared, one, none), none);
  const Lanes more = lesser(1.2F * scale, one), less = greater(0.5F * scale, least_step_scale);
  return where_below(none, back, less, more);
}

/// The secant step size, for which the direction would have vanished after the last step: along that step s,
/// taken as `scale` times the direction d then wanted, the direction has become d' = d - lambda s, so that 1
/// / lambda = 1 / (1 / scale - d' s / s^2).
FASCIA_INLINE Lanes scale_by_secant(const Lanes& scale, const Lanes3& way, const Lanes3& last) {
  const Lanes squared = dot(last, last);
  const Lanes inverse = 1.0F / scale - dot(way, last) / greater(squared, 1e-20F);
  const Lanes wanted = greater(1.0F / greater(inverse, 1.0F), most_shrinking * scale);
  const Lanes bounded = greater(lesser(wanted, most_growth * scale), least_step_scale);
  return where_below(splat(0.01F * noise * noise), squared, bounded, scale);
}

/// Updates the nodes' step sizes; returns the momentum coefficient.
float judge_steps(const NodeSteps& s, const SixteenAt& at) {
  const Lanes none = splat(0.0F);
  Lanes step_before = none, step_now = none, way_before = none, way_now = none;
  for (size_t k = 0; k < s.count; k += batch_width) {  // lists of unknowns are whole batches
    const Lanes scale = load(s.step_scale + k);
    const Lanes3 way = gather(s.direction + 4 * k, at), last = gather(s.last + 4 * k, at);
    if (!s.gradient_before) {
      store(s.step_scale + k, scale_by_sign(scale, way, last));
      continue;
    }
    const Lanes chosen = scale_by_secant(scale, way, last);
    store(s.step_scale + k, chosen);
    const Lanes weight = share_of_momentum(chosen);
    const Lanes3 before = gather(s.gradient_before + 4 * k, at), now = gather(s.gradient + 4 * k, at);
    step_before += weight * dot(last, before);
    step_now += weight * dot(last, now);
    way_before += weight * dot(way, before);
    way_now += weight * dot(way, now);
  }
  if (!s.gradient_before) return 0.0F;
  const float slope = total(step_now), curvature = slope - total(step_before),
              conjugacy = total(way_before) - total(way_now);
  if (!(curvature > 0.0F)) return 0.0F;
  const float share = (conjugacy - slope) / curvature;
  return share > 0.0F ? (share < 1.0F ? share : 1.0F) : 0.0F;
}

void take_steps(const NodeSteps& s) {
  SixteenAt at;
  for (size_t l = 0; l < batch_width; ++l)
    at[l] = static_cast<int32_t>(4 * l);
  const float momentum = s.judges ? judge_steps(s, at) : 0.0F;
  const Lanes none = splat(0.0F), one = splat(1.0F);
  for (size_t k = 0; k < s.count; k += batch_width) {
    Lanes step_scale = load(s.step_scale + k);
    Lanes3 way = gather(s.direction + 4 * k, at);
    if (momentum > 0.0F) way += (momentum * share_of_momentum(step_scale)) * gather(s.last + 4 * k, at);
    const Lanes squared = dot(way, way);
    const Lanes most = farthest / square_root(greater(squared, 1e-20F));
    step_scale = where_below(splat(farthest * farthest), squared * step_scale * step_scale, most, step_scale);
    const Lanes is_sound = where_below(squared, splat(1e6F), one, none);  // false where it is not a number
    way = {where_below(none, is_sound, way.x, none), where_below(none, is_sound, way.y, none),
           where_below(none, is_sound, way.z, none)};
    step_scale = where_below(none, is_sound, step_scale, load(s.step_scale + k));
    store(s.step_scale + k, step_scale);
    way = step_scale * way;
    interleave(way, s.last + 4 * k);
    const size_t end = s.count - k < batch_width ? s.count : k + batch_width;
    for (size_t i = k; i < end; ++i)
      store_quad(s.x + s.slot[i], load_quad(s.x + s.slot[i]) + load_quad(s.last + 4 * i));
  }
}

void begin_step(const StepStart& o) {
  for (size_t k = 0; k < o.count; ++k) {
    const int32_t at = o.slot[k];
    const Quad x = load_quad(o.x + at), ballistic = x + o.seconds * load_quad(o.velocity + at);
    const Quad begun = x + (load_quad(o.carried + at) - load_quad(o.carried_before + at));
    const float step_scale = o.step_scale[k], sure = 2.0F * step_scale - 1.0F,
                share = step_scale * (inertia_unsteady +
                                      (inertia_steady - inertia_unsteady) * (sure > 0.0F ? sure : 0.0F));
    store_quad(o.ballistic + 4 * k, ballistic);
    store_quad(o.begun + 4 * k, begun);
    store_quad(o.begun_places + at, begun);
    store_quad(o.x + at, begun + share * (ballistic - begun));
  }
}

double dot_of(const float* a, const float* b, size_t count) {
  Lanes sums[4] = {splat(0.0F), splat(0.0F), splat(0.0F), splat(0.0F)};
  for (size_t i = 0, k = 0; i < count; i += batch_width, ++k)
    sums[k % 4] += load(a + i) * load(b + i);
  return static_cast<double>(total((sums[0] + sums[1]) + (sums[2] + sums[3])));
}

void add(float factor, const float* a, float* to, size_t count) {
  for (size_t i = 0; i < count; i += batch_width)
    store(to + i, load(to + i) + factor * load(a + i));
}

float largest(const float* a, size_t count) {
  Lanes most = splat(0.0F);
  SixteenAt at;
  for (size_t l = 0; l < batch_width; ++l)
    at[l] = static_cast<int32_t>(4 * l);
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
  for (const float value : list)
    result = value > result ? value : result;
  return finite ? result : __builtin_nanf("");
}

}  // namespace
}  // namespace fascia::sim::realtime
