#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fit/fit.h"
#include "fit/physique.h"

namespace fascia::fit {

/// An expression of the person: the observation, and its activations by the rig's tables.
struct CalibrationCase {
  std::string name;
  Target target;
  std::vector<float> activations;  ///< one a channel
};

struct CalibrationOptions {
  int rounds = 3;  ///< Gauss-Newton steps
  double prior =
      0.02;  ///< penalty for a gain of 0 or 2 instead of 1, relative to the expressions' mean squared motion
  bool scales_prior = true;  ///< cross-validation chooses a factor of the prior, from 0.001 to 1000
  double weakest = 0.4;  ///< bounds of a gain: muscle cross-sections of adults vary by about these factors...
  double strongest = 2.0;  ///< ...(docs/fit.md)
  double pairing = 0.1;    ///< penalty for differences between left and right, likewise
  /// Bounds of the factors of a physique: depths of soft tissue have standard deviations of a sixth to a
  /// third of their means between adults (anatomy/data/tissue_depths.json), and the same bounds are used for
  /// the others.
  double least_factor = 0.7, most_factor = 1.4;
  size_t searched_cases =
      12;  ///< largest number of expressions used for the physique, those with the largest motion
};

/// The subject with another physique, or null if it cannot be built.
using Remake = std::function<std::unique_ptr<Subject>(const Physique&)>;

struct CaseFigures {
  std::string name;
  double before_mm = 0.0, after_mm = 0.0;  ///< root mean square distance from the target
  double before_share = 0.0, after_share = 0.0;
  double left_out_share = 0.0, left_out_mm = 0.0;  ///< with gains found from the other expressions alone
};

struct Calibration {
  std::vector<double> gains;  ///< one per channel: gain of this person's muscle relative to the table
  /// Share of the gains' change from 1 that held-out expressions support: 1, 1/2, 1/4 or 0 of what was found.
  double gains_kept = 1.0;
  Physique physique;
  std::vector<CaseFigures> cases;
  double before_share = 0.0, after_share = 0.0, left_out_share = 0.0;  ///< of all expressions' squared motion
};

/// Identifies the gains of a person's muscles: one per channel, the same in every expression, by Gauss-Newton
/// on the full simulation of all `cases` at once, regularised towards 1 and towards symmetry, with the weight
/// of the regularisation chosen by cross-validation; if held-out expressions nevertheless become worse than
/// with the tables, only a part of the gains is kept, or none. With `remake`, the person's physique is
/// identified first: a search over one factor after another on the full simulation, each with re-optimised
/// gains (profile likelihood). Finally each case is evaluated with gains and a physique found without it.
/// Throws fascia::Error if there are no cases.
Calibration calibrate(Subject& subject, const std::vector<CalibrationCase>& cases,
                      const CalibrationOptions& options = {}, const Remake& remake = {});

}  // namespace fascia::fit
