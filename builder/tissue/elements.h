#pragma once

#include "builder/tissue/columns.h"

namespace fascia::tissue {

/// Nodes, layers, springs and tethers of a level from its columns: everything that does not depend on
/// channels.
rig::TissueLevel make_level(const TissueInputs& inputs, const LevelOptions& level, const Columns& columns);

/// Attachment of each column's SMAS to what lies behind it, along the gliding plane (`bone`) and across it
/// (`normal`), and by the skin: 1 the mean of a face, 0 free.
struct Attachments {
  std::vector<double> bone, normal, skin;
};
Attachments attachments_of(const TissueInputs& inputs, const Columns& columns);

}  // namespace fascia::tissue
