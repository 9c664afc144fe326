#include "runtime/drivers/curves.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "gltf/read/container.h"
#include "runtime/drivers/text.h"

namespace fascia::runtime {
namespace {

/// Slope at key `i`: the file's own, or through the neighbours.
double slope(const Curve& curve, std::size_t i, const std::vector<float>& given) {
  if (!given.empty()) return given[i];
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, curve.times.size() - 1);
  const double span = curve.times[after] - curve.times[before];
  return span > 0 ? (static_cast<double>(curve.values[after]) - curve.values[before]) / span : 0.0;
}

float hermite(const Curve& curve, std::size_t i, double share) {
  const double span = curve.times[i + 1] - curve.times[i];
  const double s = share, s2 = s * s, s3 = s2 * s;
  return static_cast<float>((2 * s3 - 3 * s2 + 1) * curve.values[i] +
                            (s3 - 2 * s2 + s) * span * slope(curve, i, curve.tangents_out) +
                            (3 * s2 - 2 * s3) * curve.values[i + 1] +
                            (s3 - s2) * span * slope(curve, i + 1, curve.tangents_in));
}

/// Numbers in files are double; what drives a face is float, and beyond any use long before its end.
void refuse_absurd_values(const Curves& curves) {
  constexpr float most = 1e9F;
  for (const Curve& curve : curves.curves)
    for (const auto* list : {&curve.values, &curve.tangents_in, &curve.tangents_out})
      for (const float value : *list)
        if (!(std::abs(value) <= most))
          throw Error("curves: a value of " + shown(curve.name) +
                      " is beyond a thousand million: is the column another thing's?");
}

}  // namespace

float Curve::at(double seconds) const {
  if (times.empty()) return 0.0F;
  if (!(seconds > times.front())) return values.front();
  if (seconds >= times.back()) return values.back();
  const auto next = std::upper_bound(times.begin(), times.end(), seconds);
  const auto i = static_cast<std::size_t>(next - times.begin()) - 1;
  if (interpolation == Interpolation::step) return values[i];
  const double share = (seconds - times[i]) / (times[i + 1] - times[i]);
  if (interpolation == Interpolation::cubic) return hermite(*this, i, share);
  return static_cast<float>((1.0 - share) * values[i] + share * values[i + 1]);
}

double Curves::duration() const {
  double last = 0.0;
  for (const Curve& curve : curves)
    if (!curve.times.empty()) last = std::max(last, curve.times.back());
  return last;
}

Curves read_curves(std::span<const uint8_t> bytes, const ReadOptions& options) {
  if (gltf::is_glb(bytes)) {
    Curves curves = read_gltf_curves(bytes);
    refuse_absurd_values(curves);
    settle(curves);
    return curves;
  }
  const std::string text = utf8_text(bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw Error("curves: the file is empty");
  if (text.find('\0') != std::string::npos)
    throw Error("curves: neither text nor a .glb file: export the take as CSV, JSON or GLB");
  const bool is_json = text[first] == '{' || text[first] == '[';
  Curves curves = is_json ? read_json_curves(text, options) : read_csv_curves(text, options);
  refuse_absurd_values(curves);
  settle(curves);
  return curves;
}

}  // namespace fascia::runtime
