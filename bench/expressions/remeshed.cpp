#include "bench/expressions/remeshed.h"

#include <cmath>
#include <map>

#include "builder/spatial/triangle.h"
#include "builder/tissue/distance.h"
#include "builder/tissue/remesh.h"
#include "formats/write.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::bench {
namespace {

namespace fs = std::filesystem;

std::vector<double> edge_lengths(const TriangleMesh& mesh, const std::string& kind) {
  const auto neighbours = tissue::vertex_neighbours(mesh);
  std::vector<double> lengths(mesh.vertices.size(), 0.001);
  for (size_t v = 0; v < lengths.size(); ++v) {
    double sum = 0.0;
    for (const int n : neighbours[v])
      sum += (mesh.vertices[static_cast<size_t>(n)] - mesh.vertices[v]).norm();
    if (!neighbours[v].empty()) lengths[v] = sum / static_cast<double>(neighbours[v].size());
  }
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next = lengths;
    for (size_t v = 0; v < lengths.size(); ++v) {
      for (const int n : neighbours[v])
        next[v] += lengths[static_cast<size_t>(n)];
      next[v] /= 1.0 + static_cast<double>(neighbours[v].size());
    }
    lengths = std::move(next);
  }
  const double half = tissue::edge_scale_for(mesh, lengths, mesh.vertex_count() / 2);
  for (size_t v = 0; v < lengths.size(); ++v)
    lengths[v] *= kind == "half" ? half : mesh.vertices[v].x() > 0.0 ? 0.7 : 1.4;
  return lengths;
}

/// Moves inner vertices about by a fifth of an edge, along the surface.
void shake(const TriangleMesh& source, const std::vector<double>& lengths, tissue::RemeshResult& copy) {
  const auto around = tissue::triangles_around(source);
  std::vector<bool> border(copy.mesh.vertices.size(), false);
  for (const auto& loop : boundary_loops(copy.mesh, connectivity(copy.mesh)))
    for (const int v : loop)
      border[static_cast<size_t>(v)] = true;
  uint32_t state = 1;
  const auto noise = [&] {
    state = 1664525U * state + 1013904223U;
    return static_cast<double>(state >> 8) / 8388608.0 - 1.0;
  };
  for (size_t v = 0; v < border.size(); ++v) {
    const Vec3 way(noise(), noise(), noise());
    if (border[v]) continue;
    SurfacePoint& place = copy.source[v];
    const double length =
        lengths[static_cast<size_t>(source.triangles[static_cast<size_t>(place.triangle)][0])];
    place = tissue::walk_to(source, around, copy.mesh.vertices[v] + 0.2 * length * way, place.triangle);
    copy.mesh.vertices[v] = position(source, place);
  }
}

/// Where each vertex of the original lies on the copy: the best place by distance and direction near the
/// copy's vertex that is nearest along the surface, so that nothing is taken from the other lip.
std::vector<CopiedTo> places_on(const tissue::RemeshResult& copy, const TriangleMesh& original) {
  std::vector<tissue::DistanceSeed> seeds;
  for (size_t k = 0; k < copy.source.size(); ++k)
    for (const int corner : original.triangles[static_cast<size_t>(copy.source[k].triangle)])
      seeds.push_back(
          {corner, (original.vertices[static_cast<size_t>(corner)] - copy.mesh.vertices[k]).norm()});
  const tissue::EdgeDistances nearest = tissue::edge_distances(original, seeds);
  const auto around = tissue::triangles_around(copy.mesh), next = tissue::vertex_neighbours(copy.mesh);
  const std::vector<Vec3> normals = vertex_normals(original);
  std::vector<CopiedTo> places(original.vertices.size());
  for (size_t v = 0; v < places.size(); ++v) {
    if (nearest.seed[v] < 0) throw Error("a part of the head was lost in its copy");
    const auto centre = static_cast<size_t>(nearest.seed[v] / 3);
    std::vector<int> triangles = around[centre];
    for (const int n : next[centre])
      triangles.insert(triangles.end(), around[static_cast<size_t>(n)].begin(),
                       around[static_cast<size_t>(n)].end());
    double best = 1e300;
    for (const int t : triangles) {
      const Triangle& c = copy.mesh.triangles[static_cast<size_t>(t)];
      const auto corner = [&](size_t k) -> const Vec3& {
        return copy.mesh.vertices[static_cast<size_t>(c[k])];
      };
      const Vec3 b = spatial::closest_barycentric(original.vertices[v], corner(0), corner(1), corner(2));
      const double cost =
          (b[0] * corner(0) + b[1] * corner(1) + b[2] * corner(2) - original.vertices[v]).squaredNorm() +
          0.3 * (corner(1) - corner(0)).squaredNorm() *
              std::max(0.0, 0.5 - triangle_normal(copy.mesh, t).dot(normals[v]));
      if (cost >= best) continue;
      best = cost;
      places[v] = {{static_cast<size_t>(c[0]), static_cast<size_t>(c[1]), static_cast<size_t>(c[2])}, b};
    }
  }
  return places;
}

}  // namespace

RemeshedCopy remeshed_copy(const formats::Scene& scene, const std::string& head, const std::string& kind) {
  if (kind != "half" && kind != "uneven") throw Error("copies are 'half' or 'uneven', not '" + kind + "'");
  formats::Drawing drawing;
  std::vector<CopiedTo> to;
  int first = 0, head_first = 0;  // of the file's vertices
  for (const formats::SceneMesh& mesh : scene.meshes) {
    TriangleMesh surface{mesh.positions, mesh.triangles};
    if (mesh.name == head) {
      std::vector<int> welded_vertex;
      const TriangleMesh welded = weld(surface, 1e-6, &welded_vertex);
      const std::vector<double> lengths = edge_lengths(welded, kind);
      tissue::RemeshResult copy = tissue::remesh(welded, lengths);
      if (kind == "uneven") shake(welded, lengths, copy);
      const std::vector<CopiedTo> places = places_on(copy, welded);
      for (const int v : welded_vertex)
        to.push_back(places[static_cast<size_t>(v)]);
      head_first = first;
      surface = std::move(copy.mesh);
    }
    first += surface.vertex_count();
    drawing.surfaces.push_back({mesh.name, std::move(surface)});
  }
  const fs::path path = fs::temp_directory_path() / ("fascia_copy_" + kind + ".obj");
  formats::write(path, drawing);
  RemeshedCopy copy{formats::read(path), 0, std::move(to)};
  fs::remove(path);
  for (const formats::SceneMesh& mesh : copy.scene.meshes) {
    if (mesh.name != head) continue;
    std::map<int, size_t> vertex;  // by its line in the file
    for (size_t v = 0; v < mesh.source_vertices.size(); ++v)
      vertex[mesh.source_vertices[v] - head_first] = v;
    for (CopiedTo& place : copy.head)
      for (size_t& v : place.vertices)
        v = vertex.at(static_cast<int>(v));
    copy.head_vertices = mesh.positions.size();
  }
  return copy;
}

std::vector<Vec3> carried_over(const RemeshedCopy& copy, const std::vector<Vec3>& values) {
  std::vector<Vec3> out;
  for (const CopiedTo& to : copy.head) {
    out.push_back(Vec3::Zero());
    for (size_t k = 0; k < 3; ++k)
      out.back() += to.weights[static_cast<int>(k)] * values[to.vertices[k]];
  }
  return out;
}

}  // namespace fascia::bench
