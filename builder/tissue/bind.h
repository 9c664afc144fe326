#pragma once

#include <array>

#include "builder/tissue/columns.h"

namespace fascia::tissue {

/// Up to eight lattice nodes and how much of each one's displacement a vertex takes, and of the jaw's.
struct Follow {
  static constexpr size_t influences = 8;
  std::array<uint32_t, influences> nodes{};
  std::array<float, influences> weights{};
  float jaw = 0.0F;
};

/// How every vertex of the welded skin follows the columns of one level.
///
/// In the region: barycentrics of a triangle of columns that is near along the surface, never merely near in
/// space, then smoothed over the skin's own edges. Deeper in the mouth: towards the jaw's motion by height;
/// deeper in sockets and nostrils, and everywhere else: fading to rest.
std::vector<Follow> follow_skin(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns);

/// One binding a part, in the order of `inputs.parts`; `mesh`, `primitive` and the fingerprint are the caller's.
std::vector<rig::Binding> bind_parts(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns,
                                     const std::vector<Follow>& skin);

}  // namespace fascia::tissue
