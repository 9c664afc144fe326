#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "check/check.h"
#include "cli/common.h"

namespace fascia::cli {

/// Exit code of a check that found a fault, and of `build --strict`: thrown as Exit when all else is
/// done.
inline constexpr int exit_check = 4;

/// Adds `fascia check`.
void add_check(const Command& tool, Common& common);

/// The short form of `fascia check` that a build ends with: the poses marked quick in
/// anatomy/data/checks.json at the coarsest level. One sentence for each row that fails, with what to do, or
/// the one that says why nothing could be checked. `name` is the file, for messages.
std::vector<std::string> quick_check(const std::vector<uint8_t>& rig, const std::string& name,
                                     const anatomy::Checks& checks);

/// What a row may be, for people: "at most 0.5".
std::string bounds_text(const check::Row& row);

}  // namespace fascia::cli
