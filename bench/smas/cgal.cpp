#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Surface_mesh_default_criteria_3.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>

#include <map>

#include "bench/smas/workload.h"

namespace fascia::bench {

Meshed mesh_by_cgal(const splines::Spline& field, double radius, double tolerance) {
  using Triangulation = CGAL::Surface_mesh_default_triangulation_3;
  using Complex = CGAL::Complex_2_in_triangulation_3<Triangulation>;
  using Traits = Triangulation::Geom_traits;
  using Function = std::function<double(Traits::Point_3)>;
  Meshed out;
  const double started = processor_time();
  Triangulation triangulation;
  Complex complex(triangulation);
  const Function function = [&](const Traits::Point_3& p) {
    ++out.evaluations;
    return field.scalar({p.x(), p.y(), p.z()});
  };
  const Traits::Sphere_3 ball(CGAL::ORIGIN, ball_radius * ball_radius);
  const CGAL::Implicit_surface_3<Traits, Function> surface(function, ball, tolerance / ball_radius);
  const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(30.0, radius, radius);
  CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag());
  std::map<Triangulation::Vertex_handle, int> number;
  for (auto f = complex.facets_begin(); f != complex.facets_end(); ++f) {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      const auto vertex = f->first->vertex(Triangulation::vertex_triple_index(f->second, k));
      const auto [at, fresh] = number.try_emplace(vertex, out.mesh.vertex_count());
      if (fresh) out.mesh.vertices.push_back({vertex->point().x(), vertex->point().y(), vertex->point().z()});
      triangle[static_cast<size_t>(k)] = at->second;
    }
    out.mesh.triangles.push_back(triangle);
  }
  out.seconds = processor_time() - started;
  return out;
}

}  // namespace fascia::bench
