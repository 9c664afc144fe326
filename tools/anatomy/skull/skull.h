#pragma once

#include <string>
#include <vector>

#include "tools/anatomy/skull/figures.h"

namespace fascia::skull_maker {

struct Part {
  std::string name;
  TriangleMesh mesh;  ///< millimetres, frame of the generic head
};

/// `cranium`, `mandible`, `teeth_upper` and `teeth_lower`, each closed and symmetric about x = 0.
std::vector<Part> make_skull(const Figures& figures);

/// Writes an OBJ of one object a part, coordinates to a ten-thousandth of a millimetre.
void write_obj(const std::vector<Part>& parts, const std::string& path);

}  // namespace fascia::skull_maker
