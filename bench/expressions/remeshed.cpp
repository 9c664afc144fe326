#include "bench/expressions/remeshed.h"

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
    for (const int n : neighbours[v]) sum += (mesh.vertices[static_cast<size_t>(n)] - mesh.vertices[v]).norm();
    if (!neighbours[v].empty()) lengths[v] = sum / static_cast<double>(neighbours[v].size());
  }
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next = lengths;
    for (size_t v = 0; v < lengths.size(); ++v) {
      for (const int n : neighbours[v]) next[v] += lengths[static_cast<size_t>(n)];
      next[v] /= 1.0 + static_cast<double>(neighbours[v].size());
    }
    lengths = std::move(next);
  }
  for (size_t v = 0; v < lengths.size(); ++v)
    lengths[v] *= kind == "half" ? std::sqrt(2.0) : mesh.vertices[v].x() > 0.0 ? 0.7 : 1.4;
  return lengths;
}

/// Moves inner vertices about by a fifth of an edge, along the surface.
void shake(const TriangleMesh& source, const std::vector<double>& lengths, tissue::RemeshResult& copy) {
  const auto around = tissue::triangles_around(source);
  std::vector<bool> border(copy.mesh.vertices.size(), false);
  for (const auto& loop : boundary_loops(copy.mesh, connectivity(copy.mesh)))
    for (const int v : loop) border[static_cast<size_t>(v)] = true;
  uint32_t state = 1;
  const auto noise = [&] {
    state = 1664525U * state + 1013904223U;
    return static_cast<double>(state >> 8) / 8388608.0 - 1.0;
  };
  for (size_t v = 0; v < border.size(); ++v) {
    const Vec3 way(noise(), noise(), noise());
    if (border[v]) continue;
    SurfacePoint& place = copy.source[v];
    const double length = lengths[static_cast<size_t>(source.triangles[static_cast<size_t>(place.triangle)][0])];
    place = tissue::walk_to(source, around, copy.mesh.vertices[v] + 0.2 * length * way, place.triangle);
    copy.mesh.vertices[v] = position(source, place);
  }
}

}  // namespace

RemeshedCopy remeshed_copy(const formats::Scene& scene, const std::string& head, const std::string& kind) {
  if (kind != "half" && kind != "uneven") throw Error("copies are 'half' or 'uneven', not '" + kind + "'");
  formats::Drawing drawing;
  std::vector<CopiedFrom> from;
  size_t first = 0, head_first = 0;  // of the file's vertices
  for (const formats::SceneMesh& mesh : scene.meshes) {
    TriangleMesh surface{mesh.positions, mesh.triangles};
    if (mesh.name == head) {
      std::vector<int> welded_vertex;
      const TriangleMesh welded = weld(surface, 1e-6, &welded_vertex);
      std::vector<size_t> original(welded.vertices.size(), 0);
      for (size_t v = 0; v < welded_vertex.size(); ++v)
        if (welded_vertex[v] >= 0) original[static_cast<size_t>(welded_vertex[v])] = v;
      const std::vector<double> lengths = edge_lengths(welded, kind);
      tissue::RemeshResult copy = tissue::remesh(welded, lengths);
      if (kind == "uneven") shake(welded, lengths, copy);
      for (const SurfacePoint& p : copy.source) {
        const Triangle& t = welded.triangles[static_cast<size_t>(p.triangle)];
        from.push_back({{original[static_cast<size_t>(t[0])], original[static_cast<size_t>(t[1])], original[static_cast<size_t>(t[2])]}, p.barycentric});
      }
      head_first = first;
      surface = std::move(copy.mesh);
    }
    first += surface.vertices.size();
    drawing.surfaces.push_back({mesh.name, std::move(surface)});
  }
  const fs::path path = fs::temp_directory_path() / ("fascia_copy_" + kind + ".obj");
  formats::write(path, drawing);
  RemeshedCopy copy{formats::read(path), {}};
  fs::remove(path);
  for (const formats::SceneMesh& mesh : copy.scene.meshes)
    if (mesh.name == head)
      for (const int v : mesh.source_vertices) copy.head.push_back(from.at(static_cast<size_t>(v) - head_first));
  return copy;
}

std::vector<Vec3> carried_over(const RemeshedCopy& copy, const std::vector<Vec3>& values) {
  std::vector<Vec3> out;
  for (const CopiedFrom& from : copy.head) {
    out.push_back(Vec3::Zero());
    for (size_t k = 0; k < 3; ++k) out.back() += from.weights[static_cast<int>(k)] * values[from.vertices[k]];
  }
  return out;
}

}  // namespace fascia::bench
