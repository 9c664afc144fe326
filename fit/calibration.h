#pragma once

#include <string>
#include <vector>

#include "fit/fit.h"

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
};

struct CaseFigures {
  std::string name;
  double before_mm = 0.0, after_mm = 0.0;  ///< root mean square distance from the target
  double before_share = 0.0, after_share = 0.0;
  double left_out_share = 0.0, left_out_mm = 0.0;  ///< with gains found from the other expressions alone
};

struct Calibration {
  std::vector<double>
      gains;  ///< one a channel: how much more strongly this person's muscle answers; 1: as the table
  std::vector<CaseFigures> cases;
  double before_share = 0.0, after_share = 0.0, left_out_share = 0.0;  ///< of all expressions' squared motion
};

/// Finds what tells this person's muscles from the tables': one gain a channel, the same in every expression,
/// by Gauss-Newton on the full simulation of all `cases` at once, left like right and near 1 unless the scans
/// say otherwise. Each case is then judged by gains found without it. Throws fascia::Error when there are no
/// cases.
Calibration calibrate(Subject& subject, const std::vector<CalibrationCase>& cases,
                      const CalibrationOptions& options = {});

}  // namespace fascia::fit
