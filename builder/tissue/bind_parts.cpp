#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/bind.h"
#include "builder/tissue/distance.h"
#include "geometry/connectivity.h"
#include "geometry/smoothstep.h"

namespace fascia::tissue {
namespace {

void put(rig::Binding& binding, size_t vertex, const Follow& follow, double share = 1.0) {
  for (size_t k = 0; k < Follow::influences; ++k) {
    binding.nodes[vertex * Follow::influences + k] = follow.nodes[k];
    binding.weights[vertex * Follow::influences + k] = follow.weights[k] * static_cast<float>(share);
  }
  binding.jaw_weights[vertex] = follow.jaw * static_cast<float>(share);
}

rig::Binding empty_binding(const PartMesh& part) {
  rig::Binding binding;
  const size_t n = part.vertices.size();
  binding.part = part.part;
  binding.vertex_count = static_cast<uint32_t>(n);
  binding.influences = Follow::influences;
  binding.nodes.assign(n * Follow::influences, 0);
  binding.weights.assign(n * Follow::influences, 0.0F);
  binding.jaw_weights.assign(n, 0.0F);
  binding.eye.assign(n, 0);
  return binding;
}

/// A place on the skin: what a lash, a brow or a hair stands on.
struct SkinPlace {
  std::array<int, 3> vertices{-1, -1, -1};  ///< of the skin
  Vec3 weights = Vec3::Zero();
  double distance = 0.0;
};

/// Finds the nearest place on a part of the skin, all of it or the region alone.
class SkinQuery {
 public:
  /// `skin_vertex`: of each vertex of `mesh`, the skin's; empty when they are the same.
  explicit SkinQuery(const TriangleMesh& mesh, std::vector<int> skin_vertex = {})
      : mesh_(mesh), skin_vertex_(std::move(skin_vertex)), query_(mesh) {}
  SkinPlace at(const Vec3& p) const {
    const spatial::ClosestPoint hit = query_.closest(p);
    SkinPlace place;
    place.weights = hit.surface.barycentric;
    place.distance = hit.distance;
    for (size_t k = 0; k < 3; ++k) {
      const int v = mesh_.triangles[static_cast<size_t>(hit.surface.triangle)][k];
      place.vertices[k] = skin_vertex_.empty() ? v : skin_vertex_[static_cast<size_t>(v)];
    }
    return place;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<int> skin_vertex_;
  spatial::SurfaceQuery query_;
};

/// The skin's motion, to be asked for anywhere on it.
struct MovingSkin {
  const std::vector<Follow>& vertices;
  const std::vector<Vec3>& columns;  // their places at rest
  Follow at(const SkinPlace& place) const {
    Row row;
    for (size_t k = 0; k < 3; ++k) {
      const Follow& corner = vertices[static_cast<size_t>(place.vertices[k])];
      const double share = place.weights[static_cast<int>(k)];
      for (size_t i = 0; i < Follow::influences; ++i)
        if (corner.weights[i] > 0.0F && share > 0.0)
          row[corner.nodes[i]] += share * static_cast<double>(corner.weights[i]);
      if (corner.jaw > 0.0F) row[jaw_entry] += share * static_cast<double>(corner.jaw);
    }
    return pack(row, columns);
  }
};

/// The connected pieces of a part: lash cards, strands, or all in one.
struct Pieces {
  std::vector<int> vertex_map;  // #part vertices, made with the mesh
  TriangleMesh mesh;            // welded
  std::vector<int> piece;       // #welded vertices, -1 of a loose one
  std::vector<double> size;     // #pieces, metres, across their boxes
  explicit Pieces(const PartMesh& part) : mesh(weld({part.vertices, part.triangles}, 1e-6, &vertex_map)) {
    int count = 0;
    const std::vector<int> piece_of_triangle = components(mesh, &count);
    piece.assign(mesh.vertices.size(), -1);
    std::vector<Bounds> box(static_cast<size_t>(count));
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const int v : mesh.triangles[t]) {
        piece[static_cast<size_t>(v)] = piece_of_triangle[t];
        Bounds& bounds = box[static_cast<size_t>(piece_of_triangle[t])];
        bounds.lower = bounds.lower.cwiseMin(mesh.vertices[static_cast<size_t>(v)]);
        bounds.upper = bounds.upper.cwiseMax(mesh.vertices[static_cast<size_t>(v)]);
      }
    for (const Bounds& bounds : box)
      size.push_back(bounds.size().norm());
  }
};

/// Lashes and brows: each vertex follows the skin at the root that is nearest along its own piece, a small
/// piece at one root. Roots are what lies at most `root_depth` (metres) farther from the skin than the
/// nearest of the piece.
void follow_roots(const PartMesh& part, const SkinQuery& outer, const MovingSkin& skin, double root_depth,
                  rig::Binding& binding) {
  constexpr double small = 0.014, reach = 0.02;  // metres
  const Pieces pieces(part);
  std::vector<SkinPlace> place;
  std::vector<double> nearest(pieces.size.size(), 1e9);
  for (size_t v = 0; v < pieces.mesh.vertices.size(); ++v) {
    place.push_back(outer.at(pieces.mesh.vertices[v]));
    if (pieces.piece[v] < 0) continue;
    double& least = nearest[static_cast<size_t>(pieces.piece[v])];
    least = std::min(least, place[v].distance);
  }
  std::vector<DistanceSeed> roots;
  std::vector<bool> has_root(nearest.size(), false);
  for (size_t v = 0; v < place.size(); ++v) {
    if (pieces.piece[v] < 0) continue;
    const auto p = static_cast<size_t>(pieces.piece[v]);
    const bool is_small = pieces.size[p] < small;
    if (place[v].distance > nearest[p] + (is_small ? 0.0 : root_depth) || (is_small && has_root[p])) continue;
    has_root[p] = true;
    roots.push_back({static_cast<int>(v)});
  }
  const EdgeDistances way = edge_distances(pieces.mesh, roots);
  for (size_t v = 0; v < part.vertices.size(); ++v) {
    const auto w = static_cast<size_t>(pieces.vertex_map[v]);
    const int root = way.seed[w];
    const SkinPlace& at =
        root >= 0 ? place[static_cast<size_t>(roots[static_cast<size_t>(root)].vertex)] : place[w];
    if (at.distance < reach) put(binding, v, skin.at(at));
  }
}

/// Hair: a strand follows the skin at its root, so that a moustache moves with the lip and hair of the scalp
/// does not move. Larger parts, a cap or a whole beard, follow the skin they lie on, less with distance.
void follow_scalp(const PartMesh& part, const SkinQuery& whole, const MovingSkin& skin,
                  rig::Binding& binding) {
  constexpr double strand = 0.06, near = 0.008, far = 0.02;  // metres
  const Pieces pieces(part);
  std::vector<SkinPlace> place;
  std::vector<size_t> root(pieces.size.size(), pieces.mesh.vertices.size());
  for (size_t v = 0; v < pieces.mesh.vertices.size(); ++v) {
    place.push_back(whole.at(pieces.mesh.vertices[v]));
    if (pieces.piece[v] < 0) continue;
    size_t& best = root[static_cast<size_t>(pieces.piece[v])];
    if (best == pieces.mesh.vertices.size() || place[v].distance < place[best].distance) best = v;
  }
  for (size_t v = 0; v < part.vertices.size(); ++v) {
    const auto w = static_cast<size_t>(pieces.vertex_map[v]);
    if (pieces.piece[w] < 0) continue;
    const auto p = static_cast<size_t>(pieces.piece[w]);
    const bool is_strand = pieces.size[p] < strand;
    const SkinPlace& at = place[is_strand ? root[p] : w];
    const double share = std::clamp((far - at.distance) / (far - near), 0.0, 1.0);
    if (share > 0.0) put(binding, v, skin.at(at), share);
  }
}

/// Gums, tongue and palate in one piece: each point follows the row of teeth that is nearer along the
/// surface, so that the tongue follows the lower gum. Without teeth the height of the mouth decides.
std::vector<float> between_the_jaws(const PartMesh& part, const TissueInputs& inputs) {
  std::vector<int> vertex_map;
  const TriangleMesh welded = weld({part.vertices, part.triangles}, 1e-6, &vertex_map);
  std::array<std::vector<DistanceSeed>, 2> seeds;
  for (const PartMesh& teeth : inputs.parts) {
    if (teeth.part != "teeth_upper" && teeth.part != "teeth_lower") continue;
    if (teeth.triangles.empty()) continue;  // a copy, of which none counts
    const spatial::SurfaceQuery query(TriangleMesh{teeth.vertices, teeth.triangles});
    for (int v = 0; v < welded.vertex_count(); ++v)
      if (query.closest(welded.vertices[static_cast<size_t>(v)], 0.002).found())
        seeds[teeth.part == "teeth_lower"].push_back({v});
  }
  std::vector<float> weights(part.vertices.size());
  if (seeds[0].empty() || seeds[1].empty()) {
    const double height = inputs.landmarks.at("stomion").y();
    for (size_t v = 0; v < weights.size(); ++v)
      weights[v] = static_cast<float>(std::clamp(0.5 - (part.vertices[v].y() - height) / 0.012, 0.0, 1.0));
    return weights;
  }
  const EdgeDistances upper = edge_distances(welded, seeds[0]), lower = edge_distances(welded, seeds[1]);
  for (size_t v = 0; v < weights.size(); ++v) {
    const auto w = static_cast<size_t>(vertex_map[v]);
    const double to_upper = upper.distance[w], to_lower = lower.distance[w];
    const double share = std::isinf(to_upper)   ? 1.0
                         : std::isinf(to_lower) ? 0.0
                                                : to_upper / std::max(to_upper + to_lower, 1e-9);
    weights[v] = static_cast<float>(smoothstep(0.25, 0.75, share));
  }
  return weights;
}

}  // namespace

std::vector<rig::Binding> bind_parts(const TissueInputs& inputs, const FaceRegion& region,
                                     const Columns& columns, const std::vector<Follow>& skin) {
  std::vector<rig::Binding> bindings;
  const SkinQuery outer(region.mesh, region.skin_vertex);
  std::optional<SkinQuery> whole;
  const MovingSkin moving{skin, columns.mesh.vertices};
  for (const PartMesh& part : inputs.parts) {
    rig::Binding binding = empty_binding(part);
    if (part.part == "skin") {
      const bool is_known = part.skin_vertices.size() == part.vertices.size();
      for (size_t v = 0; v < part.vertices.size(); ++v)
        if (is_known && part.skin_vertices[v] >= 0) {
          put(binding, v, skin[static_cast<size_t>(part.skin_vertices[v])]);
        } else {
          if (!whole) whole.emplace(inputs.skin);
          put(binding, v, moving.at(whole->at(part.vertices[v])));
        }
    } else if (part.part == "teeth_lower" || part.part == "gums_lower" || part.part == "tongue") {
      std::fill(binding.jaw_weights.begin(), binding.jaw_weights.end(), 1.0F);
    } else if (part.part == "eye_left" || part.part == "eye_right") {
      std::fill(binding.eye.begin(), binding.eye.end(),
                static_cast<uint8_t>(part.part == "eye_left" ? 1 : 2));
    } else if (part.part == "lashes" || part.part == "brows") {
      follow_roots(part, outer, moving, part.part == "lashes" ? 0.0008 : 0.003, binding);  // brows lie flat
    } else if (part.part == "hair") {
      if (!whole) whole.emplace(inputs.skin);
      follow_scalp(part, *whole, moving, binding);
    } else if (part.part == "mouth_interior") {
      binding.jaw_weights = between_the_jaws(part, inputs);
    } else if (part.part == "other" || part.part == "eye_surround") {
      // Tear film, caruncle, stubble: parts that lie on the face follow it; others do not move.
      for (size_t v = 0; v < part.vertices.size(); ++v) {
        const SkinPlace place = outer.at(part.vertices[v]);
        const double share = std::clamp((0.004 - place.distance) / 0.003, 0.0, 1.0);
        if (share > 0.0) put(binding, v, moving.at(place), share);
      }
    }
    bindings.push_back(std::move(binding));
  }
  return bindings;
}

}  // namespace fascia::tissue
