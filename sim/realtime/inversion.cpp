#include <array>

#include "sim/realtime/solver.h"

namespace fascia::sim::realtime {
namespace {

constexpr double least = 0.01;    // smallest volume of a prism, relative to rest
constexpr float touched = 1e30F;  // stiffness that marks restored nodes
constexpr int passes = 24;        // restoring a node may invert neighbours, which are restored in turn

float f(double value) {
  return static_cast<float>(value);
}
Vec3 place_at(const float* list, size_t at) {
  return {list[at], list[at + 1], list[at + 2]};
}

/// A prism at the start and the end of a substep.
struct Way {
  std::array<Vec3, 6> now, back,
      corners;  ///< at the end; at the start, moved with the mean motion of its bones; between the two

  /// Moves the corners toward the start until the volume is above `room`; false if that is impossible.
  bool go_back(double room) {
    constexpr double shares[] = {0.5, 0.25, 0.125, 0.0};
    for (const double share : shares) {
      for (size_t k = 0; k < 6; ++k)
        corners[k] = back[k] + share * (now[k] - back[k]);
      if (volume() > room) return true;
    }
    return false;
  }
  double volume() const { return prism_volume({0, 1, 2, 3, 4, 5}, corners.data()); }
};

}  // namespace

bool Solver::is_upright(Workspace& work, size_t layer, size_t triangle, float* x) const {
  const FaceModel& face = model_->face();
  const auto& corners = face.lattice().triangles[triangle];
  const Prism& prism = face.prisms()[layer * face.lattice().triangles.size() + triangle];
  const double room = least * prism.volume;
  if (!(room > 0.0)) return true;
  std::array<size_t, 6> at{};
  Way way;
  for (size_t k = 0; k < 6; ++k) {
    at[k] = 16 * static_cast<size_t>(corners[k % 3]) + 4 * (layer + k / 3);
    way.now[k] = way.corners[k] = place_at(x, at[k]);
  }
  if (way.volume() > room) return true;
  // Carried along as one it keeps the volume it had, or has that of its bones alone; nodes on bones stay
  // where they are.
  const auto go_back = [&](const float* from, const float* to, const float* shape) {
    Vec3 shift = Vec3::Zero();
    for (const size_t slot : at)
      shift += (place_at(to, slot) - place_at(from, slot)) / 6.0;
    for (size_t k = 0; k < 6; ++k)
      way.back[k] = face.prescribed(prism.nodes[k]) ? way.now[k] : Vec3(place_at(shape, at[k]) + shift);
    return way.go_back(room);
  };
  const float* const before = work.start.data();
  const bool goes = go_back(before, work.begun_places.data(), before) ||
                    go_back(work.carried.data(), x, work.carried.data());
  for (size_t k = 0; k < 6; ++k) {
    work.gradient.data()[at[k] + 3] = touched;
    for (size_t axis = 0; goes && axis < 3; ++axis)
      x[at[k] + axis] = f(way.corners[k][static_cast<int>(axis)]);
  }
  return false;
}

bool Solver::untangle(Workspace& work, float* x) const {
  const auto& triangles = model_->face().lattice().triangles;
  bool all_upright = true;
  for (size_t b = 0; b < model_->packed().triangle_batches; ++b) {
    float shares[2 * batch_width];
    model_->loops().volume_ratios(model_->packed(), b, x, shares);
    for (size_t i = 0; i < 2 * batch_width; ++i)
      if (const size_t t = model_->triangle_at(b, i % batch_width);
          !(shares[i] > 1.5F * f(least)) && t < triangles.size())
        all_upright = is_upright(work, i / batch_width, t, x) && all_upright;
  }
  // Nodes taken back may have turned their neighbours.
  for (int pass = 1; pass < passes && !all_upright; ++pass) {
    all_upright = true;
    for (size_t t = 0; t < triangles.size(); ++t)
      for (size_t layer = 0; layer < 2; ++layer) {
        bool is_near = false;
        for (const uint32_t column : triangles[t])
          for (size_t k = 0; k < 2; ++k)
            is_near = is_near ||
                      work.gradient.data()[16 * static_cast<size_t>(column) + 4 * (layer + k) + 3] == touched;
        if (is_near) all_upright = is_upright(work, layer, t, x) && all_upright;
      }
  }
  return all_upright;
}

}  // namespace fascia::sim::realtime
