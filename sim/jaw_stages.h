#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "sim/reference_solver.h"

namespace fascia::sim {

/// A static pose whose jaw is opened in stages of `options.jaw_stage`, each started from the previous one; in
/// a single stage for a warm start. `pose_at_once(controls, options, positions)` solves one stage, writes
/// positions if given a destination, and returns a MinimiseResult.
template <class PoseAtOnce>
MinimiseResult pose_in_stages(const Controls& controls, const PoseOptions& options,
                              std::span<Vec3f> positions, const PoseAtOnce& pose_at_once) {
  const bool is_staged = !options.from_last_pose && options.jaw_stage > 0.0 && controls.jaw.open > 0.0F;
  const double open = std::min(static_cast<double>(controls.jaw.open), 1.0);
  const int stages = is_staged ? static_cast<int>(std::ceil(open / options.jaw_stage)) : 1;
  // Intermediate stages are solved only accurately enough to start the next one.
  PoseOptions rough = options;
  rough.contact_rounds = std::min(options.contact_rounds, 1);
  rough.solver.iterations = std::min(options.solver.iterations, 40);
  rough.solver.tolerance = std::max(options.solver.tolerance, 1e-4);
  rough.newton.iterations = 0;
  int before = 0;
  for (int stage = 1; stage < stages; ++stage) {
    Controls part = controls;
    const float share = static_cast<float>(stage) / static_cast<float>(stages);
    part.jaw.open *= share;
    part.jaw.forward *= share;
    part.jaw.lateral *= share;
    rough.from_last_pose = stage > 1;
    before += pose_at_once(part, rough, std::span<Vec3f>()).iterations;
  }
  PoseOptions last = options;
  last.from_last_pose = options.from_last_pose || stages > 1;
  MinimiseResult result = pose_at_once(controls, last, positions);
  result.iterations += before;
  return result;
}

}  // namespace fascia::sim
