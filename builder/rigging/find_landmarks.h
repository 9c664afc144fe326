#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/landmarks/regions.h"
#include "builder/landmarks/skin_landmark.h"
#include "builder/prepare/prepare.h"
#include "builder/spatial/mirror_plane.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/for_each.h"

namespace fascia::rigging {

/// The head of a file with its parts known and its landmarks placed.
struct FoundLandmarks {
  prepare::PreparedHead head;
  std::map<std::string, landmarks::SkinLandmark> landmarks;  ///< metres, rig frame
  std::optional<landmarks::FaceRegions>
      regions;  ///< of the vertices of `head.skin`; nothing when nothing was searched
  std::optional<spatial::MirrorPlane> midplane;  ///< between the face's sides; nothing where it is not seen
  double likeness = 1.0;            ///< how face-like what was found is, 0 to 1; 1 when nothing was searched
  bool is_doubtful = false;         ///< what was found is unlike most faces
  bool is_inside_out = false;       ///< the file's triangles face inward; those of `head` were turned
  std::array<double, 3> seconds{};  ///< for finding the head, preparing it, placing the landmarks
  std::vector<std::string> warnings;
};

/// Finds the head in `scene`, prepares it and places all skin landmarks: the given ones as they are, the rest
/// found, or, where all that `anatomy` marks as required are given, carried over through them. `with_regions`
/// asks for the regions of the skin as well; `for_each` is how places of a head are tried side by side, the
/// result does not depend on it. Throws fascia::Error when there is no face, and as `prepare` does.
FoundLandmarks find_landmarks(const formats::Scene& scene, const formats::LandmarkFile& given,
                              const anatomy::GenericAnatomy& anatomy,
                              const prepare::PrepareOptions& options = {}, bool with_regions = false,
                              const ForEach& for_each = {});

/// The same, then the landmarks of `edited` are put where those points are: no other landmark moves. Where no
/// face is found without them, or only a doubtful one, they help to find it, as given ones do.
FoundLandmarks find_landmarks_with_edits(const formats::Scene& scene, const formats::LandmarkFile& given,
                                         const formats::LandmarkFile& edited,
                                         const anatomy::GenericAnatomy& anatomy,
                                         const prepare::PrepareOptions& options = {},
                                         const ForEach& for_each = {});

}  // namespace fascia::rigging
