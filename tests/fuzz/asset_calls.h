#pragma once

#include <fascia/fascia.h>
#include <fascia/research.h>

#include <cmath>
#include <string>

#include "tests/fuzz/input.h"

// Calls that ask an asset, and curves on a face.
namespace fascia::fuzz {

/// A structure that the library fills, at times of a size it does not know.
template <class Info>
Info sized(Input& input) {
  Info info = {};
  info.struct_size = input.byte() % 8 ? static_cast<uint32_t>(sizeof info) : input.byte();
  return info;
}

inline void call_asset(Input& input, const fascia_asset* asset) {
  static const char* const names[] = {
      "zygomaticus_major_left", "jaw_open", "arkit:jawOpen", "cranium", "smas", ""};
  const char* const name = names[input.byte() % 6];
  uint32_t set = 0, member = 0;
  switch (input.byte() % 10) {
    case 0: {
      auto info = sized<fascia_asset_info>(input);
      fascia_asset_get_info(asset, &info);
      break;
    }
    case 1: {
      auto info = sized<fascia_level_info>(input);
      fascia_asset_get_level(asset, input.index(), &info);
      break;
    }
    case 2: {
      auto info = sized<fascia_mesh_info>(input);
      fascia_asset_get_mesh(asset, input.index(), &info);
      break;
    }
    case 3: {
      auto channels = sized<fascia_channels>(input);
      fascia_asset_get_channels(asset, &channels);
      break;
    }
    case 4: {
      auto info = sized<fascia_set_info>(input);
      fascia_asset_get_set(asset, input.index(), &info);
      break;
    }
    case 5:
      fascia_asset_find_channel(asset, name);
      fascia_asset_find_member(asset, name, &set, &member);
      break;
    case 6: {
      auto surface = sized<fascia_surface>(input);
      fascia_asset_surface(asset, name, &surface);
      break;
    }
    case 7: {
      auto fibres = sized<fascia_fibres>(input);
      fascia_asset_fibres(asset, input.index(), &fibres);
      break;
    }
    case 8: {
      auto texcoords = sized<fascia_vectors>(input);
      fascia_asset_texcoords(asset, input.index(), &texcoords);
      break;
    }
    default: {
      auto lattice = sized<fascia_lattice>(input);
      fascia_asset_lattice(asset, input.index(), &lattice);
      if (fascia_result_name(static_cast<fascia_result>(input.index())) == nullptr) __builtin_trap();
      break;
    }
  }
}

/// Curves of two channels with odd numbers, applied at odd times.
inline void call_curves(Input& input, const fascia_asset* asset, fascia_face* face) {
  std::string text = "time,jaw_open,nothing,headYaw\n";
  double time = 0.0;
  for (int row = input.byte() % 4; row >= 0; --row) {
    text += std::to_string(time) + "," + std::to_string(input.value()) + ",0," +
            std::to_string(input.value()) + "\n";
    time += std::abs(input.value());
  }
  fascia_curves* curves = nullptr;
  const fascia_curves_options options = {sizeof options, 0, input.byte() % 4 ? 0.0 : input.value(), 0.0};
  if (fascia_curves_load_as(text.data(), text.size(), &options, &curves) != FASCIA_OK) return;
  uint32_t count = 0;
  fascia_curves_match(curves, asset, &count, nullptr);
  float turn[4] = {};
  fascia_curves_head(curves, input.value(), turn);
  for (const float value : turn)
    if (!std::isfinite(value)) __builtin_trap();
  fascia_curves_apply(curves, input.value(), input.value(), face);
  fascia_curves_apply_to_layer(curves, input.value(), input.value(), face, input.index());
  fascia_curves_release(curves);
}

}  // namespace fascia::fuzz
