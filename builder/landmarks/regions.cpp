#include "builder/landmarks/regions.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"

namespace fascia::landmarks {

namespace {

/// For each region the one it may touch but not turn into: the other lip, the other lid of the eye; -1 for
/// none.
std::vector<int> opposite_regions(const std::vector<std::string>& names) {
  std::vector<int> opposite(names.size(), -1);
  for (size_t r = 0; r < names.size(); ++r) {
    std::string other = names[r];
    if (const size_t at = other.find("upper"); at != std::string::npos)
      other.replace(at, 5, "lower");
    else if (const size_t below = other.find("lower"); below != std::string::npos)
      other.replace(below, 5, "upper");
    else
      continue;
    for (size_t o = 0; o < names.size(); ++o)
      if (names[o] == other) opposite[r] = static_cast<int>(o);
  }
  return opposite;
}

/// Upper and lower hang together over the skin's own edges only round the corners: a vertex most of whose
/// neighbours are of the opposite region was told wrongly across touching margins.
void vote_along_edges(const TriangleMesh& skin, FaceRegions& regions) {
  const std::vector<int> opposite = opposite_regions(regions.names);
  for (int round = 0; round < 6; ++round) {
    std::vector<int> same(skin.vertices.size(), 0), other(skin.vertices.size(), 0);
    for (const Triangle& t : skin.triangles)
      for (size_t k = 0; k < 3; ++k)
        for (size_t step : {1u, 2u}) {
          const int mine = regions.of_vertex[static_cast<size_t>(t[k])],
                    theirs = regions.of_vertex[static_cast<size_t>(t[(k + step) % 3])];
          if (mine < 0 || theirs < 0) continue;
          if (theirs == mine) ++same[static_cast<size_t>(t[k])];
          if (theirs == opposite[static_cast<size_t>(mine)]) ++other[static_cast<size_t>(t[k])];
        }
    bool has_changed = false;
    for (size_t v = 0; v < same.size(); ++v)
      if (other[v] > same[v]) {
        regions.of_vertex[v] = opposite[static_cast<size_t>(regions.of_vertex[v])];
        has_changed = true;
      }
    if (!has_changed) break;
  }
}

}  // namespace

FaceRegions face_regions(const GenericFace& face, const Registration& fit, const TriangleMesh& skin) {
  FaceRegions regions;
  regions.names = face.region_names;
  TriangleMesh bent = fit.warp(face.skin);
  for (Vec3& p : bent.vertices)
    p = fit.placement(p);
  // Each triangle is stood for by its middle: those of lips and lids are 1 to 2 mm wide.
  Samples middles;
  for (int t = 0; t < bent.triangle_count(); ++t)
    middles.add(position(bent, {t, Vec3::Constant(1.0 / 3.0)}), triangle_normal(bent, t));
  const Neighbours tree(middles);
  const std::vector<Vec3> normals = vertex_normals(skin);
  const double reach = 0.03 * fit.placement.scale, turn = 0.008 * fit.placement.scale;
  std::vector<size_t> near;
  std::vector<double> squared;
  for (size_t v = 0; v < skin.vertices.size(); ++v) {
    tree.nearest(skin.vertices[v], 24, near, squared);
    double best = reach * reach;
    int region = -1;
    for (size_t k = 0; k < near.size(); ++k) {
      const double turned = turn * (1.0 - normals[v].dot(middles.normals[near[k]]));
      const double cost = squared[k] + turned * turned;
      if (cost >= best) continue;
      best = cost;
      region = face.region_of_triangle[near[k]];
    }
    regions.of_vertex.push_back(region);
  }
  vote_along_edges(skin, regions);
  return regions;
}

}  // namespace fascia::landmarks
