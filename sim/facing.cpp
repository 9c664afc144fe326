#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/closest_point.h"
#include "sim/contact.h"

// The closest point of the facing lip or lid for each node.

namespace fascia::sim {
namespace {

Vec3 area_of(const std::array<uint32_t, 3>& t, const Vec3* x) {
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
}

}  // namespace

Vec3 Contacts::fan_area(const Side& side, uint32_t fan, const Vec3* x) {
  Vec3 area = Vec3::Zero();
  for (const uint32_t t : side.fans[fan])
    area += area_of(side.triangles[t], x);
  return area;
}

FacingSearch Contacts::make_search() const {
  FacingSearch search;
  size_t triangles = 0, nodes = 0;
  for (const Side& side : sides_) {
    triangles = std::max(triangles, side.triangles.size());
    nodes = std::max(nodes, side.fans.size());
  }
  const size_t bundles = (triangles + search.bundle - 1) / search.bundle;
  search.centres.reserve(bundles);
  search.radii.reserve(bundles);
  search.squared.resize(bundles);
  search.middles.reserve(triangles);
  search.reaches.reserve(triangles);
  search.normals.reserve(nodes);
  return search;
}

void Contacts::look_at_side(size_t index, const Vec3* x, FacingSearch& search) const {
  const Side& side = sides_[index];
  search.side = index;
  search.centres.clear();
  search.radii.clear();
  search.normals.clear();
  search.middles.clear();
  search.reaches.clear();
  for (const auto& t : side.triangles) {
    search.middles.emplace_back((x[t[0]] + x[t[1]] + x[t[2]]) / 3.0);
    double squared = 0.0;
    for (const uint32_t corner : t)
      squared = std::max(squared, (x[corner] - search.middles.back()).squaredNorm());
    search.reaches.push_back(std::sqrt(squared));
  }
  for (size_t first = 0; first < side.triangles.size(); first += search.bundle) {
    const std::span bundle =
        std::span(side.triangles).subspan(first, std::min(search.bundle, side.triangles.size() - first));
    Vec3 centre = Vec3::Zero();
    for (const auto& t : bundle)
      centre += x[t[0]] / static_cast<double>(bundle.size());
    double squared = 0.0;
    for (const auto& t : bundle)
      for (const uint32_t corner : t)
        squared = std::max(squared, (x[corner] - centre).squaredNorm());
    search.centres.push_back(centre);
    search.radii.push_back(std::sqrt(squared));
  }
  for (uint32_t fan = 0; fan < side.fans.size(); ++fan)
    search.normals.push_back(fan_area(side, fan, x).stableNormalized());
}

void Contacts::pair_of(size_t contact, const Vec3* x, FacingSearch& search, FacingPair& pair) const {
  pair.node = facing_nodes_[contact];
  pair.corners.fill(FacingPair::none);
  pair.margin = facing_margins_[contact];
  const uint8_t side = facing_sides_[contact];
  const Side& other = sides_[side ^ 1U];
  const FacingRange& range = side < 2 ? options_.lips : options_.lids;
  if (facing_fans_[contact] == FacingPair::none || other.triangles.empty()) return;
  if (search.side != (side ^ 1U)) look_at_side(side ^ 1U, x, search);
  Vec3 facing = fan_area(sides_[side], facing_fans_[contact], x);
  if (facing.squaredNorm() < 1e-30) return;
  facing.normalize();
  const Vec3& p = x[pair.node];
  double best = range.before * range.before, within = range.before;
  const auto look_at = [&](size_t i) {
    const auto& t = other.triangles[i];
    const double reach = within + search.reaches[i];
    if ((search.middles[i] - p).squaredNorm() >= reach * reach) return;
    const auto turns_away = [&](uint32_t corner) { return search.normals[corner].dot(facing) > 0.2; };
    if (std::all_of(other.corners[i].begin(), other.corners[i].end(), turns_away))
      return;  // so does any place between
    const Vec3 weights = closest_weights(p, x[t[0]], x[t[1]], x[t[2]]);
    const Vec3 away = p - (weights[0] * x[t[0]] + weights[1] * x[t[1]] + weights[2] * x[t[2]]);
    const double distance = away.squaredNorm();
    if (distance >= best || area_of(t, x).squaredNorm() < 1e-30) return;
    // Between the corners' normals: where a surface turns about an edge, as a lid does, its triangles' own
    // would lead past it.
    Vec3 normal = Vec3::Zero();
    for (size_t k = 0; k < 3; ++k)
      normal += weights[static_cast<int>(k)] * search.normals[other.corners[i][k]];
    const double size = normal.norm();
    if (size < 0.1 || normal.dot(facing) > 0.2 * size) return;  // its back, or a surface that runs along
    normal /= size;
    const double along = normal.dot(away);
    if (along < -range.behind || (away - along * normal).squaredNorm() > range.beside * range.beside) return;
    best = distance;
    within = std::sqrt(best);
    pair.corners = t;
    pair.weights = weights;
    pair.normal = normal;
  };
  const auto look_through = [&](size_t bundle) {
    const size_t first = bundle * search.bundle,
                 end = std::min(first + search.bundle, other.triangles.size());
    for (size_t i = first; i < end; ++i)
      look_at(i);
  };
  // Search the cluster with the nearest centre first; its result culls most others.
  size_t nearest = 0;
  for (size_t b = 0; b < search.centres.size(); ++b) {
    search.squared[b] = (search.centres[b] - p).squaredNorm();
    if (search.squared[b] < search.squared[nearest]) nearest = b;
  }
  look_through(nearest);
  for (size_t b = 0; b < search.centres.size(); ++b) {
    const double reach = search.radii[b] + within;
    if (b == nearest || search.squared[b] >= reach * reach) continue;
    look_through(b);
  }
}

double Contacts::find_facing(const Vec3* x, std::span<FacingPair> pairs, FacingSearch& search, size_t first,
                             size_t every) const {
  double change = 0.0;
  search.side = sides_.size();  // invalidate the cached side
  for (size_t i = first; i < facing_nodes_.size() && i < pairs.size(); i += every) {
    const FacingPair before = pairs[i];
    pair_of(i, x, search, pairs[i]);
    const auto lack = [x](const FacingPair& pair) {
      return pair.is_found() ? std::max(0.0, pair.margin - pair.gap(x)) : 0.0;
    };
    change = std::max(change, std::abs(lack(pairs[i]) - lack(before)));
  }
  return change;
}

}  // namespace fascia::sim
