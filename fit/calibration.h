#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fit/fit.h"
#include "fit/physique.h"

namespace fascia::fit {

/// An expression of the person: what it looks like, and what the rig's tables say makes it.
struct CalibrationCase {
  std::string name;
  Target target;
  std::vector<float> activations;  ///< one a channel
};

struct CalibrationOptions {
  int rounds = 3;  ///< Gauss-Newton steps
  double prior =
      0.02;  ///< what a gain of 1 costs beside 0 or 2, in shares of the expressions' mean squared motion
  double weakest = 0.4;  ///< bounds of a gain: muscle cross-sections of adults vary by about these factors...
  double strongest = 2.0;  ///< ...(docs/fit.md)
  double pairing = 0.1;    ///< what left differing from right costs, in the same shares
  /// Bounds of the factors of a physique: depths of soft tissue have standard deviations of a sixth to a
  /// third of their means between adults (anatomy/data/tissue_depths.json), and no more is granted to the
  /// rest.
  double least_factor = 0.7, most_factor = 1.4;
  size_t searched_cases =
      12;  ///< the physique is found from as many expressions at most, those that move most
};

/// The subject with another physique, or null when it cannot be made.
using Remake = std::function<std::unique_ptr<Subject>(const Physique&)>;

struct CaseFigures {
  std::string name;
  double before_mm = 0.0, after_mm = 0.0;  ///< root mean square distance from the target
  double before_share = 0.0, after_share = 0.0;
  double left_out_share = 0.0, left_out_mm = 0.0;  ///< with gains found from the other expressions alone
};

struct Calibration {
  std::vector<double>
      gains;  ///< one a channel: how much more strongly this person's muscle answers; 1: as the table
  Physique physique;
  std::vector<CaseFigures> cases;
  double before_share = 0.0, after_share = 0.0, left_out_share = 0.0;  ///< of all expressions' squared motion
};

/// Finds what tells this person's muscles from the tables': one gain a channel, the same in every expression,
/// by Gauss-Newton on the full simulation of all `cases` at once, left like right and near 1 unless the scans
/// say otherwise; the price of that is raised where it serves expressions left out. With `remake`, first the
/// person's physique: one factor after the other is tried on the full simulation, each with the gains that
/// would then suit best, and kept where the expressions want it (profile likelihood). Each case is then
/// judged by gains, and a physique, found without it. Throws fascia::Error when there are no cases.
Calibration calibrate(Subject& subject, const std::vector<CalibrationCase>& cases,
                      const CalibrationOptions& options = {}, const Remake& remake = {});

}  // namespace fascia::fit
