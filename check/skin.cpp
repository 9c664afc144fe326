#include "check/skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace fascia::check {
namespace {

/// The first of the vertices on open edges that lies in the place of each.
std::vector<int> joined_along_edges(const TriangleMesh& mesh) {
  std::vector<int> joined(mesh.vertices.size());
  std::vector<bool> is_open(mesh.vertices.size(), false);
  const Connectivity links = connectivity(mesh);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0)
        for (const size_t k : {e, (e + 1) % 3})
          is_open[static_cast<size_t>(mesh.triangles[t][k])] = true;
  constexpr double step = 1e-6;  // metres
  std::map<std::tuple<long, long, long>, int> first;
  for (size_t v = 0; v < joined.size(); ++v) {
    joined[v] = static_cast<int>(v);
    if (!is_open[v]) continue;
    const Vec3 p = mesh.vertices[v] / step;
    joined[v] =
        first.try_emplace({std::lround(p[0]), std::lround(p[1]), std::lround(p[2])}, joined[v]).first->second;
  }
  return joined;
}

}  // namespace

Shape rest_shape(const Head& head) {
  Shape shape;
  for (const Part& part : head.parts)
    shape.push_back(part.mesh.vertices);
  return shape;
}

Skin::Skin(const Head& head, const Vec3& centre, double reach) {
  TriangleMesh all;
  std::vector<std::pair<size_t, size_t>> source;
  for (size_t p = 0; p < head.parts.size(); ++p) {
    if (head.parts[p].name != "skin") continue;
    const TriangleMesh& mesh = head.parts[p].mesh;
    std::vector<int> map(mesh.vertices.size(), -1);
    for (size_t v = 0; v < map.size(); ++v) {
      if ((mesh.vertices[v] - centre).norm() > reach) continue;
      map[v] = all.vertex_count();
      all.vertices.push_back(mesh.vertices[v]);
      source.emplace_back(p, v);
    }
    for (const Triangle& t : mesh.triangles) {
      const Triangle now = {map[static_cast<size_t>(t[0])], map[static_cast<size_t>(t[1])],
                            map[static_cast<size_t>(t[2])]};
      if (now[0] >= 0 && now[1] >= 0 && now[2] >= 0) all.triangles.push_back(now);
    }
  }
  const std::vector<int> joined = joined_along_edges(all);
  std::vector<int> index(joined.size(), -1);
  for (const Triangle& t : all.triangles) {
    Triangle now;
    for (size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<size_t>(joined[static_cast<size_t>(t[k])]);
      if (index[v] < 0) {
        index[v] = rest_.vertex_count();
        rest_.vertices.push_back(all.vertices[v]);
        source_.push_back(source[v]);
        const std::vector<bool>& still = head.parts[source[v].first].is_still;
        is_still_.push_back(!still.empty() && still[source[v].second]);
      }
      now[k] = index[v];
    }
    if (now[0] != now[1] && now[1] != now[2] && now[2] != now[0]) rest_.triangles.push_back(now);
  }
  links_ = connectivity(rest_);
}

std::vector<Vec3> Skin::vertices(const Shape& shape) const {
  std::vector<Vec3> out;
  out.reserve(source_.size());
  for (const auto& [part, vertex] : source_)
    out.push_back(shape[part][vertex]);
  return out;
}

TriangleMesh Patch::mesh(const std::vector<Vec3>& skin) const {
  TriangleMesh out;
  out.triangles = triangles;
  out.vertices.reserve(vertices.size());
  for (const int v : vertices)
    out.vertices.push_back(skin[static_cast<size_t>(v)]);
  return out;
}

namespace {

template <class Keep>
Patch patch_where(const TriangleMesh& skin, Keep keep) {
  Patch out;
  std::vector<int> map(skin.vertices.size(), -1);
  for (size_t i = 0; i < skin.triangles.size(); ++i) {
    const Triangle& t = skin.triangles[i];
    if (!keep(t)) continue;
    out.source.push_back(static_cast<int>(i));
    Triangle now;
    for (size_t k = 0; k < 3; ++k) {
      int& v = map[static_cast<size_t>(t[k])];
      if (v < 0) {
        v = static_cast<int>(out.vertices.size());
        out.vertices.push_back(t[k]);
      }
      now[k] = v;
    }
    out.triangles.push_back(now);
  }
  return out;
}

}  // namespace

Patch patch(const TriangleMesh& skin, const std::vector<bool>& keep) {
  return patch_where(skin, [&](const Triangle& t) {
    return keep[static_cast<size_t>(t[0])] && keep[static_cast<size_t>(t[1])] &&
           keep[static_cast<size_t>(t[2])];
  });
}

Patch patch_about(const TriangleMesh& skin, const Vec3& centre, double radius) {
  std::vector<bool> near(skin.vertices.size());
  for (size_t v = 0; v < near.size(); ++v)
    near[v] = (skin.vertices[v] - centre).norm() < radius;
  return patch_where(skin, [&](const Triangle& t) {
    return near[static_cast<size_t>(t[0])] || near[static_cast<size_t>(t[1])] ||
           near[static_cast<size_t>(t[2])];
  });
}

Patch moving_patch_about(const Skin& skin, const Vec3& centre, double radius) {
  const std::vector<Vec3>& vertices = skin.rest().vertices;
  const auto is_near = [&](int v) { return (vertices[static_cast<size_t>(v)] - centre).norm() < radius; };
  const auto moves = [&](int v) { return !skin.is_still()[static_cast<size_t>(v)]; };
  return patch_where(skin.rest(), [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), is_near) && std::any_of(t.begin(), t.end(), moves);
  });
}

Vec3 place(const TriangleMesh& mesh, const std::vector<Vec3>& vertices, const SurfacePoint& point) {
  Vec3 p = Vec3::Zero();
  for (size_t k = 0; k < 3; ++k)
    p += point.barycentric[static_cast<int>(k)] *
         vertices[static_cast<size_t>(mesh.triangles[static_cast<size_t>(point.triangle)][k])];
  return p;
}

}  // namespace fascia::check
