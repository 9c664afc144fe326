#pragma once

#include <filesystem>

#include "anatomy/anatomy.h"

namespace fascia::rigging {

/// The generic head of `anatomy` as OBJ in millimetres, as a user would bring one: skin, eyes, teeth, gums
/// and tongue, lashes, with its material library and pictures in the same folder, and its landmarks.
void write_embedded_head(const anatomy::GenericAnatomy& anatomy, const std::filesystem::path& head,
                         const std::filesystem::path& landmarks);

/// The same of the built-in anatomy.
void write_embedded_head(const std::filesystem::path& head, const std::filesystem::path& landmarks);

}  // namespace fascia::rigging
