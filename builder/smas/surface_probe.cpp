#include "builder/smas/surface_probe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::smas {

bool EdgeFrame::set(const Front& front, int edge) {
  e = edge, a = front.edges[edge].from, b = front.edges[edge].to;
  pa = front.mesh.vertices[a], pb = front.mesh.vertices[b];
  mid = 0.5 * (pa + pb);
  d = pb - pa;
  length = d.norm();
  if (!(length > 0.0)) return false;
  d /= length;
  n = front.normals[a] + front.normals[b];
  n -= d * d.dot(n);
  const double up = n.norm();
  if (!(up > 0.0)) return false;
  n /= up;
  o = d.cross(n);
  size = 0.5 * (front.sizes[a] + front.sizes[b]);
  return true;
}

SurfaceProbe::Hit SurfaceProbe::descend(const Vec3& from, double reach) {
  Hit hit;
  Vec3 p = from, gradient;
  for (int i = 0; i < 40; ++i) {
    const double f = evaluate(p, &gradient);
    const double slope = gradient.norm();
    if (!std::isfinite(f) || !std::isfinite(slope) || slope <= 0.0) return hit;
    const double distance = f / slope;
    if (std::abs(distance) <= options_.tolerance) {
      hit = {true, p, gradient / slope};
      return hit;
    }
    p -= gradient / slope * std::clamp(distance, -reach, reach);
  }
  return hit;
}

// What the normals known so far say of the curvature.
SurfaceProbe::Bend SurfaceProbe::bend(const Front& front, const EdgeFrame& frame) const {
  const int c = front.edges[frame.e].opposite;
  const double back = std::max((frame.mid - front.mesh.vertices[c]).dot(frame.o), 0.25 * frame.size);
  return {-front.normals[c].dot(frame.o) / back,
          (front.normals[frame.b] - front.normals[frame.a]).dot(frame.d) / frame.length};
}

double SurfaceProbe::first_angle(const Bend& bend, const EdgeFrame& frame, double radius) const {
  const double rise = (bend.along * frame.length * frame.length / 8.0) - 0.5 * bend.across * radius * radius;
  return std::clamp(std::atan2(rise, radius), -0.9, 0.9);
}

// Of the circle on which the apex of a triangle with sides `step` moves.
double SurfaceProbe::radius_for(const EdgeFrame& frame, double step) const {
  const double side = std::max(step, 0.55 * frame.length);
  return std::max(std::sqrt(side * side - 0.25 * frame.length * frame.length), 0.5 * step);
}

Vec3 SurfaceProbe::foretell(const Front& front, const EdgeFrame& frame) const {
  const double radius = radius_for(frame, std::clamp(frame.size, options_.shortest, options_.longest));
  const double angle = first_angle(bend(front, frame), frame, radius);
  return frame.mid + radius * (std::cos(angle) * frame.o + std::sin(angle) * frame.n);
}

// Edge-spinning: the apex moves on a circle of `radius` about the edge's middle until f = 0.
SurfaceProbe::Hit SurfaceProbe::spin(const EdgeFrame& frame, const Bend& bend, double radius) {
  double angle = first_angle(bend, frame, radius);
  const double sharpest = std::max({std::abs(bend.across), std::abs(bend.along), 0.3 / radius});
  Hit hit;
  Vec3 gradient;
  for (int i = 0; i < 12; ++i) {
    const Vec3 out = frame.o * std::cos(angle) + frame.n * std::sin(angle);
    const Vec3 turn = frame.n * std::cos(angle) - frame.o * std::sin(angle);
    const Vec3 p = frame.mid + radius * out;
    const double f = evaluate(p, &gradient);
    const double slope = gradient.norm();
    if (!std::isfinite(f) || !std::isfinite(slope) || slope <= 0.0) return hit;
    const double distance = std::abs(f) / slope;
    const double rate = gradient.dot(turn) * radius;
    if (distance <= options_.tolerance) {
      hit = {true, p, gradient / slope};
      return hit;
    }
    if (!(rate > 0.05 * slope * radius)) return hit;  // the circle runs along or against the sheet
    const double step = -f / rate;
    // So near that Newton's remainder is below the tolerance: step on, and keep the gradient.
    if (radius * radius * step * step * sharpest < 0.25 * options_.tolerance) {
      angle += step;
      hit = {true, Vec3(frame.mid + radius * (frame.o * std::cos(angle) + frame.n * std::sin(angle))),
             gradient / slope};
      return hit;
    }
    angle += std::clamp(step, -0.5, 0.5);
    if (std::abs(angle) > 1.4) return hit;
  }
  return hit;
}

SurfaceProbe::Hit SurfaceProbe::apex(const Front& front, const EdgeFrame& frame, double* size) {
  const Bend known = bend(front, frame);
  double step = std::clamp(frame.size, options_.shortest, options_.longest);
  Hit hit;
  for (int attempt = 0; attempt < 6; ++attempt) {
    const double radius = radius_for(frame, step);
    hit = spin(frame, known, radius);
    const bool turned = !hit.found || hit.normal.dot(frame.n) < kSameSheet;
    const double turn = turned ? 1.5 : std::acos(std::clamp(hit.normal.dot(frame.n), -1.0, 1.0));
    // Past the shortest edge only as far as it takes to hold on to the sheet.
    const bool fits =
        !turned && (turn <= 1.3 * options_.max_normal_turn || step <= options_.shortest * 1.001);
    if (fits) {
      const double wanted = turn > 1e-9 ? radius * options_.max_normal_turn / turn : options_.longest;
      *size = std::clamp(std::min(wanted, 1.3 * frame.size), options_.shortest, options_.longest);
      return hit;
    }
    if (turned && step < 0.2 * options_.shortest) break;
    step = turned
               ? 0.5 * step
               : std::max(options_.shortest, step * std::clamp(options_.max_normal_turn / turn, 0.4, 0.85));
  }
  hit.found = false;
  return hit;
}

}  // namespace fascia::smas
