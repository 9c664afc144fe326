#include <algorithm>
#include <cmath>

#include "builder/tissue/actuators.h"

namespace fascia::tissue {
namespace {

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Height and depth of a lip's edge over the place across the mouth, in even steps from corner to corner.
struct LipEdge {
  std::array<double, 21> y{}, z{}, weight{};
  void add(double place, const Vec3& p) {
    for (size_t k = 0; k < y.size(); ++k) {
      const double d = (place - static_cast<double>(k) / 20.0) / 0.06, w = std::exp(-d * d);
      y[k] += w * p.y();
      z[k] += w * p.z();
      weight[k] += w;
    }
  }
  Vec3 at(double place, double x) const {
    const double s = std::clamp(place, 0.0, 1.0) * 20.0;
    const auto k = std::min<size_t>(static_cast<size_t>(s), 19);
    const double t = s - static_cast<double>(k);
    const auto mean = [&](const std::array<double, 21>& values, size_t i) { return weight[i] > 1e-9 ? values[i] / weight[i] : 0.0; };
    return {x, (1 - t) * mean(y, k) + t * mean(y, k + 1), (1 - t) * mean(z, k) + t * mean(z, k + 1)};
  }
};

}  // namespace

void add_lip_rolls(const TissueInputs& inputs, const TissueOptions& options, const Columns& c, rig::TissueLevel& level) {
  const Vec3 left = landmark(inputs, "cheilion_left"), right = landmark(inputs, "cheilion_right");
  const Vec3 centre = 0.5 * (left + right);
  const double half = 0.5 * (left - right).norm();
  const auto& distance = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  const auto n = static_cast<size_t>(c.count());
  const auto place_of = [&](const Vec3& p) { return 0.5 + 0.5 * (p.x() - centre.x()) / half; };
  for (const bool upper : {true, false}) {
    LipEdge edge;
    for (size_t v = 0; v < n; ++v) {
      const Vec3& p = c.mesh.vertices[v];
      if (c.outer[v] && distance[v] < 0.003 && (c.lower_lip[v] < 0.5) == upper) edge.add(place_of(p), p);
    }
    for (size_t v = 0; v < n; ++v) {
      const Vec3& p = c.mesh.vertices[v];
      if (c.rim[v] || distance[v] > 0.014 || (c.lower_lip[v] < 0.5) != upper) continue;
      // The lip's body lies above (below) and behind its edge: the vermilion turns about that, the white lip stays.
      const Vec3 origin = edge.at(place_of(p), p.x()) + Vec3(0, upper ? 0.006 : -0.006, -0.006);
      const double fade = (1.0 - smoothstep(0.005, 0.014, distance[v])) * (1.0 - smoothstep(0.55, 1.0, std::abs(p.x() - centre.x()) / half));
      for (const bool is_left : {true, false}) {
        const double side = smoothstep(-0.005, 0.005, is_left ? p.x() - centre.x() : centre.x() - p.x());
        const int channel = channel_index(inputs.channels, std::string("lip_roll_") + (upper ? "upper" : "lower") + (is_left ? "_left" : "_right"));
        if (channel < 0 || side * fade < 0.02) continue;
        for (const size_t node : {v, n + v}) {
          level.carrier_channel.push_back(static_cast<uint32_t>(channel));
          level.carrier_node.push_back(static_cast<uint32_t>(node));
          level.carrier_origin.push_back(origin.cast<float>());
          level.carrier_axis.push_back(rig::Vec3f::UnitX());
          level.carrier_angle.push_back(upper ? 0.9F : -0.9F);
          level.carrier_reverse.push_back(upper ? -0.7F : 0.7F);
          level.carrier_stiffness.push_back(0.0F);  // lips are moved, never held
          level.carrier_drive.push_back(static_cast<float>(options.material.lip_drive * c.area[v] * fade * side));
        }
      }
    }
  }
}

}  // namespace fascia::tissue
