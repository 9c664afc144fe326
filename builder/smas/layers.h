#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::smas {

/// Named points on the skin, metres; the names of anatomy/data/landmarks.json.
using Landmarks = std::map<std::string, Vec3>;

/// How deep the SMAS lies in the neighbourhood of one landmark (or of both of a pair).
struct LayerSample {
  std::string landmark;  ///< without side for a pair: "malare" stands for malare_left and malare_right
  double fraction;       ///< of the way from the skin to the bone
  double free_depth;     ///< metres under the skin of an adult where no bone limits it, or bone is far
};

/// The layer table of an adult face.
///
/// Skin and subcutaneous fat lie over the SMAS, so that its depth is the thickness of those two. They
/// are thin over galea, nose, lids and lips, and thick over the malar and nasolabial fat. The numbers are
/// rounded readings of the anatomical literature for an average adult: V. Mitz and M. Peyronie, "The
/// superficial musculo-aponeurotic system (SMAS) in the parotid and cheek area", Plast. Reconstr. Surg. 58,
/// 1976; J. Macchi et al., "Histotopographic study of the fibroadipose connective cheek system", Cells
/// Tissues Organs 191, 2010; and the depths of C. N. Stephan's tables.
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
