#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// `fascia fit`: see add_build and its like in common.h.
void add_fit(const Command& tool, Common& common);

}  // namespace fascia::cli
