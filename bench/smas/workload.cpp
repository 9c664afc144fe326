#include "bench/smas/workload.h"

#include <cmath>
#include <ctime>

#include "builder/splines/implicit.h"

namespace fascia::bench {

double head_like_radius(const Vec3& d) {
  const double ellipsoid =
      1.0 / std::sqrt(std::pow(d[0] / 0.075, 2) + std::pow(d[1] / 0.115, 2) + std::pow(d[2] / 0.095, 2));
  const auto bump = [&](const Vec3& at, double height, double width) {
    return height * std::exp(-(d - at.normalized()).squaredNorm() / (width * width));
  };
  return ellipsoid + bump({0, -0.05, 1}, 0.018, 0.16) + bump({0, -0.75, 0.8}, 0.012, 0.25) +
         bump({0.35, 0.3, 1}, 0.004, 0.2) + bump({-0.35, 0.3, 1}, 0.004, 0.2) -
         bump({0.33, 0.08, 1}, 0.007, 0.17) - bump({-0.33, 0.08, 1}, 0.007, 0.17) -
         bump({0, -1, 0.1}, 0.02, 0.5);
}

splines::Spline head_like_surface() {
  constexpr int count = 1000;
  std::vector<Vec3> points, normals;
  for (int i = 0; i < count; ++i) {
    // Fibonacci's spiral covers the sphere evenly.
    const double z = 1.0 - (2.0 * i + 1.0) / count, ring = std::sqrt(1.0 - z * z),
                 turn = M_PI * (1.0 + std::sqrt(5.0)) * i;
    const Vec3 d(ring * std::cos(turn), ring * std::sin(turn), z);
    points.push_back(head_like_radius(d) * d);
    // Gradient of |x| - radius(x / |x|) by differences.
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = 1e-6 * Vec3::Unit(k), ahead = points.back() + step, behind = points.back() - step;
      gradient[k] = (ahead.norm() - head_like_radius(ahead.normalized())) -
                    (behind.norm() - head_like_radius(behind.normalized()));
    }
    normals.push_back(gradient.normalized());
  }
  splines::ImplicitOptions options;
  options.exponent = 3;
  options.offset = 0.004;
  return splines::fit_variational(points, normals, options);
}

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace fascia::bench
