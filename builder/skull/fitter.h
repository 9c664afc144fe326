#pragma once

#include <map>
#include <memory>
#include <string>

#include "builder/skull/skull.h"

namespace fascia::skull {

/// An interactive skull fit: everything that depends on the generic skull and the set of landmarks is
/// factored once, so that moving a landmark or scaling a depth updates the fit at interactive rates.
///
/// The constraints that keep bone inside the skin are chosen once, in the constructor, and afterwards follow
/// the skin; vertex by vertex the correction is always made anew. After a large change make a new Fitter.
class Fitter {
 public:
  /// Fits as `fit` does. `generic` and the teeth in `options` are not kept by reference beyond the call;
  /// `skin` is cheap to copy. Throws as `fit` does.
  Fitter(Generic generic, Exterior skin, const std::map<std::string, TargetLandmark>& landmarks,
         const FitOptions& options = {});
  ~Fitter();
  Fitter(Fitter&&) noexcept;
  Fitter& operator=(Fitter&&) noexcept;

  const FitResult& result() const;

  /// Puts the landmark `name` at `position` (m, on the skin); its confidence stays.
  /// Throws Error when it is not among the landmarks of this fit or the position is not finite.
  const FitResult& move_landmark(const std::string& name, const Vec3& position);

  /// Sets sigma, the scale of all depths. Throws Error outside 0.05 to 10.
  const FitResult& set_tissue_scale(double scale);

  /// Sets k, the scale of one landmark's depth. Throws Error for an unknown landmark or a scale outside 0.05
  /// to 10.
  const FitResult& set_depth_scale(const std::string& landmark, double scale);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::skull
