#pragma once

#include <set>
#include <string>

#include "cli/posing.h"
#include "rig/read/read.h"
#include "view/face/face_scene.h"
#include "view/renderer.h"

namespace fascia::cli {

/// Names that `--layers` knows: those of view::FaceScene::layer_names().
std::set<std::string> layers_from(const std::string& list);

/// What to draw of a face as it stands: `face` must be in metres. With deeper layers the skin is glass. Of
/// the muscles only `muscles` are drawn, names with sides; all of them when there are none.
view::DrawList draw_face(const Face& face, const rig::Rig& rig, const std::set<std::string>& layers,
                         const std::vector<std::string>& muscles = {});

/// The same with all there is to choose. `rig` must outlive the face.
view::DrawList draw_face(const Face& face, const rig::Rig& rig, const view::FaceView& what);

/// Fibres of all muscles as the face stands, by muscle: those in the lattice where it has them, those from
/// bone to bone, which it does not hold, carried along by their bones.
std::vector<std::pair<std::string, std::vector<std::vector<Vec3>>>> all_fibres(const Face& face,
                                                                               const rig::Rig& rig);

/// A box around the face: forehead to chin, ear to ear; the same for every pose.
Bounds face_box(const rig::Rig& rig);

}  // namespace fascia::cli
