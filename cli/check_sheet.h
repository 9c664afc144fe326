#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/checks.h"
#include "check/check.h"
#include "view/image.h"

namespace fascia::cli {

/// The poses of `checks` on one sheet, rest first, each from the front and at three quarters, close to where
/// it shows; the places of rows that fail are ringed in red and the rows named below. Throws fascia::Error
/// when nothing can be drawn on this machine.
view::Image check_sheet(const std::filesystem::path& rig, const std::string& level,
                        const anatomy::Checks& checks, const std::vector<check::Row>& rows);

}  // namespace fascia::cli
