// The peer anyone writes first: the whole saddle matrix, Eigen's LU, plain loops to evaluate. A program of
// its own, because it is compiled for the machine at hand: bench_splines_dense LANDMARKS [OUTPUT].
#include <Eigen/Dense>

#include "bench/splines/workload.h"

namespace {

double distance(const bench::Point& a, const bench::Point& b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return std::sqrt(x * x + y * y + z * z);
}

Eigen::MatrixXd fit(const std::vector<bench::Point>& source, const std::vector<bench::Point>& target) {
  const int n = static_cast<int>(source.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 4, n + 4), right = Eigen::MatrixXd::Zero(n + 4, 3);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i)
      system(i, j) = distance(source[i], source[j]);
    system(j, n) = system(n, j) = 1;
    for (int axis = 0; axis < 3; ++axis) {
      system(j, n + 1 + axis) = system(n + 1 + axis, j) = source[j][axis];
      right(j, axis) = target[j][axis];
    }
  }
  return system.partialPivLu().solve(right);
}

std::vector<bench::Point> carry(const std::vector<bench::Point>& source, const Eigen::MatrixXd& weights,
                                const std::vector<bench::Point>& points) {
  const int n = static_cast<int>(source.size());
  std::vector<double> x, y, z;
  for (const bench::Point& p : source) {
    x.push_back(p[0]);
    y.push_back(p[1]);
    z.push_back(p[2]);
  }
  std::vector<bench::Point> out(points.size());
  const double *a = weights.col(0).data(), *b = weights.col(1).data(), *c = weights.col(2).data();
  for (size_t i = 0; i < points.size(); ++i) {
    const bench::Point& p = points[i];
    double u = 0, v = 0, w = 0;
    for (int j = 0; j < n; ++j) {
      const double dx = p[0] - x[j], dy = p[1] - y[j], dz = p[2] - z[j];
      const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
      u += a[j] * r;
      v += b[j] * r;
      w += c[j] * r;
    }
    double sums[3] = {u, v, w};
    for (int axis = 0; axis < 3; ++axis)
      out[i][axis] = sums[axis] + weights(n, axis) + weights(n + 1, axis) * p[0] +
                     weights(n + 2, axis) * p[1] + weights(n + 3, axis) * p[2];
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 500;
  if (count < 4) return std::fputs("usage: bench_splines_dense LANDMARKS [OUTPUT]\n", stderr), 2;
  const bench::Workload work = bench::workload(count);
  Eigen::MatrixXd weights;
  std::vector<bench::Point> carried;
  const double fitting =
      bench::median_milliseconds(bench::fit_repeats(count), [&] { weights = fit(work.source, work.target); });
  const double apply = bench::milliseconds([&] { carried = carry(work.source, weights, work.points); });
  bench::report("dense LU", count, fitting, apply);
  if (argc > 2) bench::write_points(argv[2], carried);
}
