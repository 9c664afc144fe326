#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "builder/reconstruction/reconstruction.h"
#include "view/image.h"

namespace fascia::cli {

/// Morph targets of a reconstructed head: skin at one standard deviation less and more of soft tissue.
inline constexpr const char* thin_target = "depths_minus_one_deviation";
inline constexpr const char* thick_target = "depths_plus_one_deviation";

/// The generic head put over a skull, by the extension of `path`. GLB: metres, +Y up, with the band of depths
/// as two morph targets. OBJ: the scan's own axes and units, quads, groups and UVs of the generic head.
/// `offset`: where the scan's coordinates had their origin. Throws fascia::Error for another extension.
void write_reconstructed_head(const std::filesystem::path& path, const anatomy::GenericAnatomy& anatomy,
                              const reconstruction::Result& result, const Vec3& offset);

/// The landmarks of the new skin and the bone under them in the axes and units of the file `head`, as
/// `write_reconstructed_head` writes it and `fascia build --landmarks` reads them. `path` ends in .json.
void write_reconstructed_landmarks(const std::filesystem::path& path, const std::filesystem::path& head,
                                   const anatomy::GenericAnatomy& anatomy,
                                   const reconstruction::Result& result, const Vec3& offset);

/// Front, three-quarter and side of the head, the head over the skull, and the band of one standard
/// deviation: its width on the skin in colours.
view::Image reconstruction_sheet(const anatomy::GenericAnatomy& anatomy, const reconstruction::Result& result,
                                 const TriangleMesh& scan);

}  // namespace fascia::cli
