#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/reconstruction/skull_registration.h"
#include "builder/skull/skull.h"
#include "geometry/landmarks.h"

namespace fascia::reconstruction {

/// A landmark of the skull and the skin that the depth table puts over it. The scan's axes and units.
struct SkinOverBone {
  std::string name;
  Vec3 bone = Vec3::Zero(), skin = Vec3::Zero();
  double depth = 0.0, deviation = 0.0;  ///< mean and standard deviation between people, metres
  double residual = 0.0;                ///< of the registered bone from the scan, metres; infinite: not met
  bool given = false;                   ///< its bone point, by the user
};

/// Which depths to put over the bone.
struct DepthChoice {
  std::string table;          ///< name of a tissue depth table; empty: the default one
  double tissue_scale = 1.0;  ///< scales every depth
  double deviations = 0.0;    ///< standard deviations added to every mean depth
};

/// The map from the generic head, its own frame, to the head over `skull`, in the frame of
/// `skull.fit.placement`'s generic side: one smoothed thin plate through skin put over landmarks at the
/// table's depth (weighted by its deviation) and over some hundred other places of the bone at the generic
/// head's own depth there, corrected as the table corrects its neighbours. About the eyes it is a similarity,
/// so that eyeballs stay round and lids stay on them. `metres`: a unit of the scan's length.
skull::BoneMap skin_map(const anatomy::GenericAnatomy& anatomy, const SkullRegistration& skull, double metres,
                        const Landmarks& known, const DepthChoice& choice,
                        std::vector<SkinOverBone>* landmarks = nullptr);

}  // namespace fascia::reconstruction
