#include "check/seam.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "check/lids.h"

namespace fascia::check {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Lengths of the shortest ways along edges from the vertices of the triangle nearest to `from`, over
/// vertices that `within` allows.
std::vector<double> ways(const Skin& skin, const Vec3& from, const std::vector<bool>& within) {
  const TriangleMesh& mesh = skin.rest();
  std::vector<double> length(mesh.vertices.size(), infinite);
  size_t start = 0;
  double least = infinite;
  for (size_t v = 0; v < within.size(); ++v) {
    if (!within[v]) continue;
    const double distance = (mesh.vertices[v] - from).norm();
    if (distance >= least) continue;
    least = distance;
    start = v;
  }
  if (least == infinite) return length;
  using Entry = std::pair<double, size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  length[start] = least;
  queue.push({least, start});
  const Connectivity& links = skin.links();
  while (!queue.empty()) {
    const auto [way, v] = queue.top();
    queue.pop();
    if (way > length[v]) continue;
    for (int k = links.vertex_offsets[v]; k < links.vertex_offsets[v + 1]; ++k)
      for (const int corner :
           mesh.triangles[static_cast<size_t>(links.vertex_triangles[static_cast<size_t>(k)])]) {
        const auto w = static_cast<size_t>(corner);
        const double longer = way + (mesh.vertices[w] - mesh.vertices[v]).norm();
        if (!within[w] || longer >= length[w]) continue;
        length[w] = longer;
        queue.push({longer, w});
      }
  }
  return length;
}

uint8_t side_at(const TriangleMesh& mesh, const std::vector<uint8_t>& sides, const SurfacePoint& point) {
  double upper = 0.0, lower = 0.0;
  for (size_t k = 0; k < 3; ++k) {
    const uint8_t side = sides[static_cast<size_t>(mesh.triangles[static_cast<size_t>(point.triangle)][k])];
    if (side == Seam::upper) upper += point.barycentric[static_cast<int>(k)];
    if (side == Seam::lower) lower += point.barycentric[static_cast<int>(k)];
  }
  return upper + lower < 0.5 ? Seam::none : upper >= lower ? Seam::upper : Seam::lower;
}

}  // namespace

std::vector<uint8_t> sides_of_opening(const Skin& skin, const Vec3& upper, const Vec3& lower,
                                      const Vec3& centre, double reach, bool with_still) {
  const std::vector<Vec3>& vertices = skin.rest().vertices;
  std::vector<bool> within(vertices.size());
  for (size_t v = 0; v < within.size(); ++v)
    within[v] = (vertices[v] - centre).norm() < reach && (with_still || !skin.is_still()[v]);
  const std::vector<double> to_upper = ways(skin, upper, within), to_lower = ways(skin, lower, within);
  std::vector<uint8_t> sides(vertices.size(), Seam::none);
  for (size_t v = 0; v < sides.size(); ++v)
    if (std::min(to_upper[v], to_lower[v]) < infinite)
      sides[v] = to_upper[v] <= to_lower[v] ? Seam::upper : Seam::lower;
  return sides;
}

bool find_edges(const spatial::SurfaceQuery& query, const TriangleMesh& mesh,
                const std::vector<uint8_t>& sides, const Look& look, SurfacePoint& upper,
                SurfacePoint& lower) {
  struct Seen {
    SurfacePoint point;
    double distance = infinite;
    uint8_t side = Seam::none;
  };
  const size_t count = look.origins.size();
  std::vector<Seen> seen(count);
  int lowers_above = 0, uppers_below = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto hit = query.first_hit(look.origins[i], look.directions[i], look.reach);
    if (!hit) continue;
    seen[i] = {hit->surface, hit->distance, side_at(mesh, sides, hit->surface)};
    uppers_below += seen[i].side == Seam::upper;
  }
  // The cut that leaves the fewest places on the wrong side of it.
  size_t cut = 0;
  int fewest = uppers_below + 1;
  for (size_t i = 0; i < count; ++i) {
    uppers_below -= seen[i].side == Seam::upper;
    lowers_above += seen[i].side == Seam::lower;
    // After ray i; of ties the first, so that what is neither stays below and is passed over from there.
    if (lowers_above + uppers_below >= fewest) continue;
    fewest = lowers_above + uppers_below;
    cut = i + 1;
  }
  // From the cut outward to where the surface jumps, for in between one looks into the opening.
  const auto apart = [&](size_t a, size_t b) {
    return std::abs(seen[a].distance - seen[b].distance) > look.jump;
  };
  size_t up = cut, down = cut;  // up: one after the last upper place
  // Where one looks past everything it is the opening for certain; folds of the lid only jump.
  const auto is_hole = [&](size_t i) { return seen[i].distance == infinite; };
  bool any_above = false, any_below = false;
  for (size_t i = 0; i + 1 < cut; ++i)
    any_above = any_above || (seen[i].side == Seam::upper && is_hole(i + 1));
  for (size_t i = count; i-- > cut + 1;)
    any_below = any_below || (seen[i].side == Seam::lower && is_hole(i - 1));
  for (size_t i = 0; i + 1 < cut; ++i)
    if (seen[i].side == Seam::upper && (is_hole(i + 1) || (!any_above && apart(i, i + 1)))) {
      // A jump that leads back to nearer places is a fold, not the opening.
      if (seen[i + 1].distance < seen[i].distance) continue;
      up = i + 1;
      break;
    }
  for (size_t i = count; i-- > cut + 1;)
    if (seen[i].side == Seam::lower && (is_hole(i - 1) || (!any_below && apart(i, i - 1)))) {
      if (seen[i - 1].distance < seen[i].distance) continue;
      down = i;
      break;
    }
  while (up > 0 && seen[up - 1].side != Seam::upper)
    --up;
  while (down < count && seen[down].side != Seam::lower)
    ++down;
  if (up == 0 || down == count) return false;
  upper = seen[up - 1].point;
  lower = seen[down].point;
  return true;
}

Seam mouth_seam(const Skin& skin, const Landmarks& landmarks, double size) {
  Seam seam;
  for (const char* name : {"labiale_superius", "labiale_inferius", "cheilion_left", "cheilion_right"})
    if (!landmarks.count(name)) return seam;
  const Vec3 top = landmarks.at("labiale_superius"), bottom = landmarks.at("labiale_inferius"),
             left = landmarks.at("cheilion_left"), right = landmarks.at("cheilion_right");
  const Vec3 centre = 0.25 * (top + bottom + left + right);
  const double width = (left - right).norm();
  seam.sides = sides_of_opening(skin, top, bottom, centre, width);
  const Patch lips = patch_about(skin.rest(), centre, 0.8 * width);
  if (lips.triangles.empty()) return seam;
  const TriangleMesh mesh = lips.mesh(skin.rest().vertices);
  std::vector<uint8_t> sides;
  for (const int v : lips.vertices)
    sides.push_back(seam.sides[static_cast<size_t>(v)]);
  const spatial::SurfaceQuery query(mesh);
  const double front = bounds(mesh.vertices).upper.z() + 0.01, margin = 0.002 * size, step = 1e-4 * size;
  constexpr int stations = 39;
  for (int s = 1; s <= stations; ++s) {
    const double t = static_cast<double>(s) / (stations + 1);
    const Vec3 on = right + t * (left - right);
    Look look;
    look.reach = 0.01 + 0.6 * width + (front - centre.z());
    look.jump = 0.002 * size;
    const double high = std::max(top.y(), on.y()) + margin, low = std::min(bottom.y(), on.y()) - margin;
    for (double y = high; y > low; y -= step) {
      look.origins.emplace_back(on.x(), y, front);
      look.directions.emplace_back(0.0, 0.0, -1.0);
    }
    SurfacePoint upper, lower;
    if (!find_edges(query, mesh, sides, look, upper, lower)) continue;
    seam.stations.push_back(t);
    seam.upper_edge.push_back(upper);
    seam.lower_edge.push_back(lower);
  }
  for (std::vector<SurfacePoint>* edge : {&seam.upper_edge, &seam.lower_edge})
    for (SurfacePoint& point : *edge)
      point.triangle = lips.source[static_cast<size_t>(point.triangle)];
  return seam;
}

namespace {

Seam lid_seam(const Skin& skin, const Landmarks& landmarks, const Eye& eye, bool left, bool with_still) {
  Seam seam;
  const std::string side = left ? "_left" : "_right";
  for (const char* name : {"palpebrale_superius", "palpebrale_inferius", "exocanthion", "endocanthion"})
    if (!landmarks.count(name + side)) return seam;
  const Vec3 top = landmarks.at("palpebrale_superius" + side),
             bottom = landmarks.at("palpebrale_inferius" + side);
  const LidFrame frame(landmarks.at("exocanthion" + side), landmarks.at("endocanthion" + side), eye, left);
  const double width = (frame.at_left - frame.at_right).norm();
  // Where lids are shut their margins may have been placed on one of them, above or below where they meet.
  const Vec3 aside(0.0, with_still ? 0.4 * width : 0.0, 0.0);
  seam.sides = sides_of_opening(skin, top + aside, bottom - aside, 0.5 * (frame.at_left + frame.at_right),
                                0.9 * width, with_still);
  const Patch lids = with_still ? patch_about(skin.rest(), eye.centre, 1.7 * eye.radius)
                                : moving_patch_about(skin, eye.centre, 1.7 * eye.radius);
  if (lids.triangles.empty()) return seam;
  const TriangleMesh mesh = lids.mesh(skin.rest().vertices);
  std::vector<uint8_t> sides;
  for (const int v : lids.vertices)
    sides.push_back(seam.sides[static_cast<size_t>(v)]);
  const spatial::SurfaceQuery query(mesh);
  constexpr int stations = 9;
  for (int s = 1; s <= stations; ++s) {
    const double t = static_cast<double>(s) / (stations + 1);
    const double beyond = with_still ? 0.5 : 0.25;
    const double high = frame.elevation(top, t) + beyond, low = frame.elevation(bottom, t) - beyond;
    const double step = 1e-4 * width / 0.03 / eye.radius;
    Look look;
    look.reach = 0.75 * eye.radius;
    look.jump = 0.15 * eye.radius;
    for (double angle = high; angle > low; angle -= step) {
      const Vec3 out = frame.direction(t, angle);
      look.origins.push_back(eye.centre + 1.55 * eye.radius * out);
      look.directions.push_back(-out);
    }
    SurfacePoint upper, lower;
    if (!find_edges(query, mesh, sides, look, upper, lower)) continue;
    seam.stations.push_back(t);
    for (SurfacePoint* point : {&upper, &lower})
      point->triangle = lids.source[static_cast<size_t>(point->triangle)];
    seam.upper_edge.push_back(upper);
    seam.lower_edge.push_back(lower);
  }
  return seam;
}

/// Whether the edges of `seam` lie on each other all along and are yet far apart along the surface, as those
/// of shut lids are. Where the eye is one surface with its lids it is no way from one to the other.
bool are_shut(const Skin& skin, const Seam& seam, double width) {
  constexpr size_t least_stations = 6;
  constexpr double most_gap = 0.03, one_gap = 0.06, least_way = 0.15;  // of the width
  if (seam.stations.size() < least_stations) return false;
  const TriangleMesh& mesh = skin.rest();
  constexpr double canthus = 0.15;  // nearer to one it is hard to tell which lid a place is of
  // Stations may look into a fold beside the edges, or on the lashes' line of a scan.
  constexpr int most_wider = 2;
  int wider = 0;
  for (size_t s = 0; s < seam.stations.size(); ++s) {
    if (seam.stations[s] < canthus || seam.stations[s] > 1.0 - canthus) continue;
    const double gap = (position(mesh, seam.upper_edge[s]) - position(mesh, seam.lower_edge[s])).norm();
    if (gap > one_gap * width) return false;
    wider += gap > most_gap * width ? 1 : 0;
  }
  if (wider > most_wider) return false;
  const size_t middle = seam.stations.size() / 2;
  const auto corners = [&](const SurfacePoint& p) { return mesh.triangles[static_cast<size_t>(p.triangle)]; };
  const Triangle upper = corners(seam.upper_edge[middle]), lower = corners(seam.lower_edge[middle]);
  const Vec3 from = position(mesh, seam.upper_edge[middle]);
  std::vector<bool> within(mesh.vertices.size());
  for (size_t v = 0; v < within.size(); ++v)
    within[v] = seam.sides[v] != Seam::none;
  // The path starts at the triangle of the upper edge, even if others are as near.
  for (const int v : lower)
    within[static_cast<size_t>(v)] =
        within[static_cast<size_t>(v)] && std::find(upper.begin(), upper.end(), v) == upper.end();
  for (const int v : lower)
    if (!within[static_cast<size_t>(v)]) return false;
  const std::vector<double> way = ways(skin, mesh.vertices[static_cast<size_t>(upper[0])], within);
  return std::all_of(lower.begin(), lower.end(), [&](int v) {
    return way[static_cast<size_t>(v)] - (mesh.vertices[static_cast<size_t>(upper[0])] - from).norm() >
           least_way * width;
  });
}

}  // namespace

Seam lid_seam(const Skin& skin, const Landmarks& landmarks, const Eye& eye, bool left) {
  const std::string side = left ? "_left" : "_right";
  const auto outer = landmarks.find("exocanthion" + side), inner = landmarks.find("endocanthion" + side);
  if (outer == landmarks.end() || inner == landmarks.end()) return {};
  Seam whole = lid_seam(skin, landmarks, eye, left, true);
  whole.are_shut = are_shut(skin, whole, (outer->second - inner->second).norm());
  return whole.are_shut ? whole : lid_seam(skin, landmarks, eye, left, false);
}

}  // namespace fascia::check
