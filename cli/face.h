#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// Adds `face`: skin from a skull.
void add_face(const Command& tool, Common& common);

}  // namespace fascia::cli
