#pragma once

#include <vector>

#include "view/scene.h"

namespace fascia::view {

/// The tissue as it is simulated, where it stands: columns of three nodes, on the skin, on the SMAS and
/// beneath it. Node `layer * columns + column`.
struct Lattice {
  size_t columns = 0;
  std::vector<Vec3> nodes;       ///< 3 * columns, m
  std::vector<Triangle> prisms;  ///< columns, counter-clockwise from outside

  bool empty() const { return columns == 0 || nodes.size() != 3 * columns; }
};

/// The subcutaneous fat's outer face: under the dermis, between the nodes of skin and SMAS. Without triangles
/// where the lattice is empty.
DrawSurface fat_surface(const Lattice& lattice);

/// Its layers' edges and its columns as lines, a colour each: skin, SMAS, columns.
void add_lattice(const Lattice& lattice, DrawList& list);

}  // namespace fascia::view
