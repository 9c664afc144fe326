#include "bench/geodesics/exact_paths.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include <ctime>

namespace fascia::bench {

std::vector<ExactPath> exact_paths(const TriangleMesh& mesh, const std::vector<PointPair>& pairs) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;
  using ShortestPath = CGAL::Surface_mesh_shortest_path<Traits>;
  Mesh surface;
  for (const Vec3& p : mesh.vertices)
    surface.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
  // CGAL refuses faces that make the mesh non-manifold: faces are named by our numbers, not its own.
  std::vector<Mesh::Face_index> faces;
  for (const Triangle& t : mesh.triangles)
    faces.push_back(
        surface.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2])));
  const auto location = [&](const SurfacePoint& point) {
    // CGAL counts weights from the vertex its face's half-edge starts at.
    const auto first = surface.source(surface.halfedge(faces[point.triangle]));
    int shift = 0;
    while (mesh.triangles[point.triangle][shift] != static_cast<int>(first.idx()))
      ++shift;
    Traits::Barycentric_coordinates weights{point.barycentric[shift], point.barycentric[(shift + 1) % 3],
                                            point.barycentric[(shift + 2) % 3]};
    return std::pair(faces[point.triangle], weights);
  };
  std::vector<ExactPath> paths;
  for (const PointPair& pair : pairs) {
    const std::clock_t started = std::clock();
    ShortestPath shortest(surface);
    const auto source = location(pair.from), target = location(pair.to);
    shortest.add_source_point(source.first, source.second);
    std::vector<Kernel::Point_3> points;
    const auto result = shortest.shortest_path_points_to_source_points(target.first, target.second,
                                                                       std::back_inserter(points));
    ExactPath path;
    path.length = result.first;
    path.seconds = static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC;
    for (const auto& p : points)
      path.positions.emplace_back(p.x(), p.y(), p.z());
    paths.push_back(path);
  }
  return paths;
}

}  // namespace fascia::bench
