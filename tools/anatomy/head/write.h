#pragma once

#include "tools/anatomy/head/head.h"

namespace fascia::head_maker {

/// Write head.obj (one object a mesh, one group a region, quads, texture coordinates, smooth shading) and
/// head_regions.json (faces of every region, vertices of every loop, both counted from 0 within their object)
/// to `folder`. Throws `fascia::Error` when a file cannot be written.
void write_head(const std::vector<PolygonMesh>& meshes, const std::string& folder);

}  // namespace fascia::head_maker
