#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>

#include "builder/tissue/columns.h"

namespace fascia::tissue {

/// Skinning weights of a vertex: up to eight lattice nodes, and the jaw.
struct Follow {
  static constexpr size_t influences = 8;
  std::array<uint32_t, influences> nodes{};
  std::array<float, influences> weights{};
  float jaw = 0.0F;
};

/// Sparse skinning weights: column -> weight, sorted by column, and `jaw_entry` for the jaw.
using Row = std::map<uint32_t, double>;
constexpr uint32_t jaw_entry = std::numeric_limits<uint32_t>::max();

/// The strongest entries of `row`, their sum and their mean place kept; `places`: of the columns.
Follow pack(const Row& row, const std::vector<Vec3>& places);

/// How every vertex of the welded skin follows the columns of one level.
///
/// In the region: barycentrics of a triangle of columns that is near along the surface, never merely near in
/// space, then smoothed over the skin's own edges. Deeper in the mouth: towards the jaw's motion by height;
/// deeper in sockets and nostrils, and everywhere else: fading to rest.
std::vector<Follow> follow_skin(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns);

/// One binding a part, in the order of `inputs.parts`; `mesh`, `primitive` and the fingerprint are the
/// caller's.
std::vector<rig::Binding> bind_parts(const TissueInputs& inputs, const FaceRegion& region,
                                     const Columns& columns, const std::vector<Follow>& skin);

}  // namespace fascia::tissue
