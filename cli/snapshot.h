#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// Adds `fascia snapshot record|check|diff`: keeps where a rig's skin goes, and checks that it still goes
/// there.
void add_snapshot(const Command& tool, Common& common);

}  // namespace fascia::cli
