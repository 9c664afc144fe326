#pragma once

#include "builder/smas/front.h"
#include "builder/smas/implicit_function.h"

namespace fascia::smas {

/// A front edge with the frame in which its triangle is sought: d along it, o to the free side, n up.
struct EdgeFrame {
  int e, a, b;
  Vec3 pa, pb, mid, d, o, n;
  double length, size;  ///< size: the edge length asked for around it

  /// False when the edge has no length or its normals no sum.
  bool set(const Front& front, int edge);
};

/// How edge lengths follow the bending of the surface, and how near to it vertices lie.
struct ProbeOptions {
  double longest, shortest;  ///< edges
  double max_normal_turn;    ///< radians along an edge
  double tolerance;          ///< distance to the surface
};

/// Finds points of the zero set of a function, and counts its calls.
class SurfaceProbe {
 public:
  struct Hit {
    bool found = false;
    Vec3 point, normal;
  };

  SurfaceProbe(const ImplicitFunction& function, const ProbeOptions& options)
      : function_(function), options_(options) {}

  /// Newton's x -= f g / |g|^2, with steps of at most `reach`.
  Hit descend(const Vec3& from, double reach);

  /// Where the apex of the triangle on `frame` should lie, by what the normals around foretell: no call.
  Vec3 foretell(const Front& front, const EdgeFrame& frame) const;

  /// The apex of the triangle on `frame`, with shorter steps where the normal turns too far; `size` receives
  /// the edge length that suits it.
  Hit apex(const Front& front, const EdgeFrame& frame, double* size);

  long evaluations() const { return evaluations_; }

 private:
  struct Bend {
    double across, along;  // curvature across and along the edge
  };
  Bend bend(const Front& front, const EdgeFrame& frame) const;
  double first_angle(const Bend& bend, const EdgeFrame& frame, double radius) const;
  double radius_for(const EdgeFrame& frame, double step) const;
  Hit spin(const EdgeFrame& frame, const Bend& bend, double radius);
  double evaluate(const Vec3& point, Vec3* gradient) {
    ++evaluations_;
    return function_(point, gradient);
  }

  const ImplicitFunction& function_;
  const ProbeOptions options_;
  long evaluations_ = 0;
};

/// Sheets whose normals make less than this cosine are not neighbours.
constexpr double kSameSheet = 0.3;

}  // namespace fascia::smas
