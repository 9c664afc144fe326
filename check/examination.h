#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "check/check.h"
#include "check/crossing.h"
#include "check/landmark_motion.h"
#include "check/lids.h"
#include "check/lip_look.h"
#include "check/mirror.h"
#include "check/scale.h"
#include "check/seam.h"
#include "check/skin.h"

namespace fascia::check {

/// One head under examination: what is found on it at rest once, and the rows as pose after pose comes in.
class Examination {
 public:
  /// With `is_quick` what takes long to look for is left out: mirror images and crossings.
  Examination(const Head& head, const anatomy::Checks& checks, bool is_quick);

  /// The row of rest: `motion` metres.
  void rest(double motion);
  /// All rows of one pose.
  void pose(const anatomy::CheckPose& pose, const Shape& shape);
  /// The rows so far, each measure that is taken in every pose with the pose in which it was worst.
  std::vector<Row> rows() const;

 private:
  /// `value` in SI units; side is "", "_left" or "_right". `extra` is added to the upper bound, SI.
  void add(const std::string& bound, const std::string& side, double value, const std::string& pose,
           std::optional<Vec3> place = {}, double extra = 0.0);
  /// As `add`, but of the row's poses only the worst is kept.
  void keep_worst(const std::string& bound, const std::string& side, double value, const std::string& pose,
                  const Vec3& place, double extra = 0.0);
  Row row_of(const anatomy::CheckBound& bound, const std::string& side, double value, double extra) const;
  double size_of(const std::string& scale) const;

  void lids(const std::string& pose, const std::vector<Vec3>& skin, const Shape& shape);
  void mouth(const std::string& pose, const std::vector<Vec3>& skin);
  void motions(const std::string& pose, const std::vector<Vec3>& skin);
  void crossings(const std::string& pose, const std::vector<Vec3>& skin);
  void poking(const std::string& pose, const std::vector<Vec3>& skin, const Shape& shape);
  void damages(const std::string& pose, const std::vector<Vec3>& skin);
  void eyes(const std::string& pose, const Shape& shape);
  void still(const std::string& pose, const Shape& shape);

  const Head& head_;
  const anatomy::Checks& checks_;
  Sizes sizes_;
  std::unique_ptr<Skin> skin_;
  std::unique_ptr<TrackedLandmarks> landmarks_;
  Seam mouth_;
  std::array<Seam, 2> lid_seams_;
  std::array<std::unique_ptr<LidLook>, 2> lid_looks_;
  std::array<LidState, 2> lids_at_rest_;
  Crossings crossings_;
  std::unique_ptr<LipLook> lips_;
  std::unique_ptr<MirrorPoints> mirror_;
  std::vector<Row> rows_, worst_;
};

}  // namespace fascia::check
