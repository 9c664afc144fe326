#pragma once

#include <vector>

#include "builder/tissue/region.h"

namespace fascia::tissue {

/// The palpebral fissure in its own coordinates: elevation as an angle about the globe, and position between
/// the canthi.
class Fissure {
 public:
  static constexpr double edge = 0.004;  ///< metres of skin beside the opening that hold a lid's edge
  /// Radians about the globe: larger than the largest eyes of cartoon figures; beyond it is the socket.
  static constexpr double widest = 2.2;

  /// From the lids' landmarks and the skin's own edge in `region`.
  Fissure(const TissueInputs& inputs, const FaceRegion& region, bool left);

  Vec3 centre, lateral, front,
      up;  ///< lateral: from canthus to canthus, to the subject's left; front: out of the fissure
  double radius = 0.0;  ///< of the globe, metres

  /// Angle above the front, radians.
  double elevation(const Vec3& p) const;
  /// 0 at the canthus to the subject's right .. 1 at the other, beyond them outside of that.
  double place(const Vec3& p) const;
  /// Whether it is above the curve from canthus to canthus through the middle of the opening, which separates
  /// upper and lower lid: the canthi may lie below or above both.
  bool is_upper(const Vec3& p) const { return elevation(p) > middle(place(p)); }
  /// The same for a point on the region's mesh, at `p`; for closed lids by distances along the surface.
  bool is_upper(const FaceRegion& region, const SurfacePoint& place, const Vec3& p) const;
  /// Opening between the lids' edges at a position between the canthi, radians; 0 where they meet.
  double gap(double place) const;
  /// The lids meet at rest, as in a head with closed eyes.
  bool is_closed() const { return !upper_share.empty(); }
  /// #region vertices, of closed lids alone: 1 the upper lid's side .. 0 the lower one's, by the way along
  /// the surface, for where they meet no place tells them apart.
  std::vector<double> upper_share;
  /// Places along both lids' edges, on the region's mesh, some millimetre apart.
  const std::vector<SurfacePoint>& edges() const { return edges_; }

 private:
  double middle(double place) const;
  /// Moves the canthi outward to the end of the skin's edge if the landmarks lie inside it.
  void reach_canthi(const FaceRegion& region, bool left);
  void find_middle(const FaceRegion& region, bool left);
  void find_gaps(const FaceRegion& region, bool left);
  void find_closed_lids(const FaceRegion& region, bool left);

  double right_ = 0.0, left_ = 0.0;                      ///< the canthi along `lateral`
  double right_elevation_ = 0.0, left_elevation_ = 0.0;  ///< the canthi
  std::vector<double> middle_;                           ///< elevations in even steps from canthus to canthus
  std::vector<SurfacePoint> edges_;
  std::vector<double> gaps_;  ///< in even steps from canthus to canthus
};

}  // namespace fascia::tissue
