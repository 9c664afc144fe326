#pragma once

#include <string>

#include "view/image.h"

namespace fascia::view {

/// Writes one line of UTF-8 text with the top of its capitals at y, `height` pixels from there to the base
/// line, smooth-edged; what falls outside is cut off. The face is DejaVu Sans (Bitstream Vera licence), built
/// in.
void write_text(Image& image, const std::string& text, int x, int y, int height, Colour colour);

/// How wide it would be, pixels.
int text_width(const std::string& text, int height);

}  // namespace fascia::view
