#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "batch/record.h"

namespace fascia::cli {

/// One page on many heads, to lie in their folder: how many were built, failures by cause, percentiles of
/// time, memory and size, verdicts of the checks, and pictures.
std::string batch_page(const std::string& title, const std::vector<batch::Record>& records);

/// The same as numbers: {"heads", "done", "failed", "causes": [{"cause", "heads": [...]}], "seconds": {"p50",
/// ...}, "megabytes", "rig_megabytes", "checks": [{"name", "failed"}]}.
nlohmann::ordered_json batch_figures(const std::vector<batch::Record>& records);

}  // namespace fascia::cli
