#pragma once

#include <optional>
#include <string>

#include "builder/prepare/prepare.h"

namespace fascia::prepare {

/// What names say a part is.
struct NamedPart {
  std::optional<Part> part;  ///< teeth and gums as upper ones; which jaw `jaw` tells, or place
  enum class Jaw { unsaid, upper, lower } jaw = Jaw::unsaid;
  bool says_eye = false;  ///< an eye, but no lash, brow or fluid of it
};

/// Reads the names of meshes and materials by their words: "Hair_Brown" is hair and no brow, "student" has no
/// teeth. Words are parted at anything but letters and where a small letter meets a capital.
NamedPart part_by_name(const std::string& names);

}  // namespace fascia::prepare
