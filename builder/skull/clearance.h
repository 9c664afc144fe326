#pragma once

#include <span>
#include <vector>

#include "builder/skull/exterior.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// Where bone comes nearer to the outer skin than it may.
struct Violation {
  int vertex = 0;
  double missing = 0;          ///< m to move to reach the clearance
  Vec3 inward = Vec3::Zero();  ///< unit, away from the skin
  bool outside = false;        ///< outside the skin altogether
};

/// Soft-tissue depth of the generic at `points` on its bone, m: interpolated from the landmarks' depths by
/// inverse distance, and no more than the distance to the generic skin where there is one.
std::vector<double> depth_field(const Generic& generic, std::span<const Vec3> points);

/// Clearance asked of each point: `options.clearance_share` of the scaled depth, at least the floor.
std::vector<double> clearances(std::span<const double> depths, const FitOptions& options);

/// Checks moving vertices against the outer skin again and again. Distances change no faster than vertices
/// move, so a vertex that was deep enough is not measured again until it could have come near.
class ClearanceCheck {
 public:
  ClearanceCheck(const Exterior& skin, std::vector<double> clearance);

  /// The vertices nearer to the outer skin than their clearance, in order.
  std::vector<Violation> operator()(std::span<const Vec3> vertices);

  const std::vector<double>& clearance() const { return clearance_; }

 private:
  const Exterior* skin_;
  std::vector<double> clearance_;
  std::vector<Vec3> measured_at_;
  std::vector<double> measured_;  // signed distance there
};

/// Moves the vertices of `mesh` that violate their clearance inwards, their neighbours along, until none is
/// left or `rounds` are over. Returns how many vertices moved; `largest` is raised to the largest
/// displacement, m.
int push_inside(ClearanceCheck& check, TriangleMesh& mesh, int rounds, double& largest);

}  // namespace fascia::skull
