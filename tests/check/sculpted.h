#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "check/head.h"

namespace fascia::testing {

/// A head with sculpted or measured ARKit shapes, to be checked as if the shapes were a rig's own.
struct SculptedHead {
  std::string name;
  check::Head head;
  check::Player player;
};

/// A head whose file carries the shapes as morph targets, in ARKit's names or with _L and _R. `skin`: name of
/// the mesh that is the skin; empty: found. Teeth and linings for which the file has no shapes are left out.
SculptedHead sculpted_head(const std::filesystem::path& file, const std::string& skin = "");

/// A person of the ICT model, `neutral` or `person_N`, with the model's own expressions; skin and eyes alone.
SculptedHead ict_person(const std::string& name);

/// All those that lie beside the project, heads that cannot be read left out with a line on stderr.
std::vector<SculptedHead> sculpted_heads();

}  // namespace fascia::testing
