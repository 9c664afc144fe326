#pragma once

#include <functional>

#include "builder/muscles/muscles.h"

namespace fascia::muscles {

/// Puts a point that was moved back at its depth; `share` is how far along its fibre it lies, 0 origin .. 1
/// insertion.
using Replace = std::function<FibrePoint(const Vec3& position, double share)>;

/// Untangles fibres of one muscle that cross (see `crossings`); leaves others as they are.
///
/// The fibres are resampled alike. At each share of the way their points stand in a row across the muscle.
/// With `sort` they are put in order in it, those at the ends too, for fibres of one muscle may change their
/// ends with each other. Then the points between are moved towards the middle of their neighbours and
/// `replace`d, until no two fibres cross or `rounds` are over. Returns the crossings that are left.
int put_in_order(std::vector<Fibre>& fibres, const spatial::SurfaceQuery& smas, const Replace& replace,
                 bool sort = true, int rounds = 24);

/// The directions along which the points of `fibres` are seen when asking whether they cross: the SMAS'
/// normals, or, where no point is bound to it, the normal of the sheet they span.
std::vector<std::vector<Vec3>> seen_along(const std::vector<Fibre>& fibres,
                                          const spatial::SurfaceQuery& smas);

}  // namespace fascia::muscles
