#pragma once

#include "builder/muscles/hull.h"
#include "builder/muscles/muscles.h"

namespace fascia::muscles {

/// Thickness of the soft tissue over and under the vertices of the SMAS, to put points at a depth;
/// measured where it is asked for. Not shared between threads.
class Depths {
 public:
  /// `floors` are the surfaces soft tissue ends on: bones and teeth. Tissue under the SMAS is taken as at
  /// most `deepest` metres thick, as where cheeks and lips are not over bone.
  Depths(const Carrier& smas, const spatial::SurfaceQuery& skin,
         std::vector<const spatial::SurfaceQuery*> floors, double deepest);

  /// The point over or under `place` at `fraction` of the way from skin (0) to bone (1).
  FibrePoint at(const SurfacePoint& place, double fraction) const;

  /// The point at `fraction` over or under the place of the SMAS nearest to `position`; `position` itself,
  /// not bound, where the SMAS ends half a millimetre or more beside it.
  FibrePoint near(const Vec3& position, double fraction) const;

  /// Thickness of all soft tissue at `place`, metres.
  double thickness(const SurfacePoint& place) const;

  const Carrier& smas() const { return smas_; }
  const spatial::SurfaceQuery& skin() const { return skin_; }

 private:
  struct Layers {
    double over = -1.0, under = 0.0;  // metres; not measured yet while `over` is negative
  };
  Layers layers(const SurfacePoint& place) const;

  const Carrier& smas_;
  const spatial::SurfaceQuery& skin_;
  std::vector<const spatial::SurfaceQuery*> floors_;
  double deepest_;
  mutable std::vector<Layers> measured_;
};

/// Value of evenly spaced `samples` at `share` in 0..1, linear between them.
double sampled(const std::vector<double>& samples, double share);

/// `points` of a polyline resampled to `count` at equal distances.
std::vector<Vec3> resampled(const std::vector<Vec3>& points, int count);

double polyline_length(const std::vector<Vec3>& points);

/// How many points a fibre of `length` metres gets.
int point_count(double length, const Options& options);

/// How many fibres of `muscle` lie side by side over `width` metres.
int fibre_count(double width, const anatomy::Muscle& muscle, const Options& options);

/// A point off the SMAS, with the nearest place of it.
FibrePoint unbound(const Carrier& smas, const Vec3& position);

}  // namespace fascia::muscles
