#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/landmarks/samples.h"

namespace fascia::landmarks {

/// Height of a surface above its surroundings at some points, at two scales (see likeness.h).
struct Relief {
  std::vector<double> fine, broad;
};

/// The generic head as it is registered to a mesh: points of its outer skin, dense around eyes, nose and
/// mouth.
struct GenericFace {
  Samples points;                         ///< metres, rig frame; mirror-symmetric about x = 0
  std::vector<int> mirror;                ///< the other side's point; a midline point's own index
  std::vector<double> weights;            ///< weight of a point in the registration: 1 face .. 0 neck
  std::vector<bool> is_face;              ///< in front of the ears, between hairline and chin
  std::vector<bool> is_feature;           ///< about eyes, nose and mouth
  Relief relief;                          ///< at `points`
  TriangleMesh skin;                      ///< the whole skin
  std::vector<std::string> region_names;  ///< lip_upper, mouth_lining, nostril_left, ...
  std::vector<int> region_of_triangle;    ///< of `skin`, index into `region_names`
  Ball eye_left, eye_right;               ///< eyeballs
  Vec3 nose_tip;                          ///< pronasale
  Ball vault;                             ///< sphere through the outer skin above the neck
};

/// Takes the points from the skin of `anatomy`'s head, its skin landmarks among them.
/// Throws fascia::Error when the anatomy has no skin.
GenericFace generic_face(const anatomy::GenericAnatomy& anatomy);

}  // namespace fascia::landmarks
