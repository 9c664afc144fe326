#include "builder/prepare/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "geometry/connectivity.h"
#include "geometry/flaps.h"

namespace fascia::prepare {
namespace {

/// All triangles of a scene, their corners numbered through all meshes and by place.
struct Joined {
  TriangleMesh by_place;                   ///< vertices in one place are one
  std::vector<Triangle> by_vertex;         ///< the same triangles by the file's own vertices
  std::vector<std::array<int, 2>> source;  ///< mesh, and triangle of it
  int vertex_count = 0;
};

/// Numbers of `points` such that those whose coordinates round to the same have one.
std::vector<int> number_by_place(const std::vector<Vec3>& points, int& count) {
  const double cell = std::max(1e-6 * bounds(points).size().norm(), 1e-30);
  std::vector<std::array<int64_t, 3>> keys(points.size());
  for (size_t v = 0; v < points.size(); ++v)
    for (int k = 0; k < 3; ++k)
      keys[v][static_cast<size_t>(k)] = std::llround(std::clamp(points[v][k] / cell, -9e17, 9e17));
  std::vector<int> order(points.size()), number(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int v) -> const auto& {
    return keys[static_cast<size_t>(v)];
  };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  count = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++count;
    number[static_cast<size_t>(order[i])] = count;
  }
  if (!points.empty()) ++count;
  return number;
}

Joined join(const formats::Scene& scene) {
  Joined joined;
  std::vector<Vec3> points;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto base = static_cast<int>(points.size());
    points.insert(points.end(), scene.meshes[m].positions.begin(), scene.meshes[m].positions.end());
    for (size_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const Triangle& own = scene.meshes[m].triangles[t];
      joined.by_vertex.push_back({own[0] + base, own[1] + base, own[2] + base});
      joined.source.push_back({static_cast<int>(m), static_cast<int>(t)});
    }
  }
  joined.vertex_count = static_cast<int>(points.size());
  int count = 0;
  const std::vector<int> place = number_by_place(points, count);
  joined.by_place.vertices.resize(static_cast<size_t>(count));
  for (size_t v = points.size(); v-- > 0;)
    joined.by_place.vertices[static_cast<size_t>(place[v])] = points[v];
  for (const Triangle& t : joined.by_vertex)
    joined.by_place.triangles.push_back({place[static_cast<size_t>(t[0])], place[static_cast<size_t>(t[1])],
                                         place[static_cast<size_t>(t[2])]});
  return joined;
}

/// Which triangles repeat others: the same three vertices over again, or a whole piece on another.
std::vector<bool> copies_in(const Joined& joined, const std::vector<bool>& goes_first) {
  const size_t count = joined.by_vertex.size();
  std::vector<Triangle> corners = joined.by_place.triangles;
  for (Triangle& t : corners)
    std::sort(t.begin(), t.end());
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Triangle &p = corners[static_cast<size_t>(a)], &q = corners[static_cast<size_t>(b)];
    if (p != q) return p < q;
    const bool first = goes_first[static_cast<size_t>(a)], second = goes_first[static_cast<size_t>(b)];
    return first != second ? first : a < b;
  });
  int pieces = 0;
  const std::vector<int> piece =
      components({std::vector<Vec3>(static_cast<size_t>(joined.vertex_count)), joined.by_vertex}, &pieces);
  std::vector<bool> is_copy(count, false), is_second(count, false);
  std::vector<std::array<int, 2>> tally(static_cast<size_t>(pieces),
                                        {0, 0});  // all, those that lie on others
  const auto by_vertex = [&](int t) {
    Triangle own = joined.by_vertex[static_cast<size_t>(t)];
    std::sort(own.begin(), own.end());
    return own;
  };
  for (size_t i = 0, first = 0; i < count; ++i) {
    const auto t = static_cast<size_t>(order[i]);
    if (i > 0 && corners[t] != corners[static_cast<size_t>(order[i - 1])]) first = i;
    const auto leader = static_cast<size_t>(order[first]);
    ++tally[static_cast<size_t>(piece[t])][0];
    const bool has_area = corners[t][0] != corners[t][1] && corners[t][1] != corners[t][2];
    if (first == i || !has_area) continue;
    for (size_t k = first; k < i && !is_copy[t]; ++k)
      is_copy[t] =
          piece[static_cast<size_t>(order[k])] == piece[t] && by_vertex(order[k]) == by_vertex(order[i]);
    is_second[t] = !is_copy[t] && piece[leader] != piece[t];
    tally[static_cast<size_t>(piece[t])][1] += is_second[t];
  }
  // Lips and lids that touch have a few triangles in common places; a shell has nearly all.
  constexpr double nearly_all = 0.9;
  for (size_t t = 0; t < count; ++t) {
    const auto& [all, seconds] = tally[static_cast<size_t>(piece[t])];
    if (is_second[t] && seconds >= nearly_all * all) is_copy[t] = true;
  }
  return is_copy;
}

std::string place_of(const formats::Scene& scene, const Joined& joined, const std::vector<bool>& marked) {
  const auto first = static_cast<size_t>(std::find(marked.begin(), marked.end(), true) - marked.begin());
  return "the first is triangle " + std::to_string(joined.source[first][1]) + " of '" +
         scene.meshes[static_cast<size_t>(joined.source[first][0])].name + "'";
}

std::string counted(std::ptrdiff_t count) {
  return count == 1 ? "1 triangle" : std::to_string(count) + " triangles";
}

}  // namespace

Repaired repair(const formats::Scene& scene, const std::string& skin) {
  Repaired repaired;
  Joined joined = join(scene);
  std::vector<bool> goes_first(joined.source.size());
  for (size_t t = 0; t < goes_first.size(); ++t)
    goes_first[t] = scene.meshes[static_cast<size_t>(joined.source[t][0])].name == skin;
  const std::vector<bool> is_copy = copies_in(joined, goes_first);
  TriangleMesh once;
  once.vertices = std::move(joined.by_place.vertices);
  std::vector<Triangle> original;
  std::vector<size_t> kept;
  for (size_t t = 0; t < is_copy.size(); ++t)
    if (!is_copy[t]) {
      once.triangles.push_back(joined.by_place.triangles[t]);
      original.push_back(joined.by_vertex[t]);
      kept.push_back(t);
    }
  const std::vector<bool> against = facing_against(once, original);
  std::vector<bool> is_turned(is_copy.size(), false);
  for (size_t i = 0; i < kept.size(); ++i)
    is_turned[kept[i]] = against[i];
  const auto copies = std::count(is_copy.begin(), is_copy.end(), true),
             turned = std::count(is_turned.begin(), is_turned.end(), true);
  if (copies == 0 && turned == 0) return repaired;
  if (copies > 0)
    repaired.warnings.push_back(counted(copies) + " lie on others (" + place_of(scene, joined, is_copy) +
                                "): they move with those, and count once");
  if (turned > 0)
    repaired.warnings.push_back(counted(turned) + " face against their neighbours (" +
                                place_of(scene, joined, is_turned) +
                                "): they were taken as turned over; the file's own stay as they are");
  formats::Scene& sound = repaired.scene.emplace();
  sound.path = scene.path;
  sound.kind = scene.kind;
  sound.offset = scene.offset;
  sound.meshes = scene.meshes;
  for (formats::SceneMesh& mesh : sound.meshes)
    mesh.triangles.clear();
  for (size_t t = 0; t < is_copy.size(); ++t) {
    if (is_copy[t]) continue;
    const auto [m, own] = joined.source[t];
    Triangle corners = scene.meshes[static_cast<size_t>(m)].triangles[static_cast<size_t>(own)];
    if (is_turned[t]) std::swap(corners[1], corners[2]);
    sound.meshes[static_cast<size_t>(m)].triangles.push_back(corners);
  }
  return repaired;
}

}  // namespace fascia::prepare
