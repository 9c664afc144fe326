#pragma once

#include "formats/extend.h"

/// The writers of the formats; `formats::rewrite` chooses among them.
namespace fascia::formats::detail {

void rewrite_gltf(Scene& scene, const std::vector<MeshExtension>& extensions);
void rewrite_obj(Scene& scene, const std::vector<MeshExtension>& extensions);

}  // namespace fascia::formats::detail
