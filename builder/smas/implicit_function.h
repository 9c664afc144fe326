#pragma once

#include <functional>

#include "geometry/mesh.h"

namespace fascia::smas {

/// A scalar field whose zero set is a surface: negative inside, positive outside, so that the
/// gradient points outwards.
///
/// Called as `value = function(point, &gradient)`; `gradient` is null when only the value is asked
/// for. Must be a pure function: the same point gives the same bits. A value or gradient that is not
/// finite counts as "no surface here".
using ImplicitFunction = std::function<double(const Vec3& point, Vec3* gradient)>;

}  // namespace fascia::smas
