#pragma once

#include "formats/scene.h"
#include "geometry/mesh.h"
#include "rig/write/write.h"

namespace fascia::rigging {

/// The scene as the glTF that will carry the rig.
///
/// GLB and glTF go on as they are. From OBJ, PLY and STL a glTF is made: one mesh an object, positions as
/// they stand in the file under one node that brings them to metres, +Y up; the file itself is kept in
/// the record, so that its vertex order, polygons, axes and units come back.
rig::GltfSource gltf_source(const formats::Scene& scene, const Mat4& input_to_metres);

}  // namespace fascia::rigging
