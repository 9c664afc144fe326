// Rig files. What is taken by the reader or by the plugin can be posed and stepped, and all positions are
// finite. To get past the header, the input may be a change to a sound rig: pairs of places and bytes.
#include <fascia/fascia.h>

#include <cmath>
#include <cstring>

#include "geometry/error.h"
#include "rig/read/read.h"
#include "tests/rig/tiny_rig.h"

namespace {

/// A sound rig with some of its bytes replaced: four bytes of place, one of value.
std::vector<uint8_t> changed(const uint8_t* bytes, size_t size) {
  static const std::vector<uint8_t> sound = fascia::test::tiny_rig_file();
  std::vector<uint8_t> rig = sound;
  for (size_t i = 0; i + 5 <= size; i += 5) {
    uint32_t place = 0;
    std::memcpy(&place, bytes + i, 4);
    rig[place % rig.size()] = bytes[i + 4];
  }
  return rig;
}

void expect_finite(fascia_face* face, uint32_t meshes) {
  for (uint32_t mesh = 0; mesh < meshes; ++mesh) {
    fascia_vectors positions = {};
    positions.struct_size = sizeof positions;
    if (fascia_face_positions(face, mesh, &positions) != FASCIA_OK) __builtin_trap();
    for (uint32_t i = 0; i < 3 * positions.count; ++i)
      if (!std::isfinite(positions.data[i])) __builtin_trap();
  }
}

/// Moves every channel of the rig's face, by the middle of its range.
void play(fascia_asset* asset) {
  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  fascia_channels channels = {};
  channels.struct_size = sizeof channels;
  fascia_face* face = nullptr;
  if (fascia_asset_get_info(asset, &info) != FASCIA_OK ||
      fascia_asset_get_channels(asset, &channels) != FASCIA_OK)
    __builtin_trap();
  if (fascia_face_create(asset, nullptr, &face) != FASCIA_OK) return;
  expect_finite(face, info.mesh_count);
  for (uint32_t c = 0; c < channels.count; ++c)
    fascia_face_values(face)[c] = 0.5F * (channels.minimum[c] + channels.maximum[c]);
  fascia_face_pose(face);
  expect_finite(face, info.mesh_count);
  for (int frame = 0; frame < 3; ++frame)
    fascia_face_step(face, 1.0F / 60.0F);
  expect_finite(face, info.mesh_count);
  fascia_face_release(face);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size < 1) return 0;
  const std::vector<uint8_t> rig =
      bytes[0] % 2 ? changed(bytes + 1, size - 1) : std::vector<uint8_t>(bytes + 1, bytes + size);
  try {
    fascia::rig::read(rig, "input");
  } catch (const fascia::Error&) {
  }
  fascia_asset* asset = nullptr;
  if (fascia_asset_load(rig.data(), rig.size(), &asset) == FASCIA_OK)
    play(asset);
  else if (fascia_last_message()[0] == 0)
    __builtin_trap();
  fascia_asset_release(asset);
  return 0;
}
