#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Pictures of heads, skulls, fibres and expressions, with a display or without.
namespace fascia::view {

using Colour = std::array<uint8_t, 3>;

/// An RGB picture, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> pixels;  ///< width * height * 3

  Image() = default;
  Image(int width, int height, Colour background);
};

/// Writes a PNG file, whole or not at all, into a folder that is there. Throws fascia::Error when it cannot.
void write_png(const std::filesystem::path& path, const Image& image);

/// The bytes of a PNG file. Throws fascia::Error when the picture is empty.
std::vector<uint8_t> encode_png(const Image& image);

/// Copies `source` into `target` with its top left corner at (x, y); what falls outside is cut off.
void paste(Image& target, const Image& source, int x, int y);

/// Writes one line of text with its top left corner at (x, y), capitals 5 + 4 * `scale` pixels high.
void write_label(Image& image, const std::string& text, int x, int y, int scale, Colour colour);

/// A tile of a contact sheet.
struct Tile {
  Image image;
  std::string caption;
};

/// Tiles of equal size in rows of `columns`, each with its caption below.
Image contact_sheet(const std::vector<Tile>& tiles, int columns);

}  // namespace fascia::view
