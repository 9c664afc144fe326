#pragma once

#include <vector>

#include "builder/smas/front.h"
#include "builder/smas/surface_probe.h"

namespace fascia::smas {

/// What lies around a front edge, laid flat in the plane of its frame: which triangle the edge may take.
class Surroundings {
 public:
  explicit Surroundings(const Front& front) : front_(front) {}

  /// Looks at everything within 1.5 `radius` of where the triangle on `frame` would lie. Both must outlive
  /// the answers.
  void gather(const EdgeFrame& frame, double radius);

  /// Whether a vertex lies in the circumsphere of the triangle to `p`, or so near to `p` that it should be
  /// used.
  bool blocked(const Vec3& p) const;

  /// Front vertices on the free side no further from the edge's ends than `radius`, the one that a Delaunay
  /// triangulation would take (widest angle) first.
  const std::vector<int>& partners();

  /// Whether the triangle to `point` with unit `normal` (the vertex `apex`, or -1 when it is new) overlaps
  /// nothing that is there.
  bool fits(const Vec3& point, const Vec3& normal, int apex) const;

 private:
  struct Near {
    int vertex;
    Vec2 flat;      // along d and o from the middle of the edge
    double cosine;  // of its normal and the frame's
    bool on_sheet;  // faces the same way and is not far above or below
  };
  Vec2 flat(const Vec3& p) const {
    return {(p - frame_->mid).dot(frame_->d), (p - frame_->mid).dot(frame_->o)};
  }
  bool on_sheet(int v) const;
  bool crosses(int edge, const Vec2& start, const Vec2& end, const Vec2& a, const Vec2& b, const Vec2& c,
               int apex) const;

  const Front& front_;
  const EdgeFrame* frame_ = nullptr;
  double radius_ = 0.0;
  std::vector<Near> near_;
  std::vector<int> found_, place_, partners_;  // place_: of each vertex among near_, or -1
  std::vector<std::pair<double, int>> ranked_;
};

}  // namespace fascia::smas
