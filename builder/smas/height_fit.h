#pragma once

#include <vector>

#include "builder/smas/samples.h"
#include "builder/smas/smas.h"
#include "builder/smas/vertex_grid.h"
#include "builder/splines/polyharmonic.h"

namespace fascia::smas {

/// The signed height over the SMAS as a spline, from a choice of samples.
class HeightFit {
 public:
  HeightFit(const std::vector<DepthSample>& samples, ImplicitForm form, double scale)
      : samples_(samples), form_(form), scale_(scale), grid_(0.008 * scale), chosen_(samples.size(), false) {}

  /// Takes samples at least `spacing` apart, in the order `order`, until there are `limit` data.
  void choose(const std::vector<int>& order, double spacing, int limit);
  void solve();

  /// Distance of every `step`-th sample's zero point to the surface, to first order.
  std::vector<double> errors(size_t step) const;
  const splines::Spline& spline() const { return spline_; }
  int data() const { return sites_.rows(); }

 private:
  bool add(const Vec3& point, double value, double spacing);

  const std::vector<DepthSample>& samples_;
  const ImplicitForm form_;
  const double scale_;
  VertexGrid grid_;
  std::vector<bool> chosen_;
  std::vector<int> near_;
  std::vector<double> values_, slopes_;
  splines::Sites sites_;
  splines::Spline spline_;
  int zeros_ = 0;
};

/// Fits a greedy choice of at most `options.max_centres` data: half of them an even cover of the skin's
/// `area`, square metres, the rest where that misses most.
HeightFit fit_height(const std::vector<DepthSample>& samples, const Options& options, double scale,
                     double area);

}  // namespace fascia::smas
