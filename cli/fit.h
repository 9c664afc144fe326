#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// `fascia fit`: see add_build and its like in common.h.
void add_fit(CLI::App& app, Common& common);

}  // namespace fascia::cli
