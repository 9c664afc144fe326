#pragma once

#include <string>
#include <vector>

#include "cli/posing.h"
#include "rig/read/read.h"
#include "view/image.h"

namespace fascia::cli {

/// The rig's muscles that `list` names, comma-separated: parts or wholes, with a side or without. All of them
/// when it is empty. Throws fascia::Error for a name that fits none.
std::vector<std::string> muscles_from(const std::string& list, const rig::Rig& rig);

/// Four views of `muscles` over skull and SMAS as the face stands, each muscle in a colour of its own, with a
/// legend. `face` must be in metres; a view is `size` pixels wide.
view::Image muscle_sheet(const Face& face, const rig::Rig& rig, const std::vector<std::string>& muscles,
                         int size);

}  // namespace fascia::cli
