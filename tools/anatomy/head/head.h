#pragma once

#include <iosfwd>

#include "tools/anatomy/head/figures.h"
#include "tools/anatomy/head/layout.h"

namespace fascia::head_maker {

/// A closed or open polygon surface with texture coordinates, as it is written.
struct PolygonMesh {
  std::string name;
  std::vector<Vec3> vertices;           ///< mm
  std::vector<std::vector<int>> faces;  ///< counter-clockwise from outside
  std::vector<Vec2> uv;
  std::vector<std::vector<int>> face_uv;  ///< indices into `uv`, one a corner
  std::vector<std::string> region;        ///< one a face
  std::map<std::string, std::vector<int>> loops;
};

/// Shape the left half of the skin from the figures.
HalfHead make_half(const Figures& figures);

/// Texture coordinates of the half, four a quad: the face as one island that meets its mirror image along the
/// midline u = 0.5, scalp and neck of a side beside it, ear, conjunctival sac, nostril and mouth lining above
/// it.
std::vector<std::array<Vec2, 4>> unwrap(const HalfHead& half);

/// The whole skin: the half and its mirror image, sharing the midline. Regions and loops ending in `_left`
/// get a
/// `_right` twin; loops that end on the midline are joined across it.
PolygonMesh mirrored(const HalfHead& half, const std::vector<std::array<Vec2, 4>>& uv);

/// The eyeballs: a sphere with a corneal bulge; regions sclera, iris and pupil.
PolygonMesh make_eyeball(const Figures& figures, bool left);

}  // namespace fascia::head_maker
