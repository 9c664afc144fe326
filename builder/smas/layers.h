#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::smas {

/// How deep the SMAS lies near one landmark.
using LayerSample = anatomy::SmasDepth;

/// Depth of the SMAS at any point of the skin, interpolated between the landmarks of a layer table.
class LayerDepth {
 public:
  /// `table`: an adult's `anatomy::Tissue::smas_depths`. `scale`: size of this face relative to an adult's;
  /// free depths are multiplied by it. @throws Error if none of the table's landmarks is given.
  LayerDepth(const std::vector<LayerSample>& table, const anatomy::mechanics::SmasShape& shape,
             const Landmarks& landmarks, double scale);

  /// Depth under skin point `skin`, metres, when bone lies `to_bone` under it (infinite: none).
  /// The regional fraction of `to_bone`, no more than the free depth, within the depth limits.
  double depth(const Vec3& skin, double to_bone) const;

  /// Least and greatest depth on the way from skin to bone.
  const anatomy::Ramp& limits() const { return limits_; }

 private:
  struct Site {
    Vec3 at;
    double fraction, free_depth;
  };
  std::vector<Site> sites_;
  anatomy::Ramp limits_;
  double reach_;
};

}  // namespace fascia::smas
