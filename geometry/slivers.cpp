#include "geometry/slivers.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "geometry/connectivity.h"
#include "geometry/disjoint_sets.h"

namespace fascia {

namespace {

/// A triangle's side lengths, and how high it stands over the longest.
struct Shape {
  size_t shortest = 0, longest = 0;  ///< sides: side k joins corners k and k+1
  double shortest_length = 0.0, height = 0.0;
};

Shape shape_of(const TriangleMesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[static_cast<size_t>(triangle)];
  double lengths[3];
  Shape shape;
  for (size_t k = 0; k < 3; ++k) {
    lengths[k] =
        (mesh.vertices[static_cast<size_t>(t[(k + 1) % 3])] - mesh.vertices[static_cast<size_t>(t[k])])
            .norm();
    if (lengths[k] < lengths[shape.shortest]) shape.shortest = k;
    if (lengths[k] > lengths[shape.longest]) shape.longest = k;
  }
  shape.shortest_length = lengths[shape.shortest];
  const double longest = lengths[shape.longest];
  shape.height = longest > 0.0 ? 2.0 * triangle_area(mesh, triangle) / longest : 0.0;
  return shape;
}

bool has_repeated_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Collapses the short sides of needles. Returns whether there were any.
bool collapse_needles(TriangleMesh& mesh, double height, std::vector<int>& vertex_of) {
  DisjointSets joined(mesh.vertices.size());
  bool any = false;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Shape shape = shape_of(mesh, t);
    if (shape.height >= height || shape.shortest_length >= height) continue;
    const Triangle& corners = mesh.triangles[static_cast<size_t>(t)];
    joined.join(corners[shape.shortest], corners[(shape.shortest + 1) % 3]);
    any = true;
  }
  if (!any) return false;
  for (Triangle& t : mesh.triangles)
    for (int& v : t)
      v = joined.of(v);
  std::erase_if(mesh.triangles, has_repeated_corner);
  for (int& v : vertex_of)
    v = joined.of(v);
  return true;
}

/// Flips the long sides of caps, each with the triangle across; those at a border are left out. Returns
/// whether there were any.
bool flip_caps(TriangleMesh& mesh, double height) {
  std::vector<int> caps;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    if (shape_of(mesh, t).height < height) caps.push_back(t);
  if (caps.empty()) return false;
  const Connectivity links = connectivity(mesh);
  std::vector<bool> is_changed(mesh.triangles.size(), false), is_gone(mesh.triangles.size(), false);
  for (const int t : caps) {
    const auto at = static_cast<size_t>(t);
    if (is_changed[at]) continue;
    const size_t side = shape_of(mesh, t).longest;
    const int across = links.neighbours[at][side];
    is_changed[at] = true;
    if (across < 0) {
      is_gone[at] = true;
      continue;
    }
    const auto other = static_cast<size_t>(across);
    if (is_changed[other]) continue;  // with the next pass
    const Triangle cap = mesh.triangles[at];
    const int a = cap[side], b = cap[(side + 1) % 3], tip = cap[(side + 2) % 3];
    int far = -1;
    for (const int v : mesh.triangles[other])
      if (v != a && v != b) far = v;
    if (far < 0 || far == tip) {
      is_gone[at] = true;
      continue;
    }
    mesh.triangles[at] = {a, far, tip};
    mesh.triangles[other] = {far, b, tip};
    is_changed[other] = true;
  }
  size_t kept = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!is_gone[t]) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  return true;
}

}  // namespace

TriangleMesh without_slivers(const TriangleMesh& mesh, double height, std::vector<int>* vertex_map) {
  TriangleMesh mended = mesh;
  std::vector<int> vertex_of(mesh.vertices.size());
  std::iota(vertex_of.begin(), vertex_of.end(), 0);
  bool any = false;
  for (int pass = 0; pass < 6; ++pass) {
    const bool collapsed = collapse_needles(mended, height, vertex_of), flipped = flip_caps(mended, height);
    if (!collapsed && !flipped) break;
    any = true;
  }
  if (!any) {
    if (vertex_map) *vertex_map = vertex_of;
    return mesh;
  }
  std::vector<bool> keep(mended.triangles.size());
  for (size_t t = 0; t < keep.size(); ++t)
    keep[t] = shape_of(mended, static_cast<int>(t)).height >= height;
  std::vector<int> compact;
  TriangleMesh out = submesh(mended, keep, &compact);
  if (vertex_map) {
    vertex_map->resize(vertex_of.size());
    for (size_t v = 0; v < vertex_of.size(); ++v)
      (*vertex_map)[v] = compact[static_cast<size_t>(vertex_of[v])];
  }
  return out;
}

}  // namespace fascia
