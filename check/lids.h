#pragma once

#include <vector>

#include "check/seam.h"

namespace fascia::check {

/// Directions out of an eye's centre through its fissure: how far between the canthi, and how high.
class LidFrame {
 public:
  LidFrame(const Vec3& exocanthion, const Vec3& endocanthion, const Eye& eye, bool left);

  Vec3 at_right, at_left;  ///< the canthus to the subject's right, to the left
  /// Unit, through the place at share `t` of the way from right to left, `angle` radians above it.
  Vec3 direction(double t, double angle) const;
  /// Radians of `p` above the place at share `t`, seen from the centre.
  double elevation(const Vec3& p, double t) const;

 private:
  Vec3 base(double t) const;
  Vec3 centre_, right_, left_, up_;
};

/// How an eye's lids stand in a pose.
struct LidState {
  std::vector<double> gaps;   ///< metres at each of the seam's stations: how much one sees between the lids
  double widest = 0.0;        ///< the largest of them
  double cornea_out = 0.0;    ///< metres by which the eyeball stands out of the closed lids
  Vec3 place = Vec3::Zero();  ///< of the widest gap
  Vec3 cornea_place = Vec3::Zero();  ///< of where it stands out most
};

/// Looks at one eye's lids from outside toward the eye's centre.
class LidLook {
 public:
  /// `seam` is of this eye's lids: what lies between its edges at rest, and a little more, is looked at. The
  /// head must outlive this and have the landmarks of the eye.
  LidLook(const Head& head, const Skin& skin, const Eye& eye, const Seam& seam, bool left);

  LidState look(const std::vector<Vec3>& skin, const Shape& shape) const;
  /// Whether one looks along `ray` from outside the head: not through the nose, say, from behind its skin.
  bool is_sight(const Vec3& ray) const;
  bool sees() const { return !lids_.triangles.empty(); }

 private:
  const Head& head_;
  Eye eye_;
  LidFrame frame_;
  struct Range {
    double station, low, high;  // high and low: radians, of the edges at rest
  };
  std::vector<Range> ranges_;
  Patch lids_;
  spatial::SurfaceQuery face_;   // at rest
  std::vector<size_t> eyeball_;  // parts of the head
};

}  // namespace fascia::check
