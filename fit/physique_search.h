#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "fit/calibration.h"

namespace fascia::fit {

/// What the gains that would suit a physique best leave of a person's expressions, mm^2 with their price.
struct Prospect {
  double whole = 0.0;           ///< of all expressions
  double motion = 0.0;          ///< mean squared motion of the expressions
  std::vector<double> without;  ///< by expression: of the others, with gains found without it
};

/// Tries physiques, one factor after the other.
class PhysiqueSearch {
 public:
  /// `foresee` says what a physique promises for the `count` expressions searched by; none when it cannot be
  /// made.
  using Foresee = std::function<std::optional<Prospect>(const Physique&)>;
  PhysiqueSearch(const CalibrationOptions& options, size_t count, Foresee foresee)
      : options_(options), count_(count), foresee_(std::move(foresee)) {}

  /// By expression: the physique that the others ask for; last, the one that all ask for. All of them as
  /// built where another cannot be made.
  std::vector<Physique> run();

 private:
  struct Trial {
    Physique physique;
    Prospect prospect;
    double price = 0.0;
  };

  double price_of(Physique physique) const;
  bool tried(const Physique& physique);
  double value(size_t trial, size_t without) const;
  size_t best_of(size_t without) const;
  void search(Physique& best, double& factor);

  const CalibrationOptions& options_;
  size_t count_;
  Foresee foresee_;
  std::vector<Trial> trials_;
};

}  // namespace fascia::fit
