#pragma once

// The work that all programs of this benchmark do: N landmarks of a head, 100,000 points to carry.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <vector>

namespace bench {

using Point = std::array<double, 3>;

struct Workload {
  std::vector<Point> source, target, points;
};

/// `count` landmarks in a head's box (metres) that move by some millimetres, and the points.
inline Workload workload(int count, int point_count = 100000) {
  std::mt19937_64 random(12345);
  const auto uniform = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
  const auto point = [&] { return Point{0.16 * uniform(), 0.24 * uniform(), 0.2 * uniform()}; };
  Workload out;
  for (int i = 0; i < count; ++i) {
    const Point p = point();
    out.source.push_back(p);
    out.target.push_back(
        {p[0] + 0.01 * std::sin(20 * p[1]), 1.1 * p[1] + 0.002 * uniform(), p[2] + 0.05 * p[0]});
  }
  for (int i = 0; i < point_count; ++i)
    out.points.push_back(point());
  return out;
}

/// Processor time of `work` in this one thread: what other programs take of the machine does not count.
template <class Work>
double milliseconds(const Work& work) {
  const auto now = [] {
    std::timespec at{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &at);
    return 1e3 * static_cast<double>(at.tv_sec) + 1e-6 * static_cast<double>(at.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

/// Median over repeats of a short job, so that none is judged by its first, cold run.
template <class Work>
double median_milliseconds(int repeats, const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i)
    times.push_back(milliseconds(work));
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[static_cast<size_t>(repeats / 2)];
}

/// How often a fit of `count` landmarks is repeated.
inline int fit_repeats(int count) {
  return std::max(1, 2000 / count);
}

/// One line of JSON on standard output.
inline void report(const std::string& program, int count, double fit, double warp) {
  std::printf("{\"program\": \"%s\", \"landmarks\": %d, \"fit_ms\": %.4f, \"warp_ms\": %.4f}\n",
              program.c_str(), count, fit, warp);
  std::fflush(stdout);
}

/// Carried points as raw doubles, for comparison with other programs.
inline void write_points(const char* path, const std::vector<Point>& points) {
  std::FILE* file = std::fopen(path, "wb");
  if (!file || std::fwrite(points.data(), sizeof(Point), points.size(), file) != points.size()) {
    std::fprintf(stderr, "cannot write %s\n", path);
    std::exit(1);
  }
  std::fclose(file);
}

}  // namespace bench
