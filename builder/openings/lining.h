#pragma once

#include <functional>
#include <vector>

#include "builder/openings/cut.h"

namespace fascia::openings {

/// Surface behind the edges of a cut: lips' and mouth's lining, or the conjunctiva. Its vertices are numbered
/// after the cut's.
struct Lining {
  std::vector<Vec3> vertices;  ///< metres
  std::vector<int>
      like;  ///< #vertices: the vertex of the rim that each one is nearest to, whose looks it takes
  std::vector<Triangle> triangles;  ///< facing the cavity
};

/// Places on a lining: ring 1 is the first behind the edges, `around` runs from 0 at the right corner over
/// the upper side to 1 at the left corner and back over the lower side to 2.
using RingPlace = std::function<Vec3(int ring, double around)>;

/// The edge that a lining hangs on, once around: from the right corner over the upper side to the left one
/// and back over the lower side. Vertices as the cut numbers them.
struct Rim {
  std::vector<int> vertices;
  std::vector<Vec3> places;    ///< metres
  std::vector<double> around;  ///< by length along each side: 0 at the right corner, 1 at the left, below 2
  /// The place at `around`.
  Vec3 at(double around) const;
};

/// The edges of a cut.
Rim rim_of(const TriangleMesh& mesh, const Cut& cut);

/// The border of a hole in the mesh, between the corners of `line`.
Rim rim_of(const TriangleMesh& mesh, const std::vector<int>& loop, const MeetingLine& line);

/// Spans `rings` rings of `columns` vertices behind `rim` and closes the last one at `end`. New vertices are
/// numbered from `first` on.
Lining span_lining(const Rim& rim, int first, int rings, int columns, const RingPlace& place,
                   const Vec3& end);

/// As many columns as keep the lining about as fine as its rim, within bounds.
int lining_columns(const Rim& rim);

}  // namespace fascia::openings
