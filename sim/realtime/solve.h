#pragma once

// What the files of realtime::Solver share: its minimisation, and places in lists of floats.

#include "sim/pose_hessian.h"
#include "sim/realtime/solver.h"

namespace fascia::sim::realtime {
namespace solving {

inline float f(double value) {
  return static_cast<float>(value);
}
inline Vec3 place_at(const float* list, int32_t at) {
  return {list[at], list[at + 1], list[at + 2]};
}
inline void add_at(float* list, int32_t at, const Vec3& value) {
  for (int axis = 0; axis < 3; ++axis)
    list[at + axis] += f(value[axis]);
}

}  // namespace solving

/// The Hessian at a pose, in place of the factor at rest.
struct Solver::HessianPreconditioner {
  PoseHessian hessian;
  PoseHessian::Dense vector;  ///< over the face model's unknowns
};

/// One minimisation: what stands still while it runs.
struct Solver::Solve {
  Workspace& work;
  Boundary boundary;
  Panels factor;
  RigidTransform mandible;
  std::span<const NodeForce> touches;
  Unknowns unknowns{};
  std::span<const Grip> grips;
  HessianPreconditioner* hessian = nullptr;  ///< used instead of `factor` if set
};

}  // namespace fascia::sim::realtime
