#pragma once

#include "cli/common.h"
#include "cli/options.h"

namespace fascia::cli {

/// Adds `view`, the window, to the tool.
void add_view(const Command& tool, Common& common);

}  // namespace fascia::cli
