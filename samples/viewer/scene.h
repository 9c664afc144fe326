#pragma once

#include <fascia/fascia.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// Throws with the library's message unless `result` is FASCIA_OK.
void check(fascia_result result, const std::string& what);

struct Release {
  void operator()(fascia_asset* asset) const { fascia_asset_release(asset); }
  void operator()(fascia_face* face) const { fascia_face_release(face); }
  void operator()(fascia_curves* curves) const { fascia_curves_release(curves); }
};

template <class T>
T described() {
  T value = {};
  value.struct_size = sizeof value;
  return value;
}

/// A rig with one face of it, the curves that drive it and the clock.
struct Scene {
  Scene(const std::string& rig, const std::string& curves);

  /// Lets `seconds` pass: moves the clock, applies the curves, steps the face.
  void advance(double seconds);

  std::unique_ptr<fascia_asset, Release> asset;
  std::unique_ptr<fascia_face, Release> face;
  std::unique_ptr<fascia_curves, Release> curves;  ///< null when there are none
  fascia_asset_info info = described<fascia_asset_info>();
  fascia_channels channels = described<fascia_channels>();
  fascia_fibres fibres = described<fascia_fibres>();
  std::vector<fascia_mesh_info> meshes;
  std::vector<fascia_set_info> sets;
  std::vector<std::vector<float>> members;  ///< values of each set's members, as the sliders show them

  double time = 0, duration = 0;  ///< seconds, of the curves
  bool playing = false;
};
