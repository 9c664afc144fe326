#pragma once

#include <map>
#include <optional>
#include <string>

#include "check/head.h"
#include "geometry/landmarks.h"

namespace fascia::check {

/// Reference lengths of motions: size of this face and its parts relative to an adult's.
struct Sizes {
  double face = 1.0;   ///< spread of the landmarks of face, against the adult mean
  double mouth = 1.0;  ///< width of the mouth likewise
  double eye = 1.0;    ///< width of the palpebral fissures likewise
};

/// An adult's distances, metres (anatomy/data/checks.json).
struct AdultSizes {
  double face =
      0.0;  ///< mean distance of both exocanthia, both cheilia, sellion and gnathion from their middle
  double mouth = 0.0;  ///< between the cheilia
  double eye = 0.0;    ///< from endocanthion to exocanthion
};

/// The same distances of the face with these landmarks; 0 where landmarks are missing.
AdultSizes distances(const Landmarks& landmarks);

/// Sizes of the face against an adult's; 1 where landmarks are missing.
Sizes sizes(const Landmarks& landmarks, const AdultSizes& adult);

/// The eye of one side as the measures use it: the rig's own, or, where that has none or one that cannot lie
/// behind these lids, a globe where an adult's would be. Nothing without canthi.
std::optional<Eye> plausible_eye(const Head& head, bool left);

}  // namespace fascia::check
