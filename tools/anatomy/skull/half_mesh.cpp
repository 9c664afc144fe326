#include "tools/anatomy/skull/half_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "tools/anatomy/skull/improve.h"
#include "tools/anatomy/skull/tetrahedra.h"
#include "tools/anatomy/skull/thin_out.h"

namespace fascia::skull_maker {
namespace {

using Edge = std::pair<int, int>;

Edge edge(int a, int b) {
  return a < b ? Edge(a, b) : Edge(b, a);
}

/// A mesh under repair, with the size asked for at each vertex.
struct Work {
  TriangleMesh mesh;
  std::vector<double> sizes;

  Vec3& at(int v) { return mesh.vertices[static_cast<std::size_t>(v)]; }
  double& size(int v) { return sizes[static_cast<std::size_t>(v)]; }
  bool middle(int v) const { return mesh.vertices[static_cast<std::size_t>(v)].x() == 0; }
  int add(const Vec3& point, double length) {
    mesh.vertices.push_back(point);
    sizes.push_back(length);
    return mesh.vertex_count() - 1;
  }
};

/// Moves vertices close to the midplane onto it, so that the cut leaves no slivers.
void snap_to_midplane(const smas::ImplicitFunction& field, Work& work) {
  for (int v = 0; v < work.mesh.vertex_count(); ++v) {
    if (std::abs(work.at(v).x()) < 0.3 * work.size(v)) work.at(v) = on_surface(field, work.at(v), true);
  }
}

/// Splits every edge that crosses the midplane there.
void split_at_midplane(const smas::ImplicitFunction& field, Work& work) {
  std::map<Edge, int> cuts;
  const auto cut = [&](int a, int b) {
    const auto [found, fresh] = cuts.try_emplace(edge(a, b), -1);
    if (fresh) {
      const double t = work.at(a).x() / (work.at(a).x() - work.at(b).x());
      const Vec3 point = (1 - t) * work.at(a) + t * work.at(b);
      const double length = 0.5 * (work.size(a) + work.size(b));
      found->second = work.add(on_surface(field, point, true), length);
    }
    return found->second;
  };
  std::vector<Triangle> out;
  std::vector<Triangle> pending = work.mesh.triangles;
  while (!pending.empty()) {
    const Triangle t = pending.back();
    pending.pop_back();
    bool whole = true;
    for (int e = 0; e < 3 && whole; ++e) {
      const int a = t[static_cast<std::size_t>(e)];
      const int b = t[static_cast<std::size_t>((e + 1) % 3)];
      const int c = t[static_cast<std::size_t>((e + 2) % 3)];
      if (work.at(a).x() * work.at(b).x() < 0) {
        const int m = cut(a, b);
        pending.push_back({a, m, c});
        pending.push_back({m, b, c});
        whole = false;
      }
    }
    if (whole) out.push_back(t);
  }
  work.mesh.triangles = std::move(out);
}

/// The triangles on the left of the midplane, vertices renumbered.
void keep_left(Work& work) {
  std::vector<bool> keep;
  for (const Triangle& t : work.mesh.triangles) {
    bool left = false;
    for (const int v : t)
      left = left || work.at(v).x() > 0;
    keep.push_back(left);
  }
  std::vector<int> map;
  const TriangleMesh half = submesh(work.mesh, keep, &map);
  std::vector<double> sizes(half.vertices.size());
  for (std::size_t v = 0; v < map.size(); ++v) {
    if (map[v] >= 0) sizes[static_cast<std::size_t>(map[v])] = work.sizes[v];
  }
  work = {half, std::move(sizes)};
}

/// An edge inside the half whose two ends lie on the midplane would be shared by four triangles of the
/// whole: it gets a vertex off the midplane. Returns how many there were.
int split_bridges(const smas::ImplicitFunction& field, Work& work) {
  std::map<Edge, std::vector<int>> users;
  for (int t = 0; t < work.mesh.triangle_count(); ++t) {
    const Triangle& corners = work.mesh.triangles[static_cast<std::size_t>(t)];
    for (int e = 0; e < 3; ++e) {
      const int a = corners[static_cast<std::size_t>(e)];
      const int b = corners[static_cast<std::size_t>((e + 1) % 3)];
      if (work.middle(a) && work.middle(b)) users[edge(a, b)].push_back(t);
    }
  }
  int count = 0;
  std::vector<bool> touched(work.mesh.triangles.size(), false);
  for (const auto& [ends, triangles] : users) {
    if (triangles.size() != 2) continue;
    const auto first = static_cast<std::size_t>(triangles[0]);
    const auto second = static_cast<std::size_t>(triangles[1]);
    ++count;
    if (touched[first] || touched[second]) continue;
    touched[first] = touched[second] = true;
    Vec3 around = Vec3::Zero();
    for (const std::size_t t : {first, second}) {
      for (const int v : work.mesh.triangles[t])
        around += work.at(v) / 6.0;
    }
    const int m = work.add(on_surface(field, around, false), work.size(ends.first));
    for (const std::size_t t : {first, second}) {
      Triangle other = work.mesh.triangles[t];
      Triangle& own = work.mesh.triangles[t];
      for (int& v : own)
        v = v == ends.first ? m : v;
      for (int& v : other)
        v = v == ends.second ? m : v;
      work.mesh.triangles.push_back(other);
      touched.push_back(true);
    }
  }
  return count;
}

/// Normals of the field at the vertices; where it says nothing, those of the mesh.
std::vector<Vec3> field_normals(const smas::ImplicitFunction& field, const TriangleMesh& mesh) {
  std::vector<Vec3> normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    Vec3 gradient = Vec3::Zero();
    const double value = field(mesh.vertices[v], &gradient);
    const double length = gradient.norm();
    if (std::isfinite(value) && std::isfinite(length) && length > 1e-6) normals[v] = gradient / length;
  }
  return normals;
}

/// One Newton step of every vertex, which is next to the surface already; returns the normals met there.
std::vector<Vec3> step_to_surface(const smas::ImplicitFunction& field, TriangleMesh& mesh) {
  std::vector<Vec3> normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    Vec3 gradient = Vec3::Zero();
    Vec3& point = mesh.vertices[v];
    const double value = field(point, &gradient);
    if (point.x() == 0) gradient.x() = 0;
    const double length = gradient.norm();
    if (!std::isfinite(value) || !std::isfinite(length) || length < 1e-2) continue;
    point -= std::clamp(value / length, -1.0, 1.0) * gradient / length;
    normals[v] = gradient / length;
  }
  return normals;
}

/// Distance to the nearest rim's nearest point.
double rim_distance(const std::vector<Rim>& rims, const Vec3& point) {
  double squared = 1e12;
  for (const Rim& rim : rims) {
    for (const Vec3& at : rim)
      squared = std::min(squared, (at - point).squaredNorm());
  }
  return std::sqrt(squared);
}

/// Edge length at each vertex from how fast the normal turns around it, smoothed over the neighbours so
/// that sizes change gradually.
std::vector<double> sizes_by_curvature(const std::vector<Vec3>& normals, const TriangleMesh& mesh,
                                       const SymmetricMeshOptions& options) {
  std::vector<double> bend(mesh.vertices.size(), 0.0);
  const auto each_edge = [&](const auto& visit) {
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t e = 0; e < 3; ++e)
        visit(static_cast<std::size_t>(t[e]), static_cast<std::size_t>(t[(e + 1) % 3]));
    }
  };
  each_edge([&](std::size_t a, std::size_t b) {
    const double length = std::max((mesh.vertices[a] - mesh.vertices[b]).norm(), 0.3 * options.cell);
    const double turn = (normals[a] - normals[b]).norm();
    for (const std::size_t v : {a, b})
      bend[v] = std::max(bend[v], turn / length);
  });
  std::vector<double> sizes(mesh.vertices.size());
  std::vector<double> coarse(sizes.size(), 1.0);
  std::vector<double> by_rims(sizes.size());
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    if (options.coarseness) coarse[v] = options.coarseness(mesh.vertices[v]);
    by_rims[v] = options.rim_edge + options.growth * rim_distance(options.rims, mesh.vertices[v]);
  }
  const auto with_turn = [&](double turn) {
    for (std::size_t v = 0; v < sizes.size(); ++v) {
      const double size = coarse[v] * turn / std::max(bend[v], 1e-9);
      sizes[v] =
          std::min(std::clamp(size, coarse[v] * options.smallest_edge, options.largest_edge), by_rims[v]);
    }
    // Sizes grow gradually, so that no triangle has a long side beside a short one.
    for (int sweep = 0; sweep < 12; ++sweep) {
      each_edge([&](std::size_t a, std::size_t b) {
        const double most = options.growth * (mesh.vertices[a] - mesh.vertices[b]).norm();
        sizes[a] = std::min(sizes[a], sizes[b] + most);
        sizes[b] = std::min(sizes[b], sizes[a] + most);
      });
    }
    double count = 0;
    for (int t = 0; t < mesh.triangle_count(); ++t) {
      const double size = sizes[static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(t)][0])];
      count += triangle_area(mesh, t) / (std::sqrt(3.0) / 4 * size * size);
    }
    return 2 * count;
  };
  double low = 0.05;
  double high = 6.0;
  for (int step = 0; step < 14; ++step) {
    const double middle = 0.5 * (low + high);
    (with_turn(middle) > options.triangles ? low : high) = middle;
  }
  return sizes;
}

void improve(const smas::ImplicitFunction& field, int passes, Work& work) {
  std::vector<Vec3> normals = field_normals(field, work.mesh);
  smas::QualityOptions quality;
  quality.passes = passes;
  quality.move_boundary = true;
  quality.boundary_smoothing = 0;
  skull_maker::improve(field, quality, &work.mesh, &normals, &work.sizes);
  // The boundary lies in the midplane up to rounding and the smoothing's slip along the surface.
  const Connectivity links = connectivity(work.mesh);
  for (const auto& loop : boundary_loops(work.mesh, links)) {
    for (const int v : loop)
      work.at(v) = on_surface(field, work.at(v), true);
  }
}

}  // namespace

Vec3 on_surface(const smas::ImplicitFunction& field, Vec3 point, bool in_midplane) {
  for (int step = 0; step < 12; ++step) {
    if (in_midplane) point.x() = 0;
    Vec3 gradient;
    const double value = field(point, &gradient);
    if (in_midplane) gradient.x() = 0;
    if (!std::isfinite(value) || !gradient.allFinite() || gradient.squaredNorm() < 1e-4) break;
    // The field is about a distance; a long step would leave the sheet.
    point -= std::clamp(value / gradient.norm(), -1.0, 1.0) * gradient.normalized();
    if (std::abs(value) < 1e-9) break;
  }
  if (in_midplane) point.x() = 0;
  return point;
}

TriangleMesh mirrored(const TriangleMesh& half) {
  TriangleMesh whole = half;
  std::vector<int> twin(half.vertices.size());
  for (std::size_t v = 0; v < half.vertices.size(); ++v) {
    const Vec3& point = half.vertices[v];
    if (point.x() == 0) {
      twin[v] = static_cast<int>(v);
    } else {
      twin[v] = whole.vertex_count();
      whole.vertices.push_back({-point.x(), point.y(), point.z()});
    }
  }
  for (const Triangle& t : half.triangles) {
    whole.triangles.push_back({twin[static_cast<std::size_t>(t[0])], twin[static_cast<std::size_t>(t[2])],
                               twin[static_cast<std::size_t>(t[1])]});
  }
  return whole;
}

TriangleMesh symmetric_mesh(const smas::ImplicitFunction& field, const std::vector<Vec3>& points,
                            const SymmetricMeshOptions& options) {
  Work work;
  work.mesh = march_tetrahedra(field, points, options.reach, options.cell);
  work.sizes.assign(work.mesh.vertices.size(), options.cell);
  snap_to_midplane(field, work);
  split_at_midplane(field, work);
  keep_left(work);
  const std::vector<Vec3> normals = step_to_surface(field, work.mesh);
  work.sizes = sizes_by_curvature(normals, work.mesh, options);
  thin_out(0.9, normals, &work.mesh, &work.sizes);
  improve(field, options.passes, work);
  // Collapsing alone gets stuck among the slivers it makes: with those gone it goes on.
  for (int round = 0; round < 2; ++round) {
    thin_out(0.8, field_normals(field, work.mesh), &work.mesh, &work.sizes);
    improve(field, options.passes, work);
  }
  // A triangle that came to lie in the midplane would coincide with its mirror image.
  keep_left(work);
  for (int pass = 0; pass < 5 && split_bridges(field, work) > 0; ++pass) {
  }
  follow_creases(field, options.rims, work.sizes, options.creases, &work.mesh);
  for (const Vec3& point : work.mesh.vertices) {
    if (!point.allFinite()) throw Error("a vertex left the surface: the figures are too sparse somewhere");
  }
  TriangleMesh whole = mirrored(work.mesh);
  const Connectivity links = connectivity(whole);
  if (links.irregular_edges > 0 || !boundary_loops(whole, links).empty()) {
    throw Error("the halves do not meet: " + std::to_string(links.irregular_edges) + " irregular edges, " +
                std::to_string(boundary_loops(whole, links).size()) + " openings");
  }
  return whole;
}

}  // namespace fascia::skull_maker
