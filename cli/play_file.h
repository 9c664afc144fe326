#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/common.h"
#include "cli/posing.h"

namespace fascia::cli {

struct PlayRequest {
  std::filesystem::path rig, curves, output;
  double frames_per_second = 60.0;
  std::string solver = "own", level;
};

struct PlayFigures {
  int frames = 0, resets = 0;
  double duration = 0.0;  ///< seconds
  size_t components = 0;
  double largest_error_mm = 0.0;
  double milliseconds_a_frame = 0.0;  ///< median of a step
  std::vector<std::string> matched, unmatched;
};

/// Simulates the rig along the curves and writes the input's file with at most 64 morph targets (principal
/// components of the motion), their weights over time, and the curves again as pointer channels.
PlayFigures play_file(const Common& common, const PlayRequest& request);

/// Curves loaded from a file.
class Curves {
 public:
  explicit Curves(const std::filesystem::path& path);
  double duration() const;
  const std::vector<std::string>& names() const { return names_; }
  /// Names that the face's rig has no channel or member for.
  std::vector<std::string> unmatched(const Face& face) const;
  void apply(double seconds, const Face& face) const;

 private:
  struct Release {
    void operator()(fascia_curves* curves) const { fascia_curves_release(curves); }
  };
  std::unique_ptr<fascia_curves, Release> curves_;
  std::vector<std::string> names_;
  double duration_ = 0.0;
};

}  // namespace fascia::cli
