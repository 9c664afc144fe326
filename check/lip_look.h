#pragma once

#include <vector>

#include "check/crossing.h"
#include "check/landmark_motion.h"
#include "check/skin.h"

namespace fascia::check {

/// What one sees of the mouth's inside through the outer skin of the lips.
struct Poking {
  Depth teeth;   ///< how far teeth or gums stand before it
  Depth lining;  ///< how far the lining of lips and mouth does, seen from behind
};

/// Looks at the mouth from the front and from both sides at 35 degrees, by rays a millimetre apart.
///
/// Outer skin is what can be seen from there at rest. Teeth before it, less than five millimetres, have come
/// through the lips; so has a lining whose back is seen before it. In an open mouth teeth lie before the
/// lining, which is not outer skin, and count for nothing.
class LipLook {
 public:
  /// `landmarks` and `head` must outlive this. `size` is the face's against an adult's.
  LipLook(const Head& head, const Skin& skin, const TrackedLandmarks& landmarks, double size);

  bool has_teeth() const { return !teeth_.empty(); }
  Poking look(const std::vector<Vec3>& skin, const Shape& shape) const;

 private:
  const Head& head_;
  const TrackedLandmarks& landmarks_;
  double size_ = 1.0;
  Patch lips_;
  std::vector<bool> is_outer_;  // #triangles of lips_
  std::vector<size_t> teeth_;   // parts of the head
};

}  // namespace fascia::check
