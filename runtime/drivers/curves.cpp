#include "runtime/drivers/curves.h"

#include <algorithm>
#include <cctype>

#include "geometry/error.h"
#include "gltf/read/container.h"

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

Curves read_curves(std::span<const uint8_t> bytes) {
  if (gltf::is_glb(bytes)) return read_gltf_curves(bytes);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  std::size_t first = 0;
  while (first < text.size() && std::isspace(static_cast<unsigned char>(text[first])))
    ++first;
  if (first == text.size()) throw Error("curves: the file is empty");
  return text[first] == '{' ? read_json_curves(text) : read_csv_curves(text);
}

}  // namespace fascia::runtime
