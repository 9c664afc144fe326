#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "batch/manifest.h"

namespace fascia::batch {

/// Folders of a batch's output that are its own.
inline constexpr const char *work_folder = ".work", *lock_folder = ".locks";
/// Names of a head's results.
inline constexpr const char *rig_name = "rig.glb", *build_name = "build.json", *check_name = "check.json",
                            *thumbnail_name = "thumbnail.png";

/// True for a folder that holds a batch's record.
bool is_result(const std::filesystem::path& folder);

/// Why a head's results may not take the place of what is at `result`, with a remedy: anything but a folder
/// with a readable record and nothing else than results. Empty when they may.
std::string why_not_replaced(const std::filesystem::path& result);

/// Throws fascia::Error with that reason for the first of `heads` whose results may not be put into `output`.
void check_results(const std::vector<Head>& heads, const std::filesystem::path& output);

/// Throws fascia::Error when a mesh, landmarks or edits of one of `heads` lie in a folder that building them
/// into `output` would replace.
void check_inputs(const std::vector<Head>& heads, const std::filesystem::path& output);

}  // namespace fascia::batch
