#include "bench/fit/calibrated.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>

#include "bench/expressions/score.h"
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

/// The shape without its side, so that left and right are left out together.
std::string without_side(const std::string& name) {
  for (const std::string side : {"Left", "Right"})
    if (name.ends_with(side)) return name.substr(0, name.size() - side.size());
  return name;
}

std::vector<fit::CalibrationCase> cases_of(const KnownFace& face, const anatomy::ExpressionSet& table) {
  std::vector<fit::CalibrationCase> cases;
  for (const auto& [name, shape] : face.shapes())
    if (table.find(name) != nullptr)
      cases.push_back({name, target_of(face, shape.truth), face.activations(table, shape.values)});
  return cases;
}

}  // namespace

void fit_calibrated_head(KnownFace& face, const anatomy::ExpressionSet& table, int folds,
                         const fit::FitOptions& options) {
  std::vector<Vec3> rest;
  for (const size_t v : face.face())
    rest.push_back(face.subject().rest().segment<3>(static_cast<Eigen::Index>(3 * v)));
  const std::vector<fit::CalibrationCase> cases = cases_of(face, table);
  std::map<std::string, int> fold_of;
  for (const fit::CalibrationCase& one : cases)
    fold_of.emplace(without_side(one.name), 0);
  int next = 0;
  for (auto& [name, fold] : fold_of)
    fold = next++ % folds;
  double before = 0.0, after = 0.0;
  for (int fold = 0; fold < folds; ++fold) {
    std::vector<fit::CalibrationCase> others;
    for (const fit::CalibrationCase& one : cases)
      if (fold_of[without_side(one.name)] != fold) others.push_back(one);
    const fit::Remake remake = remake_of(face.subject());
    const fit::Calibration found = fit::calibrate(face.subject(), others, {}, remake);
    const std::unique_ptr<fit::Subject> person = remake(found.physique);
    print(face.head().name, "part " + std::to_string(fold + 1), found);
    fit::Fitter as_built(face.subject(), options), as_found(*person, options);
    for (const fit::CalibrationCase& one : cases) {
      if (fold_of[without_side(one.name)] != fold) continue;
      const Eigen::VectorXd& truth = face.shapes().at(one.name).truth;
      const auto share = [&](fit::Fitter& fitter) {
        return score(rest, face.triangles(), face.face_rows(fitter.fit(one.target).displacements), truth)
            .explained;
      };
      const double was = share(as_built), is = share(as_found);
      std::printf("%-16s %-20s fit %6.3f, calibrated without it %6.3f\n", face.head().name.c_str(),
                  one.name.c_str(), was, is);
      before += was;
      after += is;
    }
  }
  const auto count = static_cast<double>(cases.size());
  std::printf("%-16s mean of %zu shapes: fit %.3f, fit after calibration without them (%d parts) %.3f\n",
              face.head().name.c_str(), cases.size(), before / count, folds, after / count);
  std::fflush(stdout);
}

void calibrate_head(KnownFace& face, const anatomy::ExpressionSet& table) {
  const std::vector<fit::CalibrationCase> cases = cases_of(face, table);
  print(face.head().name, "gains", fit::calibrate(face.subject(), cases));
  print(face.head().name, "all", fit::calibrate(face.subject(), cases, {}, remake_of(face.subject())));
  calibrate_changed(face, cases);
}

}  // namespace fascia::bench
