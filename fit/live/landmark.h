#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "rig/read/read.h"

namespace fascia::fit {

/// A place on the skin: shares of a triangle's corners.
struct SkinPlace {
  uint32_t primitive = 0;              ///< of the rig file
  std::array<uint32_t, 3> vertices{};  ///< of the primitive
  std::array<double, 3> shares = {};   ///< sum 1
};

/// A place on the skin as the tissue carries it.
struct Landmark {
  Vec3 rest = Vec3::Zero();                               ///< metres
  std::vector<std::pair<uint32_t, double>> influences{};  ///< nodes of the level, and how it follows each
  double jaw_share = 0.0;
};

/// The place of the skin nearest to `point` (metres), within `farthest` metres; none when there is none.
std::optional<SkinPlace> nearest_skin(const rig::RigFile& file, size_t level, const Vec3& point,
                                      double farthest = 0.01);

/// What carries a place at a level of detail. Throws fascia::Error when its primitive is not bound, a vertex
/// is not there, or it lies on an eye.
Landmark landmark_at(const rig::RigFile& file, size_t level, const SkinPlace& place);

/// The place on the skin of a landmark of the rig, by name; none when the rig has none or it is off the skin.
std::optional<SkinPlace> place_of_landmark(const rig::RigFile& file, size_t level, std::string_view name);

}  // namespace fascia::fit
