#pragma once

#include "bench/expressions/sculpted_head.h"
#include "fit/fit.h"

namespace fascia::bench {

/// What the face (3 x #face vertices, metres) should look like, of the subject; nothing is known of the rest.
fit::Target target_of(const KnownFace& face, const Eigen::VectorXd& truth);

/// Prints what calibration makes of the head's shapes, those fitted and those left out.
void calibrate_head(KnownFace& face, const anatomy::ExpressionSet& table);

}  // namespace fascia::bench
