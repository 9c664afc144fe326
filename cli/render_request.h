#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "view/renderer.h"

namespace fascia::cli {

/// What `fascia render` is asked for, as given on the command line.
struct RenderRequest {
  std::filesystem::path rig, output, file, curves;
  std::vector<std::string> set;
  std::string layers = "skin,eyes", muscles, view = "front", solver = "own", level;
  std::string size = "900", background = "studio", camera, look_at, light = "studio", reveal,
              colours = "flesh";
  std::optional<double> at;
  double frames_per_second = 30.0;
  int samples = 0;  ///< a pixel; 0: 8, or 2 for films
  bool is_beside_rest = false, is_plain = false;
};

struct PictureSize {
  int width = 0, height = 0;
};

/// "900" or "1280x720". Throws fascia::Error for what is neither, and for sides outside 16 to 8192.
PictureSize size_from(const std::string& text);

/// The finish of a picture: `background` is studio, or white, black or #RRGGBB. Throws fascia::Error for
/// another word and for an unknown light.
view::Look look_from(const RenderRequest& request);

/// Views with commas between: front, side, right, three-quarter, back.
std::vector<std::string> views_from(const std::string& list);

/// The camera of a named view that frames `box` in a picture of that size, or looks at what the request says,
/// turned and brought nearer as the request says. Throws fascia::Error for numbers that are none.
view::Camera camera_for(const std::string& view, const RenderRequest& request, const Bounds& box,
                        PictureSize size);

/// The half space whose skin `reveal` (left, right: the subject's; top, bottom; empty: none) takes away.
std::optional<Eigen::Vector4d> reveal_from(const std::string& reveal, const Bounds& box);

}  // namespace fascia::cli
