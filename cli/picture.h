#pragma once

#include <set>
#include <string>

#include "cli/posing.h"
#include "rig/read/read.h"
#include "view/renderer.h"

namespace fascia::cli {

/// Names that `--layers` knows: skin, eyes, teeth, skull, smas, muscles, landmarks.
std::set<std::string> layers_from(const std::string& list);

/// What to draw of a face as it stands: `face` must be in metres. With deeper layers the skin is glass.
view::DrawList draw_face(const Face& face, const rig::Rig& rig, const std::set<std::string>& layers);

/// A box around the face: forehead to chin, ear to ear; the same for every pose.
Bounds face_box(const rig::Rig& rig);

/// A colour of its own for each muscle, the same for both sides.
Vec3 muscle_colour(const std::string& name);

}  // namespace fascia::cli
