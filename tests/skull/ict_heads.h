#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/prepare/prepare.h"
#include "builder/skull/skull.h"

/// Heads of the ICT model: no bone under them, but many people.
namespace fascia::testing {

struct IctHead {
  prepare::PreparedHead head;
  std::map<std::string, skull::TargetLandmark> targets;  ///< on the skin, metres, rig frame
};

/// True when the head `name` (neutral, person_0 ...) is in `measured`/data/ict.
bool has_ict_head(const std::filesystem::path& measured, const std::string& name);

/// Reads and prepares a head. `landmarks` are points on the mean head; on another person, whose mesh has the
/// same triangles, they are taken at the same places of the mesh.
IctHead read_ict_head(const std::filesystem::path& measured, const std::string& name,
                      const std::filesystem::path& landmarks, const anatomy::GenericAnatomy& anatomy);

}  // namespace fascia::testing
