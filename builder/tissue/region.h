#pragma once

#include <array>

#include "builder/tissue/inputs.h"

namespace fascia::tissue {

/// The opening of the face that a point of the skin belongs to.
enum class Opening : uint8_t { none = 0, mouth = 1, eye_left = 2, eye_right = 3, nostril = 4 };

/// The part of the skin that is simulated: from the hairline to the upper neck, ear to ear, and a
/// little way over lips, lids and nostrils into the head.
struct FaceRegion {
  TriangleMesh mesh;               ///< the region alone
  std::vector<int> skin_vertex;    ///< #region vertices, index in the skin
  std::vector<int> region_vertex;  ///< #skin vertices, index in the region or -1
  std::vector<bool> outer;         ///< #region vertices: visible from outside (not lining)
  std::vector<bool> rim;           ///< #region vertices: outer ones beyond which the skin goes on; they stay
  std::vector<double>
      feature_distance;  ///< #region vertices, metres along the skin to the nearest lip, lid or nostril edge;
                         ///< of a skin that nowhere opens, to the corners of mouth and eyes
  std::array<std::vector<double>, 5>
      opening_distance;  ///< the same, to each Opening's edge alone; 1 where no such edge can be reached
  std::vector<Opening> opening;  ///< #skin vertices: the opening a vertex inside the head belongs to
  std::vector<double>
      depth;  ///< #skin vertices: metres inward from the edge; 0 outside, infinity out of reach
};

/// Finds the region. Throws Error when a landmark it needs is missing or no skin lies in it.
FaceRegion find_region(const TissueInputs& inputs, const TissueOptions& options);

/// The vestibule of the mouth: one space behind lips and cheeks, from fold to fold, back to the masseter's
/// front edge.
class Vestibule {
 public:
  explicit Vestibule(const TissueInputs& inputs);
  /// 1 before it, 0 beside it.
  double share(const Vec3& point) const;
  /// How much of a place belongs to the left or right half.
  double side(const Vec3& point, bool left) const;

 private:
  anatomy::mechanics::Vestibule mechanics_;
  Vec3 mouth_;
  std::array<Vec3, 2> corners_, to_ears_;  // right, left
  double half_width_, top_, bottom_;
};

/// The height from subnasale to glabella, a third of the face, metres.
double face_third(const TissueInputs& inputs);

/// The landmark `name`; throws Error that names it when it is missing.
Vec3 landmark(const TissueInputs& inputs, const std::string& name);

/// The eye of a side with centre and radius: the given one, or fitted to the lids' landmarks.
rig::Eye eye_of(const TissueInputs& inputs, bool left);

}  // namespace fascia::tissue
