#include "builder/smas/layers.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::smas {

const std::vector<LayerSample>& adult_layers() {
  static const std::vector<LayerSample> table = {
      // Scalp and forehead: the galea and frontalis lie on a thin layer of fat.
      {"vertex", 0.60, 0.0040},
      {"trichion", 0.60, 0.0035},
      {"metopion", 0.60, 0.0033},
      {"glabella", 0.60, 0.0035},
      {"superciliare", 0.55, 0.0042},
      {"superciliare_laterale", 0.50, 0.0040},
      {"frontotemporale", 0.55, 0.0040},
      // Lids, from the fold to the margin.
      {"palpebrale_superius", 0.50, 0.0012},
      {"palpebrale_inferius", 0.50, 0.0013},
      {"sulcus_palpebralis_superior", 0.45, 0.0016},
      {"exocanthion", 0.50, 0.0018},
      {"endocanthion", 0.50, 0.0016},
      {"orbitale", 0.45, 0.0032},
      // Nose: thin over the bones, thick at the tip, cartilage and mucosa under the alae.
      {"nasion", 0.55, 0.0030},
      {"mid_nasal", 0.60, 0.0022},
      {"rhinion", 0.60, 0.0017},
      {"pronasale", 0.50, 0.0022},
      {"alare", 0.50, 0.0018},
      {"alar_groove", 0.50, 0.0018},
      {"columella", 0.50, 0.0018},
      // Lips.
      {"subnasale", 0.40, 0.0032},
      {"mid_philtrum", 0.40, 0.0033},
      {"labiale_superius", 0.35, 0.0030},
      {"labiale_superius_laterale", 0.35, 0.0030},
      {"labiale_inferius", 0.35, 0.0030},
      {"labiale_inferius_laterale", 0.35, 0.0030},
      {"cheilion", 0.35, 0.0036},
      {"modiolus", 0.35, 0.0050},
      // Cheek: malar and buccal fat over the SMAS, thinner over the parotid.
      {"alar_curvature", 0.40, 0.0050},
      {"zygomaxillare_skin", 0.45, 0.0070},
      {"malare", 0.50, 0.0062},
      {"buccale", 0.40, 0.0065},
      {"zygion", 0.50, 0.0042},
      {"mid_ramus", 0.35, 0.0055},
      {"preaurale", 0.40, 0.0045},
      // Chin, jaw and neck: platysma under the skin and its fat.
      {"sublabiale", 0.45, 0.0045},
      {"pogonion", 0.50, 0.0050},
      {"gnathion", 0.50, 0.0042},
      {"menton", 0.50, 0.0042},
      {"mid_mandibular_border", 0.45, 0.0048},
      {"gonion", 0.40, 0.0050},
      {"cervicale", 0.40, 0.0040},
  };
  return table;
}

LayerDepth::LayerDepth(const std::vector<LayerSample>& table, const Landmarks& landmarks, double scale)
    : reach_(0.012 * scale) {
  for (const LayerSample& sample : table)
    for (const char* side : {"", "_left", "_right"}) {
      const auto found = landmarks.find(sample.landmark + side);
      if (found == landmarks.end()) continue;
      if (!(sample.fraction > 0.0 && sample.fraction < 1.0) || !(sample.free_depth > 0.0))
        throw Error("SMAS: layer data at '" + sample.landmark + "': fraction must lie in (0, 1) and depth be positive");
      sites_.push_back({found->second, sample.fraction, sample.free_depth * scale});
    }
  if (sites_.empty()) throw Error("SMAS: no landmark of the layer table is known; give landmarks of the face");
}

double LayerDepth::depth(const Vec3& skin, double to_bone) const {
  // Shepard's inverse-distance weights, rounded at the sites so that regions blend into each other.
  double weights = 0.0, fraction = 0.0, free_depth = 0.0;
  for (const Site& site : sites_) {
    const double d2 = (site.at - skin).squaredNorm() + 0.1 * reach_ * reach_;
    const double w = 1.0 / (d2 * d2);
    weights += w;
    fraction += w * site.fraction;
    free_depth += w * site.free_depth;
  }
  fraction /= weights;
  free_depth /= weights;
  if (!std::isfinite(to_bone)) return free_depth;
  return std::clamp(std::min(fraction * to_bone, free_depth), 0.2 * to_bone, 0.8 * to_bone);
}

}  // namespace fascia::smas
