#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "rig/model/rig.h"

namespace fascia::testing {

/// Sides as in rig::TissueLevel::facing_side; what belongs to no lip or lid is `no_side`.
inline constexpr uint8_t no_side = 255;

/// Which lip or lid each column of `level` belongs to: those the lattice says may touch, and `rings` rows
/// around the lips, so that their corners are shared out between both sides.
std::vector<uint8_t> column_sides(const rig::TissueLevel& level, int rings);

/// The same of a mesh's vertices, by the columns they follow most.
std::vector<uint8_t> vertex_sides(const rig::Binding& binding, const rig::TissueLevel& level);

/// Finds where a lip or lid has passed through the one it faces.
///
/// A vertex has crossed when it lies behind the nearest place of the facing side, their normals opposed; its
/// depth is the distance to that place, less what it was at rest.
class Crossings {
 public:
  /// `mesh` at rest, metres; `sides` one a vertex. Vertices in one place count as one.
  Crossings(const TriangleMesh& mesh, const std::vector<uint8_t>& sides);

  struct Worst {
    double depth = 0.0;  ///< metres
    int count = 0;       ///< vertices deeper than the tolerance
    Vec3 place = Vec3::Zero();
    void take(const Worst& other) {
      count += other.count;
      if (other.depth <= depth) return;
      depth = other.depth;
      place = other.place;
    }
  };
  /// Deepest crossing between sides 2 `opening` and 2 `opening` + 1 (0 lips, 1 left lids, 2 right lids) as
  /// the mesh's vertices now stand.
  Worst find(const std::vector<Vec3>& vertices, int opening, double tolerance) const;

 private:
  std::vector<double> depths(const std::vector<Vec3>& vertices, int opening) const;

  TriangleMesh welded_;
  std::vector<int> source_;  ///< of each welded vertex
  std::vector<uint8_t> sides_;
  std::vector<std::vector<double>> at_rest_;  ///< by opening, #welded
};

}  // namespace fascia::testing
