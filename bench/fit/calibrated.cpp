#include "bench/fit/calibrated.h"

#include <cstdio>

#include "fit/calibration.h"

namespace fascia::bench {

fit::Target target_of(const KnownFace& face, const Eigen::VectorXd& truth) {
  const size_t count = face.subject().vertex_count();
  fit::Target target{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * count)),
                     std::vector<double>(count, 0.0)};
  for (size_t v = 0; v < face.face().size(); ++v) {
    target.displacements.segment<3>(static_cast<Eigen::Index>(3 * face.face()[v])) =
        truth.segment<3>(static_cast<Eigen::Index>(3 * v));
    target.trust[face.face()[v]] = 1.0;
  }
  return target;
}

void calibrate_head(KnownFace& face, const anatomy::ExpressionSet& table) {
  std::vector<fit::CalibrationCase> cases;
  for (const auto& [name, shape] : face.shapes())
    if (table.find(name) != nullptr)
      cases.push_back({name, target_of(face, shape.truth), face.activations(table, shape.values)});
  const fit::Calibration found = fit::calibrate(face.subject(), cases);
  std::printf("%-16s calibrated: share %.3f before, %.3f after, %.3f of shapes left out\n",
              face.head().name.c_str(), found.before_share, found.after_share, found.left_out_share);
}

}  // namespace fascia::bench
