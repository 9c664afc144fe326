#pragma once

#include "gltf/edit/document.h"

/// Compressed geometry in a joined document (every range lies in buffer 0, which is `bin`) made plain: the
/// unpacked data are appended to `bin`, views and accessors are pointed there, and the extension leaves the
/// file.
namespace fascia::gltf {

inline const char* const meshopt_extension = "EXT_meshopt_compression";
inline const char* const draco_extension = "KHR_draco_mesh_compression";

/// True when the file uses either extension.
bool is_compressed(const Json& root);

/// Removes `extension` from extensionsUsed and extensionsRequired, and the lists when they are then empty.
void forget_extension(Json& root, const std::string& extension);

/// Unpacks the buffer views of EXT_meshopt_compression. Throws fascia::Error naming the view when its data
/// are damaged, or promise more than they can hold.
void undo_meshopt(Json& root, std::vector<uint8_t>& bin);

/// Unpacks the primitives of KHR_draco_mesh_compression. Throws fascia::Error naming mesh and primitive.
void undo_draco(Json& root, std::vector<uint8_t>& bin);

}  // namespace fascia::gltf
