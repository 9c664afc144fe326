#pragma once

#include <vector>

#include "builder/tissue/bind.h"
#include "builder/tissue/fissure.h"
#include "sim/face_model.h"

namespace fascia::tissue {

/// Fraction of the closing rotation of the upper lid for column `v`: 1 at the lid's edge, less above it where
/// skin unfolds from the crease, 0 beyond the canthi.
double closing_share(const TissueInputs& inputs, const Columns& columns, const Fissure& fissure, size_t v);

/// Increases the closing angles of the upper lids of `level` where a blink leaves a slit. The blink of
/// `TissueInputs::blink` is simulated, the gap is measured on the head's own mesh, which may be coarser than
/// the columns, and is added to the angles of the columns there, in a few iterations. Lids that close, and
/// heads without a known blink, are unchanged. `is_mirrored`: the columns are symmetric, and remain so;
/// `solver`: the constants it is simulated with.
void settle_lids(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns,
                 const std::vector<Follow>& skin, bool is_mirrored, const sim::FaceModelOptions& solver,
                 rig::TissueLevel& level);

}  // namespace fascia::tissue
