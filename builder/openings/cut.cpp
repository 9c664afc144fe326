#include "builder/openings/cut.h"

#include <algorithm>
#include <cmath>

namespace fascia::openings {

namespace {

/// Splits a triangle along a piece of the path between two of its edges, or from a corner to an edge.
std::vector<Triangle> split(const Triangle& k, const Cut& cut, size_t from, size_t to) {
  const auto& nodes = cut.path.nodes;
  const auto on_edge = [&](const PathNode& node, int a, int b) {
    return !node.is_vertex() && std::min(a, b) == node.a && std::max(a, b) == node.b;
  };
  // The triangle's outline with the path's nodes in it, as pairs (vertex, node); -1: not on the path.
  std::vector<std::pair<int, int>> outline;
  for (size_t e = 0; e < 3; ++e) {
    const int a = k[e], b = k[(e + 1) % 3];
    int at = -1;
    for (const size_t n : {from, to})
      if (nodes[n].is_vertex() && nodes[n].a == a) at = static_cast<int>(n);
    outline.emplace_back(a, at);
    for (const size_t n : {from, to})
      if (on_edge(nodes[n], a, b)) outline.emplace_back(-1, static_cast<int>(n));
  }
  std::vector<size_t> ends;
  for (size_t i = 0; i < outline.size(); ++i)
    if (outline[i].second >= 0) ends.push_back(i);
  std::vector<Triangle> pieces;
  for (const bool second : {false, true}) {
    const size_t begin = ends[second ? 1 : 0], end = ends[second ? 0 : 1];
    std::vector<size_t> loop;
    for (size_t i = begin;; i = (i + 1) % outline.size()) {
      loop.push_back(i);
      if (i == end) break;
    }
    double side = 0.0;
    for (const size_t i : loop)
      if (outline[i].second < 0) side += cut.path.above[static_cast<size_t>(outline[i].first)];
    std::vector<int> corners;
    for (const size_t i : loop) {
      const auto [vertex, node] = outline[i];
      corners.push_back(node < 0 ? vertex : (side >= 0.0 ? cut.upper : cut.lower)[static_cast<size_t>(node)]);
    }
    for (size_t i = 1; i + 1 < corners.size(); ++i)
      pieces.push_back({corners[0], corners[i], corners[i + 1]});
  }
  return pieces;
}

/// Below the line, by the corners that do not lie on it.
bool is_below(const Triangle& k, const std::vector<double>& above) {
  double sum = 0.0;
  for (const int v : k)
    sum += above[static_cast<size_t>(v)];
  return sum < 0.0;
}

/// Splits the triangles beside the path's ends that an end on an edge reaches, so that none has a vertex in
/// the middle of its edge.
void close_end(const TriangleMesh& mesh, const Connectivity& links, size_t end, Cut& cut) {
  const PathNode& node = cut.path.nodes[end];
  if (node.is_vertex()) return;
  const auto first = static_cast<size_t>(links.vertex_offsets[static_cast<size_t>(node.a)]),
             last = static_cast<size_t>(links.vertex_offsets[static_cast<size_t>(node.a) + 1]);
  for (size_t i = first; i < last; ++i) {
    const int t = links.vertex_triangles[i];
    const Triangle& k = mesh.triangles[static_cast<size_t>(t)];
    if (cut.triangles.count(t)) continue;
    for (size_t e = 0; e < 3; ++e) {
      const int a = k[e], b = k[(e + 1) % 3], c = k[(e + 2) % 3];
      if (std::min(a, b) == node.a && std::max(a, b) == node.b)
        cut.triangles[t] = {{a, cut.upper[end], c}, {cut.upper[end], b, c}};
    }
  }
}

/// Whether the sides' edges have another surface on them, as lips have that were welded to each other.
bool has_surface_behind(const TriangleMesh& mesh, const Connectivity& links, const Path& path) {
  int shared = 0, along_edges = 0;
  for (size_t i = 0; i + 1 < path.nodes.size(); ++i) {
    if (path.triangles[i] >= 0) continue;
    ++along_edges;
    const int a = path.nodes[i].a, b = path.nodes[i + 1].a;
    int count = 0;
    for (int j = links.vertex_offsets[static_cast<size_t>(a)];
         j < links.vertex_offsets[static_cast<size_t>(a) + 1]; ++j) {
      const Triangle& k = mesh.triangles[static_cast<size_t>(links.vertex_triangles[static_cast<size_t>(j)])];
      count += std::find(k.begin(), k.end(), b) != k.end() ? 1 : 0;
    }
    shared += count >= 4 ? 1 : 0;
  }
  return 2 * shared > static_cast<int>(path.nodes.size()) && 4 * shared > 3 * along_edges;
}

}  // namespace

Cut cut_along(const TriangleMesh& mesh, const Connectivity& links, Path path) {
  Cut cut;
  cut.path = std::move(path);
  cut.vertex_count = mesh.vertex_count();
  const size_t count = cut.path.nodes.size();
  for (size_t i = 0; i < count; ++i) {
    const PathNode& node = cut.path.nodes[i];
    const int own = cut.vertex_count + 2 * static_cast<int>(i);
    const bool is_corner = i == 0 || i + 1 == count;
    cut.upper.push_back(node.is_vertex() ? node.a : own);
    cut.lower.push_back(is_corner ? cut.upper.back() : own + 1);
  }
  for (size_t i = 0; i + 1 < count; ++i)
    if (const int t = cut.path.triangles[i]; t >= 0)
      cut.triangles[t] = split(mesh.triangles[static_cast<size_t>(t)], cut, i, i + 1);
  // Triangles that touch the path at a vertex and lie below it take the lower copy.
  for (size_t i = 1; i + 1 < count; ++i) {
    const PathNode& node = cut.path.nodes[i];
    if (!node.is_vertex()) continue;
    for (int j = links.vertex_offsets[static_cast<size_t>(node.a)];
         j < links.vertex_offsets[static_cast<size_t>(node.a) + 1]; ++j) {
      const int t = links.vertex_triangles[static_cast<size_t>(j)];
      const Triangle& k = mesh.triangles[static_cast<size_t>(t)];
      const bool is_split =
          std::find(cut.path.triangles.begin(), cut.path.triangles.end(), t) != cut.path.triangles.end();
      if (is_split || !is_below(k, cut.path.above)) continue;
      auto& pieces = cut.triangles.try_emplace(t, std::vector<Triangle>{k}).first->second;
      for (Triangle& piece : pieces)
        std::replace(piece.begin(), piece.end(), node.a, cut.lower[i]);
    }
  }
  close_end(mesh, links, 0, cut);
  close_end(mesh, links, count - 1, cut);
  cut.is_lined = has_surface_behind(mesh, links, cut.path);
  return cut;
}

}  // namespace fascia::openings
