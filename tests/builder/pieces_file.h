#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::testing {

/// A mesh and the node that shows it.
struct Piece {
  std::string name;
  TriangleMesh mesh;
  Vec3 scale = Vec3::Ones();  ///< of the node
};

/// The pieces as a .glb file, a mesh and a node each. Numbers that are none, and corners that are not there,
/// are written as they are.
std::vector<uint8_t> glb_of(const std::vector<Piece>& pieces);

}  // namespace fascia::testing
