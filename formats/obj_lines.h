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

/// Where a `v` line of an OBJ file has its numbers.
struct ObjVertex {
  size_t line = 0;  ///< from 1, of the line's beginning
  std::array<std::pair<size_t, size_t>, 3>
      coordinates;  ///< begin and end of each coordinate's digits, bytes of the file
};

/// The `v` lines of an OBJ file, in order. Lines end with LF, CR or both; a backslash at a line's end folds
/// it into the next; a byte order mark at the beginning is passed over. Coordinates that are not there have
/// begin and end alike.
std::vector<ObjVertex> obj_vertices(std::string_view text);

/// The text with the `v` lines in `moved` (by number, from 0) put in new places, `decimals` behind the point,
/// and all else as it was.
std::string with_vertices(std::string_view text, const std::map<int, Vec3>& moved, int decimals);

/// The text with folded lines unfolded, the byte order mark gone and every line ended by LF, for readers that
/// know only those.
std::string plain_obj(std::string_view text);

}  // namespace fascia::formats
