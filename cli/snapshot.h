#pragma once

#include "cli/common.h"

namespace fascia::cli {

/// Adds `fascia snapshot record|check|diff`.
void add_snapshot(CLI::App& app, Common& common);

}  // namespace fascia::cli
