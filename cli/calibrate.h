#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// Adds `calibrate`: a rig whose tables fit one person's own expressions.
void add_calibrate(const Command& tool, Common& common);

}  // namespace fascia::cli
