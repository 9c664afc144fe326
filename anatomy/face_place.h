#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::anatomy {

/// A location on any face, given by its landmarks: their weighted sum per coordinate, and an offset.
struct FacePlace {
  struct Part {
    std::string landmark;  ///< on the skin, by full name
    Vec3 share;            ///< of its x, y and z
  };
  std::vector<Part> parts;
  Vec3 offset = Vec3::Zero();  ///< in thirds of the face: the height from subnasale to glabella
  double radius = 0.0;         ///< thirds of the face, over which its effect falls to 1/e
};

/// A firmly attached or gliding region of the face.
struct AttachmentRegion {
  std::string name;  ///< with its side
  FacePlace place;
  double bone = 1.0;  ///< factor of the attachment of the SMAS to bone
  double skin = 1.0;  ///< factor of the attachment of the SMAS to the skin
};

/// Additional attachment to the skull by cartilage, frenula and the mentalis.
struct Hold {
  std::string name;
  FacePlace place;
  double factor = 1.0;  ///< of the attachment to bone at its centre
};

}  // namespace fascia::anatomy
