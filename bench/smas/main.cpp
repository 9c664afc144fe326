// Meshing the zero set of a spline of 2,000 centres, on one core: marching triangles, CGAL's surface mesher
// and VTK's marching cubes on the same field, evaluated by the same code, at the same number of triangles.
// bench_smas [REPEATS]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "bench/smas/workload.h"
#include "builder/smas/marching_triangles.h"
#include "builder/smas/surface_quality.h"

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
      [&](const Vec3& p, Vec3* gradient) {
        return gradient ? field.fast_value_and_gradient(p, *gradient) : field.scalar(p);
      },
      options);
  return {std::move(result.mesh), bench::processor_time() - started, result.evaluations};
}

bool same_bytes(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles == b.triangles && a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

/// One way of meshing, and its runs.
struct Contender {
  const char* name;
  std::function<bench::Meshed()> make;
  int repeats;
  bench::Meshed last;
  std::vector<double> seconds;
  bool same = true;

  void run() {
    if (static_cast<int>(seconds.size()) == repeats) return;
    bench::Meshed again = make();
    same = same && (seconds.empty() || same_bytes(again.mesh, last.mesh));
    last = std::move(again);
    seconds.push_back(last.seconds);
  }
  double median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

void report(const Contender& contender, const splines::Spline& field) {
  const TriangleMesh& mesh = contender.last.mesh;
  const smas::TriangleQuality quality = smas::triangle_quality(mesh);
  double edges = 0.0, off = 0.0;
  for (const Triangle& t : mesh.triangles)
    for (size_t e = 0; e < 3; ++e)
      edges += (mesh.vertices[t[e]] - mesh.vertices[t[(e + 1) % 3]]).norm();
  for (const Vec3& p : mesh.vertices) {
    Vec3 gradient;
    const double value = field.value_and_gradient(p, gradient);
    off = std::max(off, std::abs(value) / gradient.norm());
  }
  std::printf(
      "%-20s %5d triangles  mean edge %.2f mm  off the surface <= %7.1e mm  %7ld evaluations  %7.1f ms  "
      "radius ratio %.3f  min angle %4.1f  %s\n",
      contender.name, mesh.triangle_count(), 1e3 * edges / (3.0 * mesh.triangle_count()), 1e3 * off,
      contender.last.evaluations, 1e3 * contender.median(), quality.mean_radius_ratio, quality.min_angle,
      contender.same ? "same bytes every run" : "other bytes each run");
}

}  // namespace

int main(int count, char** arguments) {
  const int repeats = count > 1 ? std::max(2, std::atoi(arguments[1])) : 7;
  const splines::Spline field = bench::head_like_surface();
  std::printf("%d centres; all on one core in turn, with the same evaluator; medians of %d runs\n",
              field.coefficients().centres, repeats);
  Contender own{"marching triangles", [&] { return mesh_ourselves(field); }, repeats, {}, {}};
  own.run();
  std::vector<Contender*> all = {&own};
#ifdef FASCIA_WITH_CGAL
  Contender cgal{"CGAL surface mesher",
                 [&] { return bench::mesh_by_cgal(field, 0.755 * edge_length, tolerance); },
                 std::min(repeats, 3),
                 {},
                 {}};
  all.push_back(&cgal);
#endif
#ifdef FASCIA_WITH_VTK
  const Bounds box = bounds(own.last.mesh.vertices);
  Contender vtk{"VTK marching cubes",
                [&] { return bench::mesh_by_vtk(field, box, 1.115 * edge_length); },
                repeats,
                {},
                {}};
  all.push_back(&vtk);
#endif
  // In turn, so that what else the machine does meets all alike.
  for (int i = 0; i < repeats; ++i)
    for (Contender* contender : all)
      contender->run();
  for (const Contender* contender : all)
    report(*contender, field);
#ifdef FASCIA_WITH_CGAL
  std::printf("against CGAL %.1f times as fast with %.1f times fewer evaluations (goals 10 and 10)\n",
              cgal.median() / own.median(),
              static_cast<double>(cgal.last.evaluations) / static_cast<double>(own.last.evaluations));
#endif
#ifdef FASCIA_WITH_VTK
  std::printf("against VTK %.2f times as fast (goal 1)\n", vtk.median() / own.median());
#endif
}
