#include "fit/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fit/physique_search.h"
#include "geometry/error.h"

namespace fascia::fit {

namespace {

/// What one expression says of the gains: half a quadratic about the gains it was taken at.
struct Evidence {
  Eigen::MatrixXd hessian;  ///< #channels square
  Eigen::VectorXd slope;
  double mean_square = 0.0, target_square = 0.0;
};

class Calibrator {
 public:
  Calibrator(Subject& subject, const std::vector<CalibrationCase>& cases, const CalibrationOptions& options)
      : subject_(subject),
        cases_(cases),
        options_(options),
        fitter_(subject),
        count_(subject.channels().size()) {
    for (size_t c = 0; c < count_; ++c)
      other_side_.push_back(mirrored(c));
  }

  /// Gains from all cases, and what they make of each; of `judged` also what gains found without it do. Of
  /// the gains' way from 1 the first of `kept` remains with which those judged come out no worse than by the
  /// tables.
  Calibration run(const std::vector<bool>& judged, const std::vector<double>& kept) {
    Calibration out;
    Eigen::VectorXd gains = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(count_));
    std::vector<Evidence> all;
    for (int round = 0; round <= options_.rounds; ++round) {
      all = evidence(gains);
      if (round == 0) take_caution(all, gains);
      if (round == 0)
        for (size_t i = 0; i < cases_.size(); ++i)
          out.cases.push_back(
              {cases_[i].name, std::sqrt(all[i].mean_square), 0.0, share(all[i]), 0.0, 0.0, 0.0});
      if (round < options_.rounds) gains = solved(all, gains, cases_.size()).gains;
    }
    for (const double one : kept) {
      out.gains_kept = one;
      if (judge(all, gains, judged, one, out) <= 0.0) break;
    }
    if (out.gains_kept < 1.0) {
      gains = partly(gains, out.gains_kept);
      all = evidence(gains);
    }
    for (size_t i = 0; i < cases_.size(); ++i) {
      out.cases[i].after_mm = std::sqrt(all[i].mean_square);
      out.cases[i].after_share = share(all[i]);
    }
    out.gains.assign(gains.data(), gains.data() + gains.size());
    return out;
  }

  /// What the tables make of the cases.
  std::vector<CaseFigures> before() {
    std::vector<CaseFigures> list;
    for (const Evidence& one : evidence(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(count_)))) {
      list.push_back({cases_[list.size()].name, std::sqrt(one.mean_square), 0.0, share(one), 0.0, 0.0, 0.0});
      motion_.push_back(one.target_square);
    }
    return list;
  }
  const std::vector<double>& motion() const { return motion_; }  ///< by case, mm^2, after `before`

  Prospect prospect() {
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(count_));
    const std::vector<Evidence> all = evidence(ones);
    Prospect out;
    out.whole = solved(all, ones, cases_.size()).left;
    for (size_t i = 0; i < cases_.size(); ++i) {
      out.without.push_back(solved(all, ones, i).left);
      out.motion += all[i].target_square / static_cast<double>(cases_.size());
    }
    return out;
  }

 private:
  static double share(const Evidence& one) {
    return one.target_square > 0.0 ? 1.0 - one.mean_square / one.target_square : 0.0;
  }

  /// Gains with `kept` of their way from 1.
  static Eigen::VectorXd partly(const Eigen::VectorXd& gains, double kept) {
    return (1.0 + kept * (gains.array() - 1.0)).matrix();
  }

  /// Sets the figures of `judged` by gains found without each; how much more that leaves, mm^2, than the
  /// tables do.
  double judge(const std::vector<Evidence>& all, const Eigen::VectorXd& gains,
               const std::vector<bool>& judged, double kept, Calibration& out) {
    double more = 0.0;
    for (size_t i = 0; i < cases_.size(); ++i) {
      if (!judged[i]) continue;
      const Evidence without = evidence_of(i, partly(solved(all, gains, i).gains, kept));
      CaseFigures& figures = out.cases[i];
      figures.left_out_mm = std::sqrt(without.mean_square);
      figures.left_out_share = share(without);
      more += without.mean_square - figures.before_mm * figures.before_mm;
    }
    return more;
  }

  size_t mirrored(size_t channel) const {
    std::string name = subject_.channels()[channel].name;
    for (const auto& [side, other] :
         {std::pair<std::string, std::string>{"_left", "_right"}, {"_right", "_left"}})
      if (name.size() > side.size() && name.compare(name.size() - side.size(), side.size(), side) == 0) {
        const int32_t at = subject_.channel(name.substr(0, name.size() - side.size()) + other);
        return at >= 0 ? static_cast<size_t>(at) : channel;
      }
    return channel;
  }

  std::vector<float> driven(size_t i, const Eigen::VectorXd& gains) const {
    std::vector<float> values = cases_[i].activations;
    for (size_t c = 0; c < values.size(); ++c) {
      const rig::Channel& channel = subject_.channels()[c];
      const double moved =
          static_cast<double>(values[c] - channel.rest) * gains[static_cast<Eigen::Index>(c)];
      values[c] = std::clamp(channel.rest + static_cast<float>(moved), channel.minimum, channel.maximum);
    }
    return values;
  }

  Evidence evidence_of(size_t i, const Eigen::VectorXd& gains) {
    const Linearised pose = fitter_.linearised(cases_[i].target, driven(i, gains));
    const auto count = static_cast<Eigen::Index>(count_);
    Evidence out{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count), pose.mean_square,
                 pose.target_square};
    // d activation / d gain is what the table gives the channel.
    std::vector<double> given;  // an eye turns as far as it turns: only muscles and the jaw have gains
    for (uint32_t c : pose.channels)
      given.push_back(subject_.channels()[c].group == "eye"
                          ? 0.0
                          : static_cast<double>(cases_[i].activations[c] - subject_.channels()[c].rest));
    for (size_t a = 0; a < given.size(); ++a) {
      if (given[a] == 0.0) continue;
      const auto row = static_cast<Eigen::Index>(pose.channels[a]);
      out.slope[row] = given[a] * pose.slope[static_cast<Eigen::Index>(a)];
      for (size_t b = 0; b < given.size(); ++b)
        if (given[b] != 0.0)
          out.hessian(row, static_cast<Eigen::Index>(pose.channels[b])) =
              given[a] * given[b] * pose.hessian(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
    }
    return out;
  }

  /// Makes gains away from 1 as dear as serves expressions left out best, as far as the evidence foresees
  /// them (cross-validation: Stone 1974).
  void take_caution(const std::vector<Evidence>& all, const Eigen::VectorXd& at) {
    if (!options_.scales_prior) return;
    double best = std::numeric_limits<double>::infinity(), chosen = 1.0;
    for (const double caution : {1.0, 0.001, 0.01, 0.1, 0.3, 3.0, 10.0, 30.0, 100.0, 1000.0}) {
      caution_ = caution;
      double left = 0.0;
      for (size_t i = 0; i < all.size(); ++i) {
        const Eigen::VectorXd moved = solved(all, at, i).gains - at;
        left += all[i].mean_square + 2.0 * all[i].slope.dot(moved) + moved.dot(all[i].hessian * moved);
      }
      if (left >= best) continue;
      best = left;
      chosen = caution;
    }
    caution_ = chosen;
  }

  std::vector<Evidence> evidence(const Eigen::VectorXd& gains) {
    std::vector<Evidence> all;
    for (size_t i = 0; i < cases_.size(); ++i)
      all.push_back(evidence_of(i, gains));
    return all;
  }

  struct Solved {
    Eigen::VectorXd gains;
    double left = 0.0;  ///< mm^2, expected, with the price of the change from where the evidence was taken
  };

  /// The gains that all evidence but that of case `left_out` asks for, from where it was taken.
  Solved solved(const std::vector<Evidence>& all, const Eigen::VectorXd& at, size_t left_out) const {
    const auto count = static_cast<Eigen::Index>(count_);
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
    double motion = 0.0, left = 0.0;
    for (size_t i = 0; i < all.size(); ++i) {
      if (i == left_out) continue;
      left += all[i].mean_square;
      curvature += all[i].hessian;
      slope += all[i].slope;
      motion += all[i].target_square;
    }
    const double prior = caution_ * options_.prior * motion /
                         static_cast<double>(std::max<size_t>(1, all.size())),
                 pairing = options_.pairing / options_.prior * prior;
    for (Eigen::Index c = 0; c < count; ++c) {
      const auto other = static_cast<Eigen::Index>(other_side_[static_cast<size_t>(c)]);
      curvature(c, c) += prior;
      slope[c] += prior * (at[c] - 1.0);
      if (other == c) continue;
      curvature(c, c) += pairing;
      curvature(c, other) -= pairing;
      slope[c] += pairing * (at[c] - at[other]);
    }
    Eigen::VectorXd gains = at;
    Eigen::VectorXd pull = slope;  // slope + curvature (gains - at)
    for (int sweep = 0; sweep < 300; ++sweep) {
      double largest = 0.0;
      for (Eigen::Index c = 0; c < count; ++c) {
        const double next =
            std::clamp(gains[c] - pull[c] / curvature(c, c), options_.weakest, options_.strongest);
        const double change = next - gains[c];
        if (change == 0.0) continue;
        pull += change * curvature.col(c);
        gains[c] = next;
        largest = std::max(largest, std::abs(change));
      }
      if (largest < 1e-7) break;
    }
    const Eigen::VectorXd moved = gains - at;
    return {gains, left + 2.0 * slope.dot(moved) + moved.dot(curvature * moved)};
  }

  Subject& subject_;
  const std::vector<CalibrationCase>& cases_;
  CalibrationOptions options_;
  Fitter fitter_;
  size_t count_;
  std::vector<size_t> other_side_;
  std::vector<double> motion_;
  double caution_ = 1.0;  ///< times the price of gains
};

/// The expressions that move most, `most` of them.
std::vector<size_t> most_moving(const std::vector<CalibrationCase>& cases, size_t most) {
  std::vector<size_t> places;
  std::vector<double> motion;
  for (size_t i = 0; i < cases.size(); ++i) {
    places.push_back(i);
    motion.push_back(cases[i].target.displacements.squaredNorm());
  }
  std::stable_sort(places.begin(), places.end(), [&](size_t a, size_t b) { return motion[a] > motion[b]; });
  places.resize(std::min(places.size(), most));
  return places;
}

/// By case: the physique that the others ask for; last, the one that all ask for.
std::vector<Physique> physiques_of(const std::vector<CalibrationCase>& cases,
                                   const CalibrationOptions& options, const Remake& remake) {
  const std::vector<size_t> places = most_moving(cases, options.searched_cases);
  std::vector<CalibrationCase> searched;
  for (const size_t i : places)
    searched.push_back(cases[i]);
  PhysiqueSearch search(options, places.size(), [&](const Physique& physique) -> std::optional<Prospect> {
    const std::unique_ptr<Subject> subject = remake(physique);
    if (!subject) return std::nullopt;
    return Calibrator(*subject, searched, options).prospect();
  });
  const std::vector<Physique> found = search.run();
  std::vector<Physique> result(cases.size() + 1, found.back());
  for (size_t k = 0; k < places.size(); ++k)
    result[places[k]] = found[k];
  return result;
}

void sum_up(const std::vector<double>& motion, Calibration& out) {
  double whole = 0.0, before = 0.0, after = 0.0, left_out = 0.0;
  for (size_t i = 0; i < motion.size(); ++i) {
    whole += motion[i];
    before += out.cases[i].before_mm * out.cases[i].before_mm;
    after += out.cases[i].after_mm * out.cases[i].after_mm;
    left_out += out.cases[i].left_out_mm * out.cases[i].left_out_mm;
  }
  if (!(whole > 0.0)) return;
  out.before_share = 1.0 - before / whole;
  out.after_share = 1.0 - after / whole;
  out.left_out_share = 1.0 - left_out / whole;
}

/// The calibration with the physique that each case's others ask for and, last in `physiques`, the one that
/// all ask for.
Calibration calibrated_with(const std::vector<Physique>& physiques, Subject& subject,
                            const std::vector<CalibrationCase>& cases, const CalibrationOptions& options,
                            const Remake& remake) {
  const Physique own = physiques.back();
  // The person's own, then those that the cases left out ask for, each once.
  std::vector<Physique> distinct = {own};
  for (const Physique& physique : physiques)
    if (std::find(distinct.begin(), distinct.end(), physique) == distinct.end()) distinct.push_back(physique);
  Calibrator as_built(subject, cases, options);
  const std::vector<CaseFigures> before = as_built.before();
  std::vector<CaseFigures> left_out(cases.size());
  Calibration out;
  for (const Physique& physique : distinct) {
    std::vector<bool> judged;
    for (size_t i = 0; i < cases.size(); ++i)
      judged.push_back(physiques[i] == physique);
    const std::unique_ptr<Subject> other = physique == Physique() ? nullptr : remake(physique);
    Calibrator calibrator(other ? *other : subject, cases, options);
    const bool is_own = physique == own;
    const std::vector<double> kept = is_own ? std::vector{1.0, 0.5, 0.25, 0.0} : std::vector{out.gains_kept};
    const Calibration found = calibrator.run(judged, kept);
    for (size_t i = 0; i < cases.size(); ++i)
      if (judged[i]) left_out[i] = found.cases[i];
    if (is_own) out = found;
  }
  out.physique = own;
  for (size_t i = 0; i < cases.size(); ++i) {
    out.cases[i].before_mm = before[i].before_mm;
    out.cases[i].before_share = before[i].before_share;
    out.cases[i].left_out_mm = left_out[i].left_out_mm;
    out.cases[i].left_out_share = left_out[i].left_out_share;
  }
  sum_up(as_built.motion(), out);
  return out;
}

}  // namespace

Calibration calibrate(Subject& subject, const std::vector<CalibrationCase>& cases,
                      const CalibrationOptions& options, const Remake& remake) {
  if (cases.empty()) throw Error("there is no expression to calibrate by");
  const std::vector<Physique> as_built(cases.size() + 1);
  Calibration gains = calibrated_with(as_built, subject, cases, options, remake);
  if (!remake) return gains;
  const std::vector<Physique> physiques = physiques_of(cases, options, remake);
  if (physiques == as_built) return gains;
  // A physique is kept only where it serves expressions that were left out better than gains alone.
  Calibration both = calibrated_with(physiques, subject, cases, options, remake);
  return both.left_out_share > gains.left_out_share ? both : gains;
}

}  // namespace fascia::fit
