#pragma once

#include "tools/anatomy/head/figures.h"
#include "tools/anatomy/head/layout.h"

namespace fascia::head_maker {

/// The fine loops of the openings E, M, O and A: the first points of the measured profiles,
/// where the rings take over from the cage.
std::map<char, std::vector<Vec3>> openings(const Figures& figures);

/// Fill the opening E: lid skin, lid margin with its thickness, conjunctival sac behind the eyeball.
/// Loops: "lid_margin" and "lid_margin_inner".
void add_eye(const Figures& figures, HalfHead& head);

/// Fill the opening M: vermilion, contact line, inner lip and a closed bag around the teeth.
/// Loops: "vermilion_border", "lip_contact" (upper midline to lower midline).
void add_mouth(const Figures& figures, HalfHead& head);

/// Fill the opening O: the rim and a closed cavity. Loop: "nostril_rim".
void add_nostril(const Figures& figures, HalfHead& head);

/// Fill the opening A: back of the ear, helix, antihelix, concha. Loop: "helix".
void add_ear(const Figures& figures, HalfHead& head);

}  // namespace fascia::head_maker
