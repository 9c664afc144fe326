#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace fascia::bench {

/// Writes the embedded head and what becomes of it when its proportions, units or parts are changed into
/// `folder`; returns name and file of each.
std::vector<std::pair<std::string, std::filesystem::path>> write_variants(
    const std::filesystem::path& folder);

}  // namespace fascia::bench
