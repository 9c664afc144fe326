#pragma once

#include <vector>

#include "builder/geodesics/surface.h"

namespace fascia::bench {

/// The SMAS of the generic head, subdivided, smoothed and brought to about `triangles` triangles of uneven
/// shape: what muscle fibres run on. Open at lids, lips and nostrils.
TriangleMesh smas_surface(int triangles);

/// The generic head's skin alike, with the pockets of eyes, mouth, nose and ears: the hard case.
TriangleMesh skin_surface(int triangles);

struct PointPair {
  SurfacePoint from, to;
};

/// `count` pairs on the face, 40 to 60 mm apart as the ends of a mimic muscle are. The same for one mesh
/// on every run.
std::vector<PointPair> muscle_pairs(const TriangleMesh& mesh, int count);

}  // namespace fascia::bench
