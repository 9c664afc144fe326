#include "bench/fit/calibrated.h"

#include <algorithm>
#include <cstdio>
#include <functional>

#include "fit/calibration.h"

namespace fascia::bench {

fit::Target target_of(const KnownFace& face, const Eigen::VectorXd& truth) {
  const size_t count = face.subject().vertex_count();
  fit::Target target{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * count)),
                     std::vector<double>(count, 0.0)};
  for (size_t v = 0; v < face.face().size(); ++v) {
    target.displacements.segment<3>(static_cast<Eigen::Index>(3 * face.face()[v])) =
        truth.segment<3>(static_cast<Eigen::Index>(3 * v));
    target.confidence[face.face()[v]] = 1.0;
  }
  return target;
}

namespace {

fit::Remake remake_of(const fit::Subject& subject) {
  return [&subject](const fit::Physique& physique) -> std::unique_ptr<fit::Subject> {
    if (physique.takes_build()) return nullptr;  // another build: `fascia calibrate` has it
    rig::RigFile file = subject.file();
    file.rig = fit::with_physique(std::move(file.rig), physique);
    return std::make_unique<fit::Subject>(std::move(file), subject.level_name());
  };
}

void print(const std::string& name, const std::string& what, const fit::Calibration& found) {
  std::printf(
      "%-16s %-12s share %.3f before, %.3f after, %.3f of shapes left out; stiffness %.2f, shortening %.2f "
      "%.2f %.2f\n",
      name.c_str(), what.c_str(), found.before_share, found.after_share, found.left_out_share,
      found.physique.stiffness, found.physique.shortening[0], found.physique.shortening[1],
      found.physique.shortening[2]);
  std::fflush(stdout);
}

/// The head's expressions as they look with other muscles: stronger and weaker by turns, by a factor of 0.6
/// or 1.5, in tissue a quarter stiffer; and how near calibration comes to those factors.
void calibrate_changed(KnownFace& face, const std::vector<fit::CalibrationCase>& cases) {
  fit::Subject& subject = face.subject();
  std::vector<double> strength(subject.channels().size(), 1.0);
  for (size_t c = 0; c < strength.size(); ++c)
    if (subject.channels()[c].group == "muscle") {
      const std::string name = subject.channels()[c].name;
      strength[c] =
          std::hash<std::string>()(name.substr(0, name.rfind('_'))) % 2 == 0 ? 0.6 : 1.5;  // left like right
    }
  const std::unique_ptr<fit::Subject> person = remake_of(subject)({1.0, 1.25, {1.0, 1.0, 1.0}});
  std::vector<fit::CalibrationCase> seen;
  for (const fit::CalibrationCase& one : cases) {
    std::vector<float> values = one.activations;
    for (size_t c = 0; c < values.size(); ++c)
      values[c] = std::clamp(values[c] * static_cast<float>(strength[c]), subject.channels()[c].minimum,
                             subject.channels()[c].maximum);
    person->pose(values, false);
    seen.push_back({one.name, {person->displacements(values), one.target.confidence}, one.activations});
  }
  print(face.head().name, "changed", fit::calibrate(subject, seen, {}, remake_of(subject)));
}

}  // namespace

void calibrate_head(KnownFace& face, const anatomy::ExpressionSet& table) {
  std::vector<fit::CalibrationCase> cases;
  for (const auto& [name, shape] : face.shapes())
    if (table.find(name) != nullptr)
      cases.push_back({name, target_of(face, shape.truth), face.activations(table, shape.values)});
  print(face.head().name, "gains", fit::calibrate(face.subject(), cases));
  print(face.head().name, "all", fit::calibrate(face.subject(), cases, {}, remake_of(face.subject())));
  calibrate_changed(face, cases);
}

}  // namespace fascia::bench
