#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/error.h"
#include "rig/model/rig.h"

namespace fascia::rig {

/// Thrown for a rig of an unknown version.
class VersionError : public Error {
 public:
  using Error::Error;
};

/// Thrown for a rig whose meshes have been changed since it was built.
class MismatchError : public Error {
 public:
  using Error::Error;
};

/// The source of a head that was not glTF, stored in the rig so that it can be restored.
struct SourceRecord {
  std::string format;          ///< gltf, glb, obj, ply or stl; empty when nothing is recorded
  std::string json;            ///< the writer's own notes (vertex order, polygons, axes, units)
  std::vector<uint8_t> bytes;  ///< the source file itself, or nothing

  bool operator==(const SourceRecord&) const = default;
};

/// The geometry of one primitive that the rig binds, in the primitive's own coordinates.
struct Primitive {
  uint32_t mesh = 0, primitive = 0;
  std::string name;  ///< of its mesh
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< #positions, or none when the file has none
  std::vector<Triangle> triangles;
  std::vector<Vec4f> tangents;  ///< #positions, xyz and handedness; or none when the file has none
  std::vector<Vec2f> texture;   ///< #positions, the first set of texture coordinates; or none
};

/// A rig file, read: the rig, the file's own JSON and binary chunk, and the geometry it binds.
struct RigFile {
  Rig rig;
  std::string json;          ///< JSON chunk as it is in the file
  std::vector<uint8_t> bin;  ///< binary chunk, as long as buffer 0 says
  SourceRecord source;
  std::vector<Primitive> primitives;  ///< in the order in which the levels' bindings first name them

  /// Position in `primitives` of a binding's geometry.
  std::size_t primitive_of(const Binding& binding) const;
};

/// True when the GLB file `bytes` names any of the FASCIA extensions.
bool is_rig(std::span<const uint8_t> bytes);

/// Reads a rig from the bytes of a GLB file (rig/spec has the format).
///
/// Every index, accessor and length is checked, numbers are finite, and each binding's fingerprint must
/// fit the primitive it names. Throws fascia::Error that begins with `name` and says which extension and
/// property is at fault: VersionError and MismatchError among others.
RigFile read(std::span<const uint8_t> bytes, const std::string& name = "rig");

}  // namespace fascia::rig
