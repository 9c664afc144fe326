#include <algorithm>

#include "view/face/appearance.h"

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STB_IMAGE_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace fascia::view {

namespace {

/// Half as wide and high, each pixel the mean of four.
void halve(Texture& texture) {
  const int width = std::max(1, texture.width / 2), height = std::max(1, texture.height / 2);
  std::vector<uint8_t> pixels(static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
  const auto at = [&](int x, int y, int k) -> int {
    x = std::min(x, texture.width - 1);
    y = std::min(y, texture.height - 1);
    return texture
        .pixels[4 * (static_cast<size_t>(y) * static_cast<size_t>(texture.width) + static_cast<size_t>(x)) +
                static_cast<size_t>(k)];
  };
  size_t out = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < 4; ++k)
        pixels[out++] = static_cast<uint8_t>((at(2 * x, 2 * y, k) + at(2 * x + 1, 2 * y, k) +
                                              at(2 * x, 2 * y + 1, k) + at(2 * x + 1, 2 * y + 1, k) + 2) /
                                             4);
  texture.width = width;
  texture.height = height;
  texture.pixels = std::move(pixels);
}

}  // namespace

std::shared_ptr<Texture> decode_texture(std::span<const uint8_t> bytes, bool is_srgb, int largest) {
  int width = 0, height = 0, channels = 0;
  if (bytes.size() > size_t{1} << 30) return nullptr;
  const int size = static_cast<int>(bytes.size());
  // A few bytes may promise a picture that fills the memory.
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) || width > 16384 ||
      height > 16384)
    return nullptr;
  stbi_uc* pixels = stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4);
  if (!pixels) return nullptr;
  auto texture = std::make_shared<Texture>();
  texture->width = width;
  texture->height = height;
  texture->is_srgb = is_srgb;
  texture->pixels.assign(pixels, pixels + static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
  stbi_image_free(pixels);
  while (std::max(texture->width, texture->height) > std::max(1, largest))
    halve(*texture);
  return texture;
}

}  // namespace fascia::view
