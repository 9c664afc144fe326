#include "builder/smas/order_layers.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/smas/relax.h"
#include "builder/smas/surface_edits.h"
#include "builder/smas/triangle_shape.h"
#include "builder/smas/trim.h"
#include "geometry/connectivity.h"

namespace fascia::smas {

namespace {

constexpr double kFeatureTurn = 1.2;                // radians; edges are not flipped across larger turns
constexpr double kMendBelow = 28.0 * M_PI / 180.0;  // triangles with smaller angles are mended
constexpr double kDropBelow = 25.5 * M_PI / 180.0;  // those that stay smaller, at the border, are dropped

// Between skin and bone in a place where there is less room than twice the clearance: the middle of it.
Vec3 middle(const Layers& layers, const Vec3& point) {
  const spatial::ClosestPoint hit = layers.skin.closest(point);
  const Vec3 outward = layers.skin.smooth_normal(hit.surface);
  const double to_bone = std::min(layers.bones.along(hit.position, -outward, layers.range),
                                  layers.bones.distance(hit.position, layers.range));
  return std::isfinite(to_bone) && to_bone > 0.0 ? Vec3(hit.position - 0.5 * to_bone * outward) : point;
}

// Flips edges, and moves vertices of poor triangles along and off the surface, as long as they stay between
// the layers.
void mend(const Layers& layers, MarchingResult* surface, std::vector<Lie>* lies) {
  SurfaceMesh work(surface->mesh, surface->normals, surface->sizes);
  const auto stays = [&](int v, const Vec3& point) {
    const Lie there = layers.lie(point);
    // Where there is little room it must not become less.
    const Lie& here = (*lies)[v];
    if (!layers.clear(there) && !(there.between() && std::min(there.under_skin, there.over_bone) >=
                                                         std::min(here.under_skin, here.over_bone)))
      return false;
    (*lies)[v] = there;
    return true;
  };
  for (int round = 0; round < 6; ++round) {
    flip_edges(kFeatureTurn, &work);
    const bool moved = relax_worst({true, 0.3}, kMendBelow, stays, &work);
    // What neither helps has a vertex too many.
    std::vector<Lie> kept;
    for (int v : collapse_slivers(kDropBelow, &work))
      kept.push_back((*lies)[v]);
    const bool merged = kept.size() < lies->size();
    *lies = std::move(kept);
    if (!moved && !merged) break;
  }
  flip_edges(kFeatureTurn, &work);
  surface->mesh.vertices = std::move(work.points);
  surface->mesh.triangles = std::move(work.triangles);
  surface->normals = std::move(work.normals);
  surface->sizes = std::move(work.sizes);
}

// Drops triangles at the boundary that lie folded over, outside the layers or are slivers. Returns whether
// there were any.
bool drop_poor_border(MarchingResult* surface, std::vector<Lie>* lies) {
  const TriangleMesh& mesh = surface->mesh;
  const Connectivity links = connectivity(mesh);
  std::vector<bool> border(mesh.vertices.size(), false), keep(mesh.triangles.size(), true);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0)
        border[mesh.triangles[t][e]] = border[mesh.triangles[t][(e + 1) % 3]] = true;
  bool any = false;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (!border[a] && !border[b] && !border[c]) continue;
    const Vec3 facing = surface->normals[a] + surface->normals[b] + surface->normals[c];
    keep[t] =
        smallest_angle_cosine(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) < std::cos(kDropBelow) &&
        triangle_normal(mesh, t).dot(facing) > 0.0 && (*lies)[a].between() && (*lies)[b].between() &&
        (*lies)[c].between();
    any = any || !keep[t];
  }
  if (!any) return false;
  std::vector<double> index(mesh.vertices.size());
  for (size_t v = 0; v < index.size(); ++v)
    index[v] = static_cast<double>(v);
  keep_triangles(keep, &surface->mesh, &surface->normals, &surface->sizes, &index);
  keep_main_part(&surface->mesh, &surface->normals, &surface->sizes, &index);
  std::vector<Lie> kept;
  for (double v : index)
    kept.push_back((*lies)[static_cast<size_t>(v)]);
  *lies = std::move(kept);
  return true;
}

}  // namespace

Lie Layers::lie(const Vec3& point) const {
  Lie lie;
  lie.skin = skin.closest(point);
  // Past a rim, where the skin turns in, the sign of its nearest patch says nothing.
  const bool inside =
      lie.skin.signed_distance < 0.0 && outward(lie.skin.surface).dot(lie.skin.position - point) > 0.0;
  lie.under_skin = inside ? lie.skin.distance : -lie.skin.distance;
  lie.over_bone = bones.distance(point);
  return lie;
}

Lie Layers::move_between(Vec3* point) const {
  Lie at = lie(*point);
  if (clear(at)) return at;
  for (int round = 0; round < 12 && !clear(at); ++round) {
    const Vec3 up = skin.smooth_normal(at.skin.surface);
    if (at.under_skin < clearance && at.over_bone < clearance) break;
    if (at.under_skin < clearance) {
      const double room = std::isfinite(at.over_bone) ? 0.5 * (at.over_bone - at.under_skin) : 1.0;
      *point -= up * std::min(1.1 * (clearance - at.under_skin), std::max(room, 0.0));
    } else {
      const double room = 0.5 * (at.under_skin - at.over_bone);
      *point += up * std::min(1.1 * (clearance - at.over_bone), std::max(room, 0.0));
    }
    at = lie(*point);
  }
  if (at.between()) return at;
  const Vec3 centre = middle(*this, *point);
  const Lie there = lie(centre);
  if (std::min(there.under_skin, there.over_bone) <= std::min(at.under_skin, at.over_bone)) return at;
  *point = centre;
  return there;
}

std::vector<Lie> order_layers(const Layers& layers, MarchingResult* surface) {
  std::vector<Lie> lies;
  lies.reserve(surface->mesh.vertices.size());
  for (Vec3& point : surface->mesh.vertices)
    lies.push_back(layers.move_between(&point));
  for (int round = 0; round < 10; ++round) {
    mend(layers, surface, &lies);
    if (!drop_poor_border(surface, &lies)) break;
  }
  return lies;
}

}  // namespace fascia::smas
