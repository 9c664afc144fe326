#include "builder/smas/height_fit.h"

#include <algorithm>
#include <cmath>

namespace fascia::smas {

bool HeightFit::add(const Vec3& point, double value, double spacing) {
  grid_.near(point, spacing, &near_);
  if (!near_.empty()) return false;
  grid_.add(point);
  sites_.points.push_back(point);
  values_.push_back(value);
  return true;
}

void HeightFit::choose(const std::vector<int>& order, double spacing, int limit) {
  for (int i : order) {
    if (data() + 3 >= limit) return;
    const DepthSample& sample = samples_[i];
    if (chosen_[i] || !add(sample.zero, 0.0, spacing)) continue;
    chosen_[i] = true;
    const int turn = zeros_++ % 4;
    if (form_ == ImplicitForm::hermite) {
      if (turn > 0) continue;
      sites_.add_gradient(sample.zero);
      for (int k = 0; k < 3; ++k)
        slopes_.push_back(sample.normal[k]);
      continue;
    }
    // Every other zero point has a partner of known height, in turn over and under it.
    const double height = std::min(sample.depth, 0.005 * scale_) * (turn < 2 ? 1.0 : -1.0);
    if (turn % 2 == 0)
      add(sample.zero + height * sample.normal, height, std::min(0.0005 * scale_, 0.5 * std::abs(height)));
  }
}

void HeightFit::solve() {
  splines::SplineOptions options;
  options.exponent = 3;
  options.degree = 1;
  std::vector<double> all = values_;
  all.insert(all.end(), slopes_.begin(), slopes_.end());
  spline_ = splines::fit(
      sites_, Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())), options);
}

std::vector<double> HeightFit::errors(size_t step) const {
  std::vector<Vec3> points;
  for (size_t i = 0; i < samples_.size(); i += step)
    points.push_back(samples_[i].zero);
  const Eigen::MatrixXd values = spline_.values(points);
  std::vector<double> errors;
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    errors.push_back(std::abs(values(i, 0)));
  return errors;
}

HeightFit fit_height(const std::vector<DepthSample>& samples, const Options& options, double scale,
                     double area) {
  HeightFit height(samples, options.form, scale);
  std::vector<int> order(samples.size());
  for (size_t i = 0; i < order.size(); ++i)
    order[i] = static_cast<int>(i);
  // First an even cover with about half of the centres, then where that misses most.
  const int limit = std::max(options.max_centres, 60);
  const double even = std::sqrt(1.2 * area / (0.3 * limit));
  height.choose(order, even, limit / 2);
  height.choose(order, 0.7 * even, limit / 2);
  height.solve();
  const std::vector<double> error = height.errors(1);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return error[a] > error[b]; });
  while (!order.empty() && error[order.back()] < options.fit_tolerance)
    order.pop_back();
  if (order.empty()) return height;
  height.choose(order, 0.0045 * scale, limit);
  height.choose(order, 0.0025 * scale, limit);
  height.solve();
  return height;
}

}  // namespace fascia::smas
