#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::formats {

/// The location of a `v` line of an OBJ file and of its numbers.
struct ObjVertex {
  size_t line = 0;  ///< of the beginning of the line, from 1
  std::array<std::pair<size_t, size_t>, 3>
      coordinates;  ///< begin and end of each coordinate's digits, in bytes
};

/// The `v` lines of an OBJ file, in order. Lines end with LF, CR or both; a backslash at the end of a line
/// continues it; a leading byte order mark is skipped. Missing coordinates have equal begin and end.
std::vector<ObjVertex> obj_vertices(std::string_view text);

/// The text with new coordinates for the `v` lines in `moved` (by number, from 0), with `decimals` decimal
/// places; everything else is unchanged.
std::string with_vertices(std::string_view text, const std::map<int, Vec3>& moved, int decimals);

/// The text with continued lines joined, without a byte order mark and with LF line ends, for readers that
/// require this.
std::string plain_obj(std::string_view text);

}  // namespace fascia::formats
