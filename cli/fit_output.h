#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/common.h"
#include "cli/fit_target.h"

namespace fascia::cli {

/// The activations of one fit that are not at rest, by name.
nlohmann::ordered_json fitted_activations(const fit::Subject& subject, const fit::FitResult& result);

/// How far each of them is known, and which the target hardly tells apart.
void add_certainty(const fit::Subject& subject, const fit::FitResult& result, nlohmann::ordered_json& report);

/// Writes what `pose` and `play` take: activations (.json) of one mesh; a folder of NAME.json of several
/// shapes; curves
/// (.csv, or .json for takes). Throws fascia::Error when `path` does not fit what was fitted.
void write_fit(const std::filesystem::path& path, const fit::Subject& subject, const FitTargets& targets,
               const std::vector<fit::FitResult>& results, double fps);

/// Throws fascia::Error when `path` cannot take the results of `targets`; called before the work is done.
void check_fit_output(const std::filesystem::path& path, const FitTargets& targets);

/// What write_fit_report writes into `folder`.
std::vector<std::filesystem::path> fit_report_files(const std::filesystem::path& folder);

/// Writes residual.png, residual.ply and report.md for the target that is explained worst into `folder`.
void write_fit_report(const std::filesystem::path& folder, const fit::Subject& subject,
                      const FitTargets& targets, const std::vector<fit::FitResult>& results);

}  // namespace fascia::cli
