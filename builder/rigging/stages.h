#pragma once

#include <map>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/landmarks/skin_landmark.h"
#include "builder/prepare/prepare.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/skull/skull.h"
#include "builder/smas/smas.h"
#include "builder/tissue/inputs.h"
#include "geometry/landmarks.h"
#include "rig/model/rig.h"

/// Adapters between the stages: each converts the results of previous stages to the inputs of the next one,
/// or to the rig.
namespace fascia::rigging {

using SkinLandmarks = std::map<std::string, landmarks::SkinLandmark>;
/// Cuts open closed lips and lids of the head in `found` according to `options`, and updates it.
openings::OpenedHead open_head(const formats::Scene& scene, FoundLandmarks& found,
                               const anatomy::GenericAnatomy& anatomy, const BuildOptions& options);

/// Adds the fitted skull's teeth to a head without any where its lips were parted, or as `options` ask,
/// writes the figures of what was parted and added, and lays out the file anew where anything changed.
void close_openings(openings::OpenedHead& opened, prepare::PreparedHead& head, const skull::FitResult& skull,
                    const BuildOptions& options, BuildReport& report);

/// Fits the generic skull under the head's skin; teeth the head has serve as evidence. The jaw's hinge stands
/// across the plane between the face's sides, where there is one.
skull::FitResult fit_skull(const anatomy::GenericAnatomy& anatomy, const FoundLandmarks& found,
                           double tissue_scale);

/// Lays all muscles of `anatomy` as `edits` ask and adds their figures and warnings to `report`.
std::vector<rig::Muscle> build_muscles(const anatomy::GenericAnatomy& anatomy,
                                       const prepare::PreparedHead& head, const skull::FitResult& skull,
                                       const smas::Result& smas, const Landmarks& landmarks,
                                       const Edits& edits, BuildReport& report);

rig::Skull rig_skull(const skull::FitResult& skull, const prepare::PreparedHead& head,
                     const SkinLandmarks& landmarks);

/// The SMAS with the attachment zones and ligaments of the anatomy carried over to this head.
rig::Smas rig_smas(const smas::Result& smas, const skull::FitResult& skull,
                   const anatomy::GenericAnatomy& anatomy);

/// Channels and vocabularies; wholes such as orbicularis_oculi_left become the set `whole`.
rig::Actuation rig_actuation(const anatomy::GenericAnatomy& anatomy, const std::vector<rig::Muscle>& muscles);

/// What the lattice is made from: the stages before, the parts of the scene, and the anatomy's constants.
tissue::TissueInputs tissue_inputs(const formats::Scene& scene, const prepare::PreparedHead& head,
                                   const skull::FitResult& skull, const smas::Result& smas,
                                   const Landmarks& landmarks, const anatomy::Mechanics& mechanics,
                                   const rig::Rig& rig);

/// Makes the lattice levels up to `options.detail` from `tissue_inputs` and binds every primitive of the
/// scene.
rig::Tissue build_tissue(const formats::Scene& scene, const prepare::PreparedHead& head,
                         const tissue::TissueInputs& inputs, const BuildOptions& options,
                         BuildReport& report);

/// `mesh` in the rig's single precision.
rig::Surface rig_surface(const TriangleMesh& mesh);

}  // namespace fascia::rigging
