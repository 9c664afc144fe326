#pragma once

#include "bench/expressions/sculpted_head.h"
#include "fit/fit.h"

namespace fascia::bench {

/// What the face (3 x #face vertices, metres) should look like, of the subject; nothing is known of the rest.
fit::Target target_of(const KnownFace& face, const Eigen::VectorXd& truth);

/// Prints what calibration makes of the head's shapes, those fitted and those left out.
void calibrate_head(KnownFace& face, const anatomy::ExpressionSet& table);

/// Prints how well fits explain shapes that the head's muscles and tissue were not calibrated by: shapes fall
/// into `folds` parts, left and right into the same, and each part is fitted with what the others found.
void fit_calibrated_head(KnownFace& face, const anatomy::ExpressionSet& table, int folds,
                         const fit::FitOptions& options);

}  // namespace fascia::bench
