#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/asset.h"
#include "sim/realtime/solver.h"

namespace fascia::testing {

/// Two seconds in which every channel goes its own slow way, jaw and lids among them, played at `rate` frames
/// a second (a multiple of ten), up to `amplitude` of its range: displacements at every tenth of a second.
inline std::vector<std::vector<sim::Vec3f>> played(const runtime::Asset& asset, size_t level, int rate,
                                                   const sim::realtime::StepOptions& options,
                                                   double amplitude = 0.4) {
  const size_t channels = asset.channel_names.size();
  const auto& bones = asset.bones();
  sim::realtime::Solver face(asset.realtime_model(level), channels);
  std::vector<float> values(channels);
  std::vector<std::vector<sim::Vec3f>> out;
  for (int frame = 1; frame <= 2 * rate; ++frame) {
    const double t = static_cast<double>(frame) / rate;
    for (size_t c = 0; c < channels; ++c) {
      const double wave =
          std::sin(2.0 * M_PI * (0.5 + 0.07 * static_cast<double>(c % 7)) * t + 2.4 * static_cast<double>(c));
      values[c] = static_cast<float>(amplitude * std::min(1.0, t / 0.3) * wave * wave) *
                  (wave > 0.0 ? asset.channel_maximum[c] : asset.channel_minimum[c]);
    }
    const auto value = [&](int32_t channel) {
      return channel < 0 ? 0.0F : values[static_cast<size_t>(channel)];
    };
    sim::Controls drive;
    drive.activations = values;
    drive.jaw = {value(bones.jaw_open), value(bones.jaw_forward), value(bones.jaw_lateral)};
    face.step(1.0 / rate, drive, options);
    if (frame % (rate / 10) != 0) continue;
    out.emplace_back(asset.model(level).rest().size());
    face.displacements(out.back());
  }
  return out;
}

struct Apart {
  double share = 0.0;  ///< mean distance over mean motion
  double most = 0.0;   ///< metres
};

inline Apart apart(const std::vector<std::vector<sim::Vec3f>>& a,
                   const std::vector<std::vector<sim::Vec3f>>& b) {
  Apart result;
  double off = 0.0, size = 0.0;
  for (size_t k = 0; k < a.size(); ++k)
    for (size_t i = 0; i < a[k].size(); ++i) {
      const double distance = static_cast<double>((a[k][i] - b[k][i]).norm());
      off += distance;
      size += static_cast<double>(b[k][i].norm());
      result.most = std::max(result.most, distance);
    }
  result.share = off / size;
  return result;
}

}  // namespace fascia::testing
