#include "view/image.h"

#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "formats/files.h"
#include "geometry/error.h"
#include "view/text.h"

namespace {

/// What stb's writer calls to compress a picture's rows. zlib at a low level is several times as fast as
/// stb's own.
unsigned char* deflated(unsigned char* data, int size, int* compressed_size, int /*quality*/) {
  constexpr int level = 3;
  uLongf bytes = compressBound(static_cast<uLong>(size));
  auto* out = static_cast<unsigned char*>(std::malloc(bytes));  // stb frees it
  if (!out || compress2(out, &bytes, data, static_cast<uLong>(size), level) != Z_OK) {
    std::free(out);
    return nullptr;
  }
  *compressed_size = static_cast<int>(bytes);
  return out;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS deflated
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace fascia::view {

Image::Image(int image_width, int image_height, Colour background)
    : width(image_width), height(image_height) {
  pixels.resize(static_cast<size_t>(width) * static_cast<size_t>(height) * 3);
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = background[i % 3];
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const std::vector<uint8_t> bytes = encode_png(image);
  formats::write_bytes(path, bytes.data(), bytes.size());
}

std::vector<uint8_t> encode_png(const Image& image) {
  std::vector<uint8_t> bytes;
  const auto add = [](void* target, void* data, int size) {
    const auto* first = static_cast<const uint8_t*>(data);
    auto* out = static_cast<std::vector<uint8_t>*>(target);
    out->insert(out->end(), first, first + size);
  };
  if (!stbi_write_png_to_func(add, &bytes, image.width, image.height, 3, image.pixels.data(),
                              image.width * 3))
    throw Error("a picture of " + std::to_string(image.width) + " by " + std::to_string(image.height) +
                " pixels cannot be written as PNG");
  return bytes;
}

void paste(Image& target, const Image& source, int x, int y) {
  const int first = std::max(0, -x), last = std::min(source.width, target.width - x);
  if (first >= last) return;
  for (int row = std::max(0, -y); row < std::min(source.height, target.height - y); ++row) {
    const size_t from =
        3 * (static_cast<size_t>(row) * static_cast<size_t>(source.width) + static_cast<size_t>(first));
    const size_t to = 3 * (static_cast<size_t>(row + y) * static_cast<size_t>(target.width) +
                           static_cast<size_t>(first + x));
    std::memcpy(&target.pixels[to], &source.pixels[from], 3 * static_cast<size_t>(last - first));
  }
}

void write_label(Image& image, const std::string& text, int x, int y, int scale, Colour colour) {
  write_text(image, text, x, y, 5 + 4 * scale, colour);
}

Image contact_sheet(const std::vector<Tile>& tiles, int columns) {
  if (tiles.empty()) return {};
  const int gap = 6, width = tiles[0].image.width;
  const int text = std::clamp(width / 34, 8, 20), caption_height = 2 * text + 4;
  const int height = tiles[0].image.height + caption_height;
  const int rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
  Image sheet(columns * (width + gap) + gap, rows * (height + gap) + gap, {24, 26, 30});
  for (size_t i = 0; i < tiles.size(); ++i) {
    const int x = gap + static_cast<int>(i) % columns * (width + gap),
              y = gap + static_cast<int>(i) / columns * (height + gap);
    paste(sheet, tiles[i].image, x, y);
    // Long captions are written smaller.
    int size = text;
    while (size > 6 && text_width(tiles[i].caption, size) > width - 12)
      --size;
    write_text(sheet, tiles[i].caption, x + 6, y + tiles[i].image.height + (caption_height - size) / 2, size,
               {222, 224, 228});
  }
  return sheet;
}

}  // namespace fascia::view
