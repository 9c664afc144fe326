#pragma once

#include <array>
#include <optional>
#include <vector>

#include "builder/spatial/mirror_plane.h"
#include "builder/tissue/region.h"
#include "builder/tissue/remesh.h"

namespace fascia::tissue {

/// The plane that a face is more or less the same on both sides of.
struct Symmetry : spatial::MirrorPlane {
  bool is_exact = false;  ///< as modelled heads are: what one side has is the other's image
};

/// The symmetry of a region by its landmarks, drawn onto the skin between it and its image. Nothing where a
/// tenth of the skin is farther than a millimetre and a half from its image, as on lopsided faces.
std::optional<Symmetry> symmetry_of(const TissueInputs& inputs, const FaceRegion& region);

/// What of a region lies on the left of the plane, cut along it.
struct HalfRegion {
  TriangleMesh mesh;
  std::vector<SurfacePoint> source;  ///< #vertices, on the region's mesh
  /// #triangles: the region's triangle that each is a part of, and its corners there, barycentric.
  std::vector<int> parent;
  std::vector<std::array<Vec3, 3>> corners;
};

/// Cuts `mesh` along the plane and keeps the left. Vertices within a twentieth of a millimetre of the plane
/// are put onto it.
HalfRegion left_half(const TriangleMesh& mesh, const Symmetry& symmetry);

/// The same vertices with their sources on the region's mesh instead of on the half's, and those along the
/// cut on the plane.
RemeshResult on_region(const RemeshResult& half, const HalfRegion& region, const Symmetry& symmetry);

/// Completes a remesh of the left half by the mirror images of its vertices, which follow them in the same
/// order; those on the plane are their own. Where the symmetry is exact the images stay where they are, else
/// they lie on the skin nearest to there, on the same lip by `lower_lip` (#region vertices, see Beneath; may
/// be empty). Nothing where the skin has no such place or triangles would turn. `left` receives of each image
/// the vertex it is one of.
std::optional<RemeshResult> with_images(const RemeshResult& half, const FaceRegion& region,
                                        const std::vector<double>& lower_lip, const Symmetry& symmetry,
                                        std::vector<size_t>& left);

/// What lies on both sides with the right one's made the left one's mirror image: muscles, unless they were
/// changed by hand, and ligaments whose names end in _left and _right. One that only one side has stays.
TissueInputs with_mirrored_sides(TissueInputs inputs, const Symmetry& symmetry);

}  // namespace fascia::tissue
