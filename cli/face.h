#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// Adds `face`: skin from a skull.
void add_face(CLI::App& app, Common& common);

}  // namespace fascia::cli
