#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::testing {

/// The embedded head as careless exporters, scanners and editors leave heads, or damaged beyond use.
struct BrokenHead {
  std::string kind;
  std::string file;  ///< a name with its extension
  std::vector<uint8_t> bytes;
  bool is_usable = true;  ///< a rig must come out; else it is to be refused
  std::vector<std::string>
      says;             ///< words, one of which a warning, or the refusal, must contain; may be empty
  bool is_cut = false;  ///< several vertices are in one place, which must not tear
  Mat4 to_file = Mat4::Identity();  ///< from the embedded head's axes and metres
};

/// All kinds there are, each made by chance as `seed` has it. Turned a little, of different units.
std::vector<std::string> broken_kinds();
BrokenHead broken_head(const std::string& kind, unsigned seed);

}  // namespace fascia::testing
