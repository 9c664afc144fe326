#pragma once

#include <memory>

#include "anatomy/anatomy.h"
#include "builder/muscles/muscles.h"

namespace fascia::bench {

/// The embedded head ready for its muscles. `inputs` points into the rest.
struct Face {
  anatomy::GenericAnatomy anatomy;
  TriangleMesh smas;
  std::unique_ptr<spatial::SurfaceQuery> skin, cranium, mandible, teeth;
  muscles::Inputs inputs;
};

/// Builds its SMAS with edges of `edge_length` metres.
std::unique_ptr<Face> embedded_face(double edge_length);

}  // namespace fascia::bench
