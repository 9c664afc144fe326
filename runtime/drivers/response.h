#pragma once

#include <span>
#include <vector>

namespace fascia::runtime {

/// A monotone curve from the weight of a set's member to the share of its row that is played, so that what
/// the face shows is in proportion to the weight.
///
/// Through (0, 0), the knots and (1, 1) goes the monotone cubic of Fritsch and Butland 1984, SIAM Journal on
/// Scientific and Statistical Computing 5(2): once continuously differentiable, never beyond its
/// neighbouring knots. Beyond 1 the share is the weight; a negative weight plays minus what its size would.
class Response {
 public:
  /// The weight itself.
  Response() = default;
  /// `weights` rise strictly between 0 and 1, `shares` (as many) never fall and stay within 0 and 1. Throws
  /// fascia::Error when they do not. Without any, the weight itself.
  Response(std::span<const float> weights, std::span<const float> shares);

  /// Share of the row at `weight`: 0 at 0, 1 at 1.
  float share(float weight) const;
  /// Its derivative.
  float slope(float weight) const;

 private:
  struct Knot {
    float weight, share, slope;
  };
  /// The first knot that is not before `size`, which lies in (0, 1).
  std::size_t piece(float size) const;

  std::vector<Knot> knots_;  ///< from (0, 0) to (1, 1); empty: the weight itself
};

}  // namespace fascia::runtime
