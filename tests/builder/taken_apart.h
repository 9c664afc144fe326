#pragma once

#include <functional>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::testing {

Vec3 middle_of(const TriangleMesh& mesh, const Triangle& t);

/// A mesh taken apart by a label a triangle: vertices of different labels are no longer shared.
std::vector<TriangleMesh> taken_apart(const TriangleMesh& mesh,
                                      const std::function<int(const Triangle&)>& label);

/// The parts in one list, none of their vertices shared.
TriangleMesh joined(const std::vector<TriangleMesh>& parts);

void turn_over(Triangle& t);

/// Every triangle once more, turned over, on the same vertices.
void add_backs(TriangleMesh& mesh);

}  // namespace fascia::testing
