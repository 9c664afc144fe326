#include "view/text.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <stb/stb_truetype.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

extern "C" {
extern const unsigned char fascia_font_begin[];
}

namespace fascia::view {

namespace {

const stbtt_fontinfo& font() {
  static const stbtt_fontinfo info = [] {
    stbtt_fontinfo made;
    if (!stbtt_InitFont(&made, fascia_font_begin, 0)) throw Error("the built-in typeface is damaged");
    return made;
  }();
  return info;
}

/// The next character of UTF-8 text; a question mark for bytes that are none.
int next_character(const std::string& text, size_t& at) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned first = byte(at++);
  if (first < 0x80) return static_cast<int>(first);
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
  unsigned code = more ? first & (0x3FU >> more) : '?';
  for (int k = 0; k < more; ++k, ++at) {
    if ((byte(at) & 0xC0U) != 0x80U) return '?';
    code = code << 6 | (byte(at) & 0x3FU);
  }
  return static_cast<int>(code);
}

/// Scale at which capitals are `height` pixels high.
float scale_for(int height) {
  int left = 0, bottom = 0, right = 0, top = 1;
  stbtt_GetCodepointBox(&font(), 'H', &left, &bottom, &right, &top);
  return static_cast<float>(height) / static_cast<float>(top);
}

/// Calls `visit(character, x)` for each character at its place; returns where the next would stand.
template <class Visit>
float lay_out(const std::string& text, float scale, Visit visit) {
  float x = 0.0F;
  int before = 0;
  for (size_t at = 0; at < text.size();) {
    const int character = next_character(text, at);
    int advance, bearing;
    stbtt_GetCodepointHMetrics(&font(), character, &advance, &bearing);
    if (before) x += scale * static_cast<float>(stbtt_GetCodepointKernAdvance(&font(), before, character));
    visit(character, x);
    x += scale * static_cast<float>(advance);
    before = character;
  }
  return x;
}

void blend(Image& image, int x, int y, int coverage, Colour colour) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  uint8_t* pixel =
      &image.pixels[3 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x))];
  for (size_t k = 0; k < 3; ++k)
    pixel[k] = static_cast<uint8_t>((pixel[k] * (255 - coverage) + colour[k] * coverage + 127) / 255);
}

}  // namespace

void write_text(Image& image, const std::string& text, int x, int y, int height, Colour colour) {
  if (height < 1) return;
  const float scale = scale_for(height);
  lay_out(text, scale, [&](int character, float at) {
    const float start = static_cast<float>(x) + at, whole = std::floor(start);
    int left, top, right, bottom;
    stbtt_GetCodepointBitmapBoxSubpixel(&font(), character, scale, scale, start - whole, 0, &left, &top,
                                        &right, &bottom);
    const int width = right - left, rows = bottom - top;
    if (width < 1 || rows < 1) return;
    std::vector<unsigned char> coverage(static_cast<size_t>(width) * static_cast<size_t>(rows));
    stbtt_MakeCodepointBitmapSubpixel(&font(), coverage.data(), width, rows, width, scale, scale,
                                      start - whole, 0, character);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < width; ++column)
        blend(image, static_cast<int>(whole) + left + column, y + height + top + row,
              coverage[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column)],
              colour);
  });
}

int text_width(const std::string& text, int height) {
  return height < 1 ? 0 : static_cast<int>(std::ceil(lay_out(text, scale_for(height), [](int, float) {})));
}

}  // namespace fascia::view
