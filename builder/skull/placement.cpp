#include "builder/skull/placement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/alignment.h"

namespace fascia::skull {
namespace {

constexpr double evidence_sd = 0.0005;  // m, of clearance constraints

std::array<const TriangleMesh*, 4> meshes_of(const Generic& generic) {
  return {&generic.cranium, &generic.mandible, &generic.teeth_upper, &generic.teeth_lower};
}

}  // namespace

Bones gather(const Generic& generic) {
  Bones out;
  TriangleMesh whole;
  for (size_t k = 0; k < 4; ++k) {
    const TriangleMesh& mesh = *meshes_of(generic)[k];
    const int base = whole.vertex_count();
    whole.vertices.insert(whole.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const Triangle& t : mesh.triangles)
      whole.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    out.first[k + 1] = whole.vertex_count();
  }
  out.over = skin_over(generic, whole.vertices);
  out.neighbours = vertex_neighbours(whole);
  out.generic = std::move(whole.vertices);
  return out;
}

VertexMap::VertexMap(const Bones& bones, const std::vector<BoneMap::Patch>& pattern) {
  for (size_t v = 0; v < bones.generic.size(); ++v)
    for (size_t k = 0; k < pattern.size(); ++k)
      if (const double strength = pattern[k].strength(bones.generic[v]); strength > 0)
        pulls_.push_back({static_cast<int>(v), static_cast<int>(k), strength});
}

std::vector<Vec3> VertexMap::operator()(const Bones& bones, const BoneMap& map,
                                        std::span<const Vec3> warped) const {
  std::vector<Vec3> out(warped.begin(), warped.end());
  for (size_t begin = 0, end = 0; begin < pulls_.size(); begin = end) {
    const auto v = static_cast<size_t>(pulls_[begin].vertex);
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (end = begin; end < pulls_.size() && pulls_[end].vertex == pulls_[begin].vertex; ++end) {
      sum +=
          pulls_[end].strength *
          transform_point(map.patches()[static_cast<size_t>(pulls_[end].patch)].similarity, bones.generic[v]);
      total += pulls_[end].strength;
    }
    out[v] = total > 1 ? Vec3(sum / total) : Vec3(sum + (1 - total) * warped[v]);
  }
  return out;
}

std::vector<double> clearances(const Bones& bones, const std::vector<BoneMap::Patch>& patches,
                               const FitOptions& options) {
  std::vector<double> out = clearances(std::span(bones.over), options);
  const double floor = options.clearance_floor * std::min(1.0, options.tissue_scale);
  for (size_t v = 0; v < out.size(); ++v)
    for (const BoneMap::Patch& patch : patches)
      if (patch.anchors.size() == 1) out[v] -= patch.strength(bones.generic[v]) * (out[v] - floor);
  std::fill(out.begin() + bones.first[2], out.end(), floor);
  return out;
}

std::vector<Vec3> outward_directions(const Bones& bones, const Mat4& pose) {
  const Mat3 turn = pose.topLeftCorner<3, 3>() / std::cbrt(pose.topLeftCorner<3, 3>().determinant());
  std::vector<Vec3> out;
  for (const SkinOver& over : bones.over)
    out.push_back(turn * over.outward);
  return out;
}

bool add_clearance_observations(ClearanceCheck& check, const Bones& bones, std::span<const Vec3> placed,
                                std::vector<Observation>& observations, size_t first) {
  constexpr double spacing = 0.010, worth = 0.0003;
  constexpr size_t most = 80;
  std::vector<Violation> found = check(placed);
  std::erase_if(found, [&](const Violation& violation) { return bones.is_tooth(violation.vertex); });
  std::stable_sort(found.begin(), found.end(),
                   [](const Violation& a, const Violation& b) { return a.missing > b.missing; });
  // Equals, such as the two sides of a symmetric head, are taken together or not at all: only clearly worse
  // violations keep off one that is taken.
  constexpr double equal = 1e-6;  // m
  std::vector<std::pair<Vec3, double>> taken;
  const size_t known = observations.size();
  for (const Violation& violation : found) {
    if (violation.missing < worth) break;
    if (taken.size() >= most && violation.missing + equal < taken.back().second) break;
    const Vec3& from = bones.generic[violation.vertex];
    // On the midplane the nearest skin may be a tie between left and right; the neighbours of both sides
    // decide.
    if (std::abs(from.x()) < 1e-4) continue;
    const auto keeps_off = [&](const std::pair<Vec3, double>& other) {
      return other.second > violation.missing + equal && (other.first - from).norm() < spacing;
    };
    if (std::any_of(taken.begin(), taken.end(), keeps_off)) continue;
    taken.emplace_back(from, violation.missing);
    Observation observation;
    observation.from = from;
    observation.to = placed[violation.vertex] + (1.1 * violation.missing) * violation.inward;
    observation.sd = evidence_sd;
    const auto begin = observations.begin() + static_cast<long>(first),
               end = observations.begin() + static_cast<long>(known);
    const auto same = std::find_if(begin, end, [&](const Observation& other) { return other.from == from; });
    if (same != end)
      *same = observation;
    else
      observations.push_back(observation);
  }
  return !taken.empty();
}

void retract_teeth(ClearanceCheck& check, const Bones& bones, const VertexMap& vertex_map,
                   std::span<const Vec3> warped, double limit, BoneMap& map, std::vector<Vec3>& placed) {
  if (!bones.has_teeth()) return;
  double stepped = 0;
  for (int round = 0; round < 4 && stepped < limit; ++round) {
    Vec3 way = Vec3::Zero();
    double missing = 0;
    for (const Violation& violation : check(placed, bones.first[2], bones.first[4])) {
      way += violation.missing * violation.inward;
      missing = std::max(missing, violation.missing);
    }
    if (!(way.norm() > 0)) return;
    const double step = std::min(missing, limit - stepped);
    stepped += step;
    for (BoneMap::Patch& patch : map.patches())
      if (patch.anchors.size() > 1) patch.similarity.topRightCorner<3, 1>() += step * way.normalized();
    placed = vertex_map(bones, map, warped);
  }
}

void place_meshes(ClearanceCheck& check, const Generic& generic, const Bones& bones,
                  std::vector<Vec3> vertices, FitResult& out) {
  constexpr int rounds = 24;
  out.corrected_max = 0;
  out.bone_outside_skin = out.bone_within_clearance = 0;
  out.corrected_vertices = push_inside(check, bones.neighbours, vertices, rounds, out.corrected_max);
  for (const Violation& violation : check(vertices))
    ++(violation.outside ? out.bone_outside_skin : out.bone_within_clearance);
  const std::array<TriangleMesh*, 4> results{&out.cranium, &out.mandible, &out.teeth_upper, &out.teeth_lower};
  for (size_t k = 0; k < 4; ++k)
    *results[k] = {{vertices.begin() + bones.first[k], vertices.begin() + bones.first[k + 1]},
                   meshes_of(generic)[k]->triangles};
}

}  // namespace fascia::skull
