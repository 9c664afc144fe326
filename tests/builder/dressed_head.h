#pragma once

#include <filesystem>

namespace fascia::testing {

/// Writes the embedded head with what a character has besides its skin and teeth, as OBJ in millimetres, and
/// its landmarks: objects `eye_left`, `eye_right` (balls), `tongue` (a block in the mouth), `lashes` (cards
/// on the left upper lid, and one strip along it), `brows` (a card on the left brow), `hair` (a strand on the
/// crown), `moustache` (a strand on the upper lip).
void write_dressed_head(const std::filesystem::path& head, const std::filesystem::path& landmarks);

}  // namespace fascia::testing
