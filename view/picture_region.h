#pragma once

#include "view/light_passes.h"

namespace fascia::view {

/// A rectangle of a picture, pixels from its lower left corner.
struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// What surfaces and lines of a shot may cover, with a margin for the width of lines; all of the picture
/// where something lies behind the camera.
Rectangle covered(const Shot& shot);

/// Keeps what is drawn inside `at`, times `scale`, moved by x and y, until the next call or the end of the
/// picture. `margin`: pixels around, that filters may reach.
void keep_inside(const Rectangle& at, double scale, int x, int y, int margin = 0);

}  // namespace fascia::view
