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
/// A scene that lies far from the origin is put there, and the record's notes say where it was.
rig::GltfSource gltf_source(const formats::Scene& scene, const Mat4& input_to_metres,
                            std::vector<std::string>* warnings = nullptr);

/// Where the input's coordinates had their origin, as seen from the rig's: what is written back is moved by
/// it, in the input's units. Zero unless the input lay far off.
Vec3 input_offset(const rig::SourceRecord& record);

}  // namespace fascia::rigging
