#pragma once

#include "builder/tissue/columns.h"

namespace fascia::tissue {

/// Nodes, layers, springs and tethers of a level from its columns: everything that does not depend on channels.
rig::TissueLevel make_level(const TissueInputs& inputs, const TissueOptions& options, const LevelOptions& level,
                            const Columns& columns);

/// How firmly each column's SMAS sits on what lies behind it (1 the mean of a face, 0 free) and on the skin.
struct Attachments {
  std::vector<double> bone, skin;
};
Attachments attachments_of(const TissueInputs& inputs, const Columns& columns);

}  // namespace fascia::tissue
