// Boundary-value geodesics between points a muscle's length apart, and tracing, on one core.
// bench_geodesics [--exact PAIRS]: against CGAL's exact shortest paths on 20k triangles in the same run.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>

#include "bench/geodesics/head_surface.h"
#include "builder/geodesics/path.h"
#include "builder/geodesics/trace.h"
#ifdef FASCIA_WITH_CGAL
#include "bench/geodesics/exact_paths.h"
#endif

namespace {

using namespace fascia;

/// Processor time of this thread, seconds: other programs on the machine do not count.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Largest angle between a path's two segments at an edge crossing when its triangles are laid flat, radians:
/// left minus right at every interior crossing.
double largest_turn(const geodesics::Surface& surface, const geodesics::Path& path) {
  double largest = 0.0;
  for (size_t k = 1; k + 1 < path.points.size(); ++k) {
    const SurfacePoint& point = path.points[k];
    if (point.barycentric.maxCoeff() > 1.0 - 1e-9) continue;  // at a vertex, counted as pinned
    int e = 0;
    while (e < 3 && point.barycentric[(e + 2) % 3] != 0.0)
      ++e;
    const Vec3 in = path.positions[k] - path.positions[k - 1],
               out = path.positions[k + 1] - path.positions[k];
    if (e == 3 || in.norm() < 1e-7 || out.norm() < 1e-7) continue;
    const int h = 3 * point.triangle + e;
    const Vec3 along =
        (surface.mesh.vertices[surface.target(h)] - surface.mesh.vertices[surface.origin(h)]).normalized();
    const auto angle = [&](const Vec3& v) { return std::atan2(v.cross(along).norm(), v.dot(along)); };
    largest = std::max(largest, std::abs(angle(in) - angle(out)));
  }
  return largest;
}

struct PathRow {
  double setup_ms = 0.0, mean_us = 0.0, median_us = 0.0, crossings = 0.0, cut = 0.0, searched = 0.0,
         passes = 0.0, end_error = 0.0, turn = 0.0, pinned = 0.0;
  std::vector<double> lengths;
};

PathRow run_paths(const TriangleMesh& mesh, const std::vector<bench::PointPair>& pairs) {
  PathRow row;
  std::vector<double> setups;
  for (int i = 0; i < 3; ++i) {
    TriangleMesh copy = mesh;
    const double started = now();
    const auto surface = geodesics::make_surface(std::move(copy));
    setups.push_back(1e3 * (now() - started));
  }
  row.setup_ms = median(setups);
  const auto surface = geodesics::make_surface(mesh);
  geodesics::Workspace workspace;
  geodesics::Path path;
  std::vector<double> means, each;
  for (int repeat = 0; repeat < 7; ++repeat) {
    const double started = now();
    for (const auto& pair : pairs)
      geodesics::connect_into(surface, pair.from, pair.to, {}, workspace, path);
    means.push_back(1e6 * (now() - started) / static_cast<double>(pairs.size()));
  }
  row.mean_us = median(means);
  for (const auto& pair : pairs) {
    const double started = now();
    geodesics::connect_into(surface, pair.from, pair.to, {}, workspace, path);
    each.push_back(1e6 * (now() - started));
    row.crossings += static_cast<double>(path.points.size() - 2) / static_cast<double>(pairs.size());
    row.searched += path.counters.searched ? 100.0 / static_cast<double>(pairs.size()) : 0.0;
    row.cut += path.counters.cut ? 100.0 / static_cast<double>(pairs.size()) : 0.0;
    row.passes += path.counters.passes / static_cast<double>(pairs.size());
    row.pinned += path.counters.pinned_vertices / static_cast<double>(pairs.size());
    row.end_error = std::max({row.end_error, (path.positions.front() - position(mesh, pair.from)).norm(),
                              (path.positions.back() - position(mesh, pair.to)).norm()});
    row.turn = std::max(row.turn, largest_turn(surface, path));
    row.lengths.push_back(path.length);
  }
  row.median_us = median(each);
  return row;
}

void run_trace(const TriangleMesh& mesh) {
  const auto surface = geodesics::make_surface(mesh);
  std::mt19937 random(3);
  std::uniform_int_distribution<int> any(0, mesh.triangle_count() - 1);
  std::normal_distribution<double> normal;
  std::vector<double> each;
  geodesics::TraceOptions options;
  options.points = false;
  for (int repeat = 0; repeat < 7; ++repeat) {
    long crossings = 0;
    const double started = now();
    for (int i = 0; i < 400; ++i) {
      const Vec3 direction(normal(random), normal(random), normal(random));
      crossings +=
          geodesics::trace(surface, {any(random), Vec3(0.3, 0.3, 0.4)}, direction, 0.3, options).crossings;
    }
    each.push_back(1e6 * (now() - started) / static_cast<double>(crossings));
  }
  std::printf("%8d triangles  tracing %.3f us an edge crossing\n", mesh.triangle_count(), median(each));
}

/// The time a path takes against its length, on one mesh: pairs 1, 2, 4 and 8 cm apart along traces.
void run_scaling(const TriangleMesh& mesh) {
  const auto surface = geodesics::make_surface(mesh);
  geodesics::Workspace workspace;
  geodesics::Path path;
  for (const double reach : {0.01, 0.02, 0.04, 0.08}) {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> any(0, mesh.triangle_count() - 1);
    std::normal_distribution<double> normal;
    std::vector<bench::PointPair> pairs;
    while (pairs.size() < 200) {
      const SurfacePoint from{any(random), Vec3(0.3, 0.3, 0.4)};
      const auto traced =
          geodesics::trace(surface, from, Vec3(normal(random), normal(random), normal(random)), reach);
      if (!traced.reached_boundary) pairs.push_back({from, traced.path.points.back()});
    }
    double crossings = 0.0;
    const double started = now();
    for (const auto& pair : pairs) {
      geodesics::connect_into(surface, pair.from, pair.to, {}, workspace, path);
      crossings += static_cast<double>(path.points.size());
    }
    const double seconds = now() - started;
    std::printf("%8.0f mm  %7.1f us a path  %6.1f crossings  %.3f us a crossing\n", 1e3 * reach,
                1e6 * seconds / 200.0, crossings / 200.0, 1e6 * seconds / crossings);
  }
}

#ifdef FASCIA_WITH_CGAL
void run_exact(const TriangleMesh& mesh, std::vector<bench::PointPair> pairs, int count,
               const PathRow& ours) {
  pairs.resize(std::min<size_t>(pairs.size(), static_cast<size_t>(count)));
  const auto exact = bench::exact_paths(mesh, pairs);
  std::vector<double> seconds, excess;
  int same = 0;
  for (size_t i = 0; i < exact.size(); ++i) {
    seconds.push_back(exact[i].seconds);
    excess.push_back(ours.lengths[i] / exact[i].length - 1.0);
    if (std::abs(excess.back()) < 1e-6) ++same;
  }
  std::printf(
      "CGAL exact, %zu pairs: median %.0f ms a path, ours %.0f times faster; the same length to 1e-6 in %d,"
      " else another class: median excess %.2g, largest %.2g, least %.2g\n",
      exact.size(), 1e3 * median(seconds), 1e6 * median(seconds) / ours.mean_us, same, median(excess),
      *std::max_element(excess.begin(), excess.end()), *std::min_element(excess.begin(), excess.end()));
}
#endif

void run(const TriangleMesh& mesh, bool exact, int exact_pairs, bool scaling) {
  const auto pairs = bench::muscle_pairs(mesh, 200);
  const PathRow row = run_paths(mesh, pairs);
  std::printf(
      "%8d triangles  set-up %6.1f ms  mean %7.1f us  median %6.1f us a path  %5.1f crossings  "
      "cut %.0f %%  searched %.0f %%  passes %.1f  pinned %.2f  end error %.1e m  left-right <= %.1e rad\n",
      mesh.triangle_count(), row.setup_ms, row.mean_us, row.median_us, row.crossings, row.cut, row.searched,
      row.passes, row.pinned, row.end_error, row.turn);
  run_trace(mesh);
#ifdef FASCIA_WITH_CGAL
  if (exact && exact_pairs > 0) run_exact(mesh, pairs, exact_pairs, row);
#else
  static_cast<void>(exact), static_cast<void>(exact_pairs);
#endif
  if (scaling) run_scaling(mesh);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  int exact_pairs = 20;
  if (count == 3 && std::strcmp(arguments[1], "--exact") == 0) exact_pairs = std::atoi(arguments[2]);
  std::printf(
      "200 pairs 40-60 mm apart; goals 34 / 194 / 1170 us a path (a tenth of FlipGeodesics'), tracing 0.1 "
      "us\n"
      "The SMAS of the generic head\n");
  for (const int triangles : {20000, 100000, 500000})
    run(bench::smas_surface(triangles), triangles == 20000, exact_pairs, triangles == 100000);
  std::printf("The skin of the generic head, with the pockets of eyes, mouth, nose and ears\n");
  for (const int triangles : {20000, 100000, 500000})
    run(bench::skin_surface(triangles), triangles == 20000, exact_pairs, false);
}
