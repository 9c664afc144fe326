#include "builder/skull/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia::skull {
namespace {

constexpr double unknown = std::numeric_limits<double>::max();

// Spreads the push of violating vertices over their surroundings, so that no spikes are left.
void diffuse(const std::vector<std::vector<int>>& neighbours, const std::vector<bool>& fixed,
             std::vector<Vec3>& push) {
  constexpr int passes = 4;
  std::vector<int> around;  // within `passes` rings of what is pushed
  std::vector<bool> seen = fixed;
  for (size_t v = 0; v < push.size(); ++v)
    if (fixed[v]) around.push_back(static_cast<int>(v));
  for (size_t begin = 0, ring = 0; ring < passes; ++ring) {
    const size_t end = around.size();
    for (; begin < end; ++begin)
      for (int n : neighbours[around[begin]])
        if (!seen[n]) {
          seen[n] = true;
          around.push_back(n);
        }
  }
  std::vector<Vec3> next = push;
  for (int pass = 0; pass < passes; ++pass) {
    for (int v : around) {
      if (fixed[v] || neighbours[v].empty()) continue;
      Vec3 sum = Vec3::Zero();
      for (int n : neighbours[v])
        sum += push[n];
      next[v] = 0.8 * sum / static_cast<double>(neighbours[v].size());
    }
    for (int v : around)
      push[v] = next[v];
  }
}

}  // namespace

std::vector<std::vector<int>> vertex_neighbours(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> out(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      out[t[k]].push_back(t[(k + 1) % 3]);
      out[t[k]].push_back(t[(k + 2) % 3]);
    }
  for (auto& row : out) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return out;
}

std::vector<SkinOver> skin_over(const Generic& generic, std::span<const Vec3> points) {
  std::vector<SkinOver> out(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    double sum = 0, total = 0;
    for (const GenericLandmark& landmark : generic.landmarks) {
      if (!landmark.has_bone) continue;
      const double squared = (landmark.bone - points[i]).squaredNorm();
      const double weight = 1 / (squared * squared + 1e-12);
      sum += weight * landmark.depth;
      total += weight;
    }
    out[i].depth = total > 0 ? sum / total : 0.005;
  }
  if (generic.skin.empty()) return out;
  const spatial::SurfaceQuery skin(generic.skin);
  for (size_t i = 0; i < points.size(); ++i) {
    const spatial::ClosestPoint closest = skin.closest(points[i]);
    out[i].depth = std::min(out[i].depth, closest.distance);
    // Smooth, so that a tie between the sides of the midplane does not matter.
    out[i].outward = skin.smooth_normal(closest.surface);
    out[i].skin = closest.position;
  }
  return out;
}

std::vector<double> clearances(std::span<const SkinOver> over, const FitOptions& options) {
  std::vector<double> out;
  const double floor = options.clearance_floor * std::min(1.0, options.tissue_scale);
  for (const SkinOver& skin : over)
    out.push_back(std::max(floor, options.clearance_share * options.tissue_scale * skin.depth));
  return out;
}

ClearanceCheck::ClearanceCheck(const Exterior& skin, std::vector<double> clearance, std::vector<Vec3> outward)
    : skin_(&skin), clearance_(std::move(clearance)), outward_(std::move(outward)) {}

std::vector<Violation> ClearanceCheck::operator()(std::span<const Vec3> vertices) {
  return (*this)(vertices, 0, static_cast<int>(vertices.size()));
}

std::vector<Violation> ClearanceCheck::operator()(std::span<const Vec3> vertices, int first, int end) {
  constexpr double margin = 1e-9;
  constexpr double facing = 0.25;  // cosine
  if (measured_.empty()) {
    measured_at_.assign(vertices.begin(), vertices.end());
    measured_.assign(vertices.size(), unknown);
  }
  std::vector<Violation> out;
  for (size_t i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
    const Vec3& p = vertices[i];
    double range = std::numeric_limits<double>::infinity();
    if (measured_[i] != unknown) {
      const double moved = (p - measured_at_[i]).norm();
      if (measured_[i] + moved + clearance_[i] <= 0) continue;
      range = std::abs(measured_[i]) + moved + margin;
    } else if (i > 0 && measured_[i - 1] != unknown) {
      range = std::abs(measured_[i - 1]) + (p - measured_at_[i - 1]).norm() + margin;
    }
    const spatial::ClosestPoint closest = skin_->closest(p, range);
    measured_at_[i] = p;
    measured_[i] = closest.signed_distance;
    const double missing = closest.signed_distance + clearance_[i];
    if (missing <= 0) continue;
    if (!outward_[i].isZero() && closest.pseudonormal.dot(outward_[i]) < facing) continue;
    const bool outside = closest.signed_distance >= 0;
    Vec3 inward = closest.position - p;
    if (!outside) inward = -inward;
    // On the surface itself only its normal tells the way.
    inward = closest.distance > margin ? Vec3(inward.normalized()) : Vec3(-closest.pseudonormal);
    out.push_back({static_cast<int>(i), missing, inward, outside});
  }
  return out;
}

int push_inside(ClearanceCheck& check, const std::vector<std::vector<int>>& neighbours,
                std::vector<Vec3>& vertices, int rounds, double& largest) {
  const std::vector<Vec3> before = vertices;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Violation> found = check(vertices);
    if (found.empty()) break;
    std::vector<Vec3> push(vertices.size(), Vec3::Zero());
    std::vector<bool> fixed(vertices.size(), false);
    for (const Violation& violation : found) {
      push[violation.vertex] = (1.02 * violation.missing + 1e-6) * violation.inward;
      fixed[violation.vertex] = true;
    }
    // The last rounds move single vertices only: spreading could bring others out on the far side.
    if (round < rounds - rounds / 3) diffuse(neighbours, fixed, push);
    for (size_t v = 0; v < push.size(); ++v)
      vertices[v] += push[v];
  }
  int moved = 0;
  for (size_t v = 0; v < before.size(); ++v) {
    const double distance = (vertices[v] - before[v]).norm();
    if (distance > 1e-7) ++moved;
    largest = std::max(largest, distance);
  }
  return moved;
}

}  // namespace fascia::skull
