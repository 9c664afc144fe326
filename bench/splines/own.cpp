// Fascia's thin-plate warp: bench_splines LANDMARKS [OUTPUT [WORKLOAD]]. Writes the carried points to OUTPUT,
// and source, target and points after each other to WORKLOAD.
#include "bench/splines/workload.h"
#include "builder/splines/warp.h"

int main(int argc, char** argv) {
  using fascia::Vec3;
  const int count = argc > 1 ? std::atoi(argv[1]) : 500;
  if (count < 4) return std::fputs("usage: bench_splines LANDMARKS [OUTPUT [WORKLOAD]]\n", stderr), 2;
  const bench::Workload work = bench::workload(count);
  const auto vectors = [](const std::vector<bench::Point>& from) {
    std::vector<Vec3> out;
    for (const bench::Point& p : from)
      out.emplace_back(p[0], p[1], p[2]);
    return out;
  };
  const std::vector<Vec3> source = vectors(work.source), target = vectors(work.target),
                          points = vectors(work.points);
  fascia::splines::Warp warp;
  std::vector<Vec3> carried;
  const double fit = bench::median_milliseconds(bench::fit_repeats(count),
                                                [&] { warp = fascia::splines::fit_warp(source, target); });
  const double apply = bench::milliseconds([&] { carried = warp(points); });
  bench::report("fascia", count, fit, apply);
  if (argc > 2) {
    std::vector<bench::Point> out;
    for (const Vec3& p : carried)
      out.push_back({p.x(), p.y(), p.z()});
    bench::write_points(argv[2], out);
  }
  if (argc > 3) {
    std::vector<bench::Point> all = work.source;
    all.insert(all.end(), work.target.begin(), work.target.end());
    all.insert(all.end(), work.points.begin(), work.points.end());
    bench::write_points(argv[3], all);
  }
}
