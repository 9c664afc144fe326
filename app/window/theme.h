#pragma once

#include <imgui.h>

namespace fascia::app {

/// The window's colours, in a dark and a light dress.
struct Palette {
  ImVec4 window, panel, raised, hover, line, text, faint, accent, accent_text, left, right, good, warning,
      bad;
  ImVec4 viewport;
};

/// The palette in use.
const Palette& palette();

struct Fonts {
  ImFont *text = nullptr, *bold = nullptr, *small = nullptr, *large = nullptr, *title = nullptr;
};
const Fonts& fonts();

/// Loads the fonts (Lato, else DejaVu Sans, else the built-in one) and sets colours, spacing and rounding,
/// all times `scale`. To be called between frames; the caller renews the font texture.
void apply_theme(bool is_light, float scale);

/// The scale in use: lengths in panels are given for 1 and multiplied by it.
float ui_scale();
inline float scaled(float length) {
  return length * ui_scale();
}

ImU32 colour_of(const ImVec4& colour, float opacity = 1.0F);

}  // namespace fascia::app
