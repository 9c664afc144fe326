// Meshing the zero set of a spline of 2,000 centres, on one core: marching triangles, CGAL's surface mesher and VTK's
// marching cubes on the same field, evaluated by the same code, at the same number of triangles.
// bench_smas [REPEATS]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "bench/smas/workload.h"
#include "builder/smas/marching_triangles.h"
#include "builder/smas/surface_quality.h"
#include "geometry/connectivity.h"

namespace {

using namespace fascia;

constexpr double edge_length = 0.0054;
constexpr double tolerance = 1e-3 * edge_length;

bench::Meshed mesh_ourselves(const splines::Spline& field) {
  smas::MarchingOptions options;
  options.edge_length = edge_length;
  options.tolerance = tolerance / edge_length;
  options.seeds = {bench::head_like_radius(Vec3::UnitZ()) * Vec3::UnitZ()};
  const double started = bench::processor_time();
  smas::MarchingResult result = smas::marching_triangles(
      [&](const Vec3& p, Vec3* gradient) { return gradient ? field.fast_value_and_gradient(p, *gradient) : field.scalar(p); },
      options);
  return {std::move(result.mesh), bench::processor_time() - started, result.evaluations};
}

bool same_bytes(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles == b.triangles && a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

template <class Mesh>
bench::Meshed report(const char* name, int repeats, const splines::Spline& field, const Mesh& make) {
  std::vector<double> seconds;
  bench::Meshed meshed;
  bool same = true;
  for (int i = 0; i < repeats; ++i) {
    bench::Meshed again = make();
    same = same && (i == 0 || same_bytes(again.mesh, meshed.mesh));
    meshed = std::move(again);
    seconds.push_back(meshed.seconds);
  }
  std::sort(seconds.begin(), seconds.end());
  meshed.seconds = seconds[seconds.size() / 2];
  const smas::TriangleQuality quality = smas::triangle_quality(meshed.mesh);
  double edges = 0.0, off = 0.0;
  for (const Triangle& t : meshed.mesh.triangles)
    for (size_t e = 0; e < 3; ++e) edges += (meshed.mesh.vertices[t[e]] - meshed.mesh.vertices[t[(e + 1) % 3]]).norm();
  for (const Vec3& p : meshed.mesh.vertices) {
    Vec3 gradient;
    const double value = field.value_and_gradient(p, gradient);
    off = std::max(off, std::abs(value) / gradient.norm());
  }
  const Connectivity links = connectivity(meshed.mesh);
  std::printf("%-26s %5d triangles  mean edge %.2f mm  off the surface <= %7.1e mm  %8ld evaluations  %8.1f ms  "
              "radius ratio %.3f  min angle %4.1f  %s\n",
              name, meshed.mesh.triangle_count(), 1e3 * edges / (3.0 * meshed.mesh.triangle_count()), 1e3 * off,
              meshed.evaluations, 1e3 * meshed.seconds, quality.mean_radius_ratio, quality.min_angle,
              repeats < 2 ? "" : same ? "same bytes every run" : "other bytes each run");
  std::fflush(stdout);
  return meshed;
}

}  // namespace

int main(int count, char** arguments) {
  const int repeats = count > 1 ? std::max(1, std::atoi(arguments[1])) : 5;
  const splines::Spline field = bench::head_like_surface();
  std::printf("%d centres; all on one core, with the same evaluator; median of %d runs\n", field.coefficients().centres, repeats);
  const bench::Meshed own = report("marching triangles", repeats, field, [&] { return mesh_ourselves(field); });
  if (count > 2) return 0;
#ifdef FASCIA_WITH_CGAL
  const bench::Meshed cgal =
      report("CGAL surface mesher", std::min(repeats, 3), field, [&] { return bench::mesh_by_cgal(field, 0.755 * edge_length, tolerance); });
  std::printf("  against it %.1f times as fast with %.1f times fewer evaluations (goals 10 and 10)\n", cgal.seconds / own.seconds,
              static_cast<double>(cgal.evaluations) / static_cast<double>(own.evaluations));
#endif
#ifdef FASCIA_WITH_VTK
  const Bounds box = bounds(own.mesh.vertices);
  const bench::Meshed vtk = report("VTK marching cubes", repeats, field, [&] { return bench::mesh_by_vtk(field, box, 1.1 * edge_length); });
  std::printf("  against it %.1f times as fast (goal 1)\n", vtk.seconds / own.seconds);
#endif
}
