#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "builder/smas/layers.h"
#include "geometry/mesh.h"

namespace fascia::smas {

/// What may be asked for instead of the anatomy's reach. Lengths in metres of an adult face.
struct ReachOptions {
  std::optional<double> galea;  ///< see anatomy::mechanics::SmasShape
  std::optional<double> neck;   ///< likewise
  /// Leave the nostrils open (one opening, the columella between them with it).
  bool nostrils = true;
};

/// `shape` with what `options` ask for in its place.
anatomy::mechanics::SmasShape with_options(anatomy::mechanics::SmasShape shape, const ReachOptions& options);

/// Size of a face relative to the adult of `shape`, from the landmarks of eyes, nose, mouth and chin.
/// @throws Error that names the landmarks missing.
double face_scale(const Landmarks& landmarks, const anatomy::mechanics::SmasShape& shape);

/// Where on the skin the SMAS may lie: a field in metres, positive inside, about the distance to the
/// nearest edge (the outer limit, lids, mouth, nostrils).
class ReachField {
 public:
  /// `band`: the field reaches -band within each opening. @throws Error that names the landmarks missing.
  ReachField(const Landmarks& landmarks, const anatomy::mechanics::SmasShape& shape, bool nostrils,
             double band);
  double operator()(const Vec3& skin) const { return std::min(within_limits(skin), outside_openings(skin)); }
  double within_limits(const Vec3& skin) const;
  double outside_openings(const Vec3& skin) const;

  /// Whether a patch of skin at `point` with unit `normal` could be the inside of an opening (lining of
  /// mouth, lids or nostril): it is near one and does not look out of it. A ray tells whether it is.
  bool may_be_lining(const Vec3& point, const Vec3& normal) const;
  /// Whether a patch of skin is the lining of an eye socket for certain: behind the lids and facing the
  /// globe.
  bool is_socket(const Vec3& point, const Vec3& normal) const;
  /// Whether `point` is within 40 mm (of an adult) of an opening.
  bool near_opening(const Vec3& point) const;
  double scale() const { return scale_; }

 private:
  // An ellipse with two half heights about a bent axis, across which the opening looks along z.
  struct Opening {
    Vec3 centre, x, y, z;
    double half_width, up, down, bend, near, far;
    double globe = 0.0;                        // radius of the globe behind the lids; 0: not an eye
    double distance(const Vec3& point) const;  // ellipse and depth range
    double across(const Vec3& point) const;    // ellipse alone
  };
  struct Limit {
    Vec3 at, inward;
  };
  void add_eye(const Landmarks& landmarks, const std::string& side);
  void add_mouth(const Landmarks& landmarks);
  void add_nostrils(const Landmarks& landmarks);
  void add_limits(const Landmarks& landmarks);

  // The way up into a nostril: what looks towards it, beside and above its rim, is its wall.
  struct Nostril {
    Vec3 rim, out;
    double radius;
  };
  bool in_nostril(const Vec3& point, const Vec3& normal) const;

  std::vector<Opening> openings_;
  std::vector<Nostril> nostrils_;
  std::vector<Limit> limits_;
  anatomy::mechanics::SmasShape shape_;
  double scale_, band_;
};

/// The skin of the face that lies over the SMAS.
struct FacialSkin {
  TriangleMesh mesh;
  std::vector<double> field;       ///< ReachField at its vertices
  std::vector<int> skin_triangle;  ///< triangle of the whole skin that each triangle is
};

/// Cuts the outer skin of the face from a head: the connected skin around the cheeks and forehead where
/// `field` > -`band`. The lining of mouth, nose and eye sockets, which looks at other skin close by, stays
/// away.
/// @throws Error when the landmarks do not lie on the skin.
FacialSkin facial_skin(const TriangleMesh& skin, const Landmarks& landmarks, const ReachField& field,
                       double band);

}  // namespace fascia::smas
