#pragma once

#include <vector>

#include "builder/tissue/bind.h"
#include "builder/tissue/fissure.h"

namespace fascia::tissue {

/// The share of the closing upper lid's turn that column `v`, so far from the lid's edge, makes: all at the
/// edge, less above it where skin unfolds from the crease, none beyond the canthi.
double closing_share(const TissueInputs& inputs, const Columns& columns, const Fissure& fissure, size_t v);

/// Turns the upper lids of `level` further where a blink leaves a slit between them. The blink that
/// `TissueInputs::blink` says is played, the lids' edges are looked at on the head's own mesh, which may be
/// coarser than the columns or lie beside them, and what still gapes is added to the way of the columns
/// there, a few times over. Lids that close, and heads whose blink is not known, are left as they are.
/// `is_mirrored`: the columns of both sides are each other's images, and stay so.
void settle_lids(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns,
                 const std::vector<Follow>& skin, bool is_mirrored, rig::TissueLevel& level);

}  // namespace fascia::tissue
