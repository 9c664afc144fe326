#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// Adds `fascia batch`: many heads on one machine or a cluster, and the overview of what came of them.
void add_batch(const Command& tool, Common& common);

}  // namespace fascia::cli
