#pragma once

#include <span>
#include <vector>

#include "builder/skull/exterior.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// A violation of the clearance between bone and outer skin.
struct Violation {
  int vertex = 0;
  double missing = 0;          ///< m to move to reach the clearance
  Vec3 inward = Vec3::Zero();  ///< unit, away from the skin
  bool outside = false;        ///< outside the skin altogether
};

/// The generic's skin over a point of its bone.
struct SkinOver {
  double depth = 0;  ///< m: interpolated from the landmarks' depths by inverse distance, and no more than the
                     ///< distance to the generic skin where there is one
  Vec3 outward = Vec3::Zero();  ///< unit normal of the nearest generic skin; zero without one
  Vec3 skin = Vec3::Zero();     ///< that point of the skin
};

/// What lies over each of `points` on the generic's bone.
std::vector<SkinOver> skin_over(const Generic& generic, std::span<const Vec3> points);

/// Clearance asked of each point: `options.clearance_share` of the scaled depth, at least the floor.
std::vector<double> clearances(std::span<const SkinOver> over, const FitOptions& options);

/// Repeatedly checks moving vertices against the outer skin. Distances change no faster than vertices move,
/// so a sufficiently deep vertex is not measured again until it could have come close.
class ClearanceCheck {
 public:
  /// `outward`: of each vertex, unit and already turned to the head, or zero. Skin that does not face that
  /// way does not count: the lining of an open mouth lies in front of teeth that it does not cover.
  ClearanceCheck(const Exterior& skin, std::vector<double> clearance, std::vector<Vec3> outward);

  /// The vertices nearer to the outer skin than their clearance, in order.
  std::vector<Violation> operator()(std::span<const Vec3> vertices);

  /// The same among the vertices from `first` up to `end`.
  std::vector<Violation> operator()(std::span<const Vec3> vertices, int first, int end);

  const std::vector<double>& clearance() const { return clearance_; }
  void set_clearance(std::vector<double> clearance) { clearance_ = std::move(clearance); }

 private:
  const Exterior* skin_;
  std::vector<double> clearance_;
  std::vector<Vec3> outward_;
  std::vector<Vec3> measured_at_;
  std::vector<double> measured_;  // signed distance there
};

/// The vertices joined to each vertex by an edge, in order.
std::vector<std::vector<int>> vertex_neighbours(const TriangleMesh& mesh);

/// Moves the vertices that violate their clearance inwards, their neighbours along, until none is left or
/// `rounds` are over. Returns how many vertices moved; `largest` is raised to the largest displacement, m.
int push_inside(ClearanceCheck& check, const std::vector<std::vector<int>>& neighbours,
                std::vector<Vec3>& vertices, int rounds, double& largest);

}  // namespace fascia::skull
