#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "geometry/mesh.h"

namespace fascia::smas {

/// Named points on the skin, metres; the names of anatomy/data/landmarks.json.
using Landmarks = std::map<std::string, Vec3>;

/// How deep the SMAS lies near one landmark.
using LayerSample = anatomy::SmasDepth;

/// The layer table of an adult face.
///
/// Skin and subcutaneous fat lie over the SMAS, so that its depth is the thickness of those two. They
/// are thin over galea, nose, lids and lips, and thick over the malar and nasolabial fat. The numbers and
/// their sources are the `smas_depths` of anatomy/data/tissue.json.
const std::vector<LayerSample>& adult_layers();

/// Depth of the SMAS at any point of the skin, interpolated between the landmarks of a layer table.
class LayerDepth {
 public:
  /// `scale`: size of this face relative to an adult's; free depths are multiplied by it.
  /// @throws Error when none of the table's landmarks is there.
  LayerDepth(const std::vector<LayerSample>& table, const Landmarks& landmarks, double scale);

  /// Depth under skin point `skin`, metres, when bone lies `to_bone` under it (infinite: none).
  /// The regional fraction of `to_bone`, no more than the free depth, within [.2, .8] of `to_bone`.
  double depth(const Vec3& skin, double to_bone) const;

 private:
  struct Site {
    Vec3 at;
    double fraction, free_depth;
  };
  std::vector<Site> sites_;
  double reach_;
};

}  // namespace fascia::smas
