#include "fit/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

  /// Gains from all cases, and what they make of each; of `judged` also what gains found without it do.
  Calibration run(const std::vector<bool>& judged) {
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
    for (size_t i = 0; i < cases_.size(); ++i) {
      out.cases[i].after_mm = std::sqrt(all[i].mean_square);
      out.cases[i].after_share = share(all[i]);
      if (!judged[i]) continue;
      const Evidence without = evidence_of(i, solved(all, gains, i).gains);
      out.cases[i].left_out_mm = std::sqrt(without.mean_square);
      out.cases[i].left_out_share = share(without);
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

  /// What the gains that would suit best leave, mm^2 with their price: of all cases, and by case, of the
  /// others.
  struct Prospect {
    double whole = 0.0, motion = 0.0;
    std::vector<double> without;
  };
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
    double best = std::numeric_limits<double>::infinity(), chosen = 1.0;
    for (const double caution : {1.0, 3.0, 10.0, 30.0, 100.0, 1000.0}) {
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

/// Tries physiques, one factor after the other.
class PhysiqueSearch {
 public:
  PhysiqueSearch(const std::vector<CalibrationCase>& cases, const CalibrationOptions& options,
                 const Remake& remake)
      : options_(options), remake_(remake), places_(most_moving(cases)) {
    for (const size_t i : places_)
      cases_.push_back(cases[i]);
  }

  /// By case: the physique that the others ask for; last, the one that all ask for. All of them as built
  /// where another cannot be made.
  std::vector<Physique> run(size_t count) {
    if (!tried({})) return std::vector<Physique>(count + 1);
    Physique best;
    const std::vector<double*> factors = {&best.depth, &best.stiffness, &best.shortening[2],
                                          &best.shortening[1], &best.shortening[0]};
    for (double* factor : factors)
      search(best, *factor);
    std::vector<Physique> result(count + 1, trials_[best_of(places_.size())].physique);
    for (size_t k = 0; k < places_.size(); ++k)
      result[places_[k]] = trials_[best_of(k)].physique;
    return result;
  }

 private:
  struct Trial {
    Physique physique;
    Calibrator::Prospect prospect;
    double price = 0.0;
  };

  std::vector<size_t> most_moving(const std::vector<CalibrationCase>& cases) const {
    std::vector<size_t> places;
    std::vector<double> motion;
    for (size_t i = 0; i < cases.size(); ++i) {
      places.push_back(i);
      motion.push_back(cases[i].target.displacements.squaredNorm());
    }
    std::stable_sort(places.begin(), places.end(), [&](size_t a, size_t b) { return motion[a] > motion[b]; });
    places.resize(std::min(places.size(), options_.searched_cases));
    return places;
  }

  /// In shares of the expressions' motion, as a gain's is: 1 for a factor at its bound.
  double price_of(const Physique& physique) const {
    const double width = std::log(options_.most_factor);
    double sum = 0.0;
    for (const double factor : {physique.depth, physique.stiffness, physique.shortening[0],
                                physique.shortening[1], physique.shortening[2]})
      sum += std::pow(std::log(factor) / width, 2);
    return options_.prior * sum;
  }

  bool tried(const Physique& physique) {
    const std::unique_ptr<Subject> subject = remake_(physique);
    if (!subject) return false;
    Trial trial{physique, Calibrator(*subject, cases_, options_).prospect(), 0.0};
    trial.price = price_of(physique) * trial.prospect.motion;
    trials_.push_back(std::move(trial));
    return true;
  }

  double value(size_t trial, size_t without) const {
    const Trial& at = trials_[trial];
    return at.price + (without < places_.size() ? at.prospect.without[without] : at.prospect.whole);
  }

  size_t best_of(size_t without) const {
    size_t best = 0;
    for (size_t t = 1; t < trials_.size(); ++t)
      if (value(t, without) < value(best, without)) best = t;
    return best;
  }

  /// Both sides of a factor, then the vertex of the parabola through the three; leaves the best.
  void search(Physique& best, double& factor) {
    const size_t middle = best_of(places_.size());
    const double step = 0.5 * std::log(options_.most_factor);
    double values[3] = {0.0, value(middle, places_.size()), 0.0};
    for (const int side : {-1, 1}) {
      factor = std::exp(side * step);
      if (!tried(best)) {
        factor = 1.0;
        return;
      }
      values[side + 1] = value(trials_.size() - 1, places_.size());
    }
    const double bend = values[0] - 2.0 * values[1] + values[2];
    const double vertex = bend > 0.0              ? 0.5 * step * (values[0] - values[2]) / bend
                          : values[0] < values[2] ? -2.0 * step
                                                  : 2.0 * step;
    factor = std::clamp(std::exp(vertex), options_.least_factor, options_.most_factor);
    if (std::abs(std::log(factor)) > 0.02) tried(best);  // nearer to 1 it is as built
    best = trials_[best_of(places_.size())].physique;
  }

  const CalibrationOptions& options_;
  const Remake& remake_;
  std::vector<size_t> places_;  ///< among all cases, of those searched by
  std::vector<CalibrationCase> cases_;
  std::vector<Trial> trials_;
};

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

}  // namespace

Calibration calibrate(Subject& subject, const std::vector<CalibrationCase>& cases,
                      const CalibrationOptions& options, const Remake& remake) {
  if (cases.empty()) throw Error("there is no expression to calibrate by");
  std::vector<Physique> physiques(cases.size() + 1);
  if (remake) physiques = PhysiqueSearch(cases, options, remake).run(cases.size());
  const Physique own = physiques.back();
  // Those that the cases left out ask for, each once; the person's own last.
  std::vector<Physique> distinct;
  for (const Physique& physique : physiques)
    if (physique != own && std::find(distinct.begin(), distinct.end(), physique) == distinct.end())
      distinct.push_back(physique);
  distinct.push_back(own);
  Calibrator as_built(subject, cases, options);
  const std::vector<CaseFigures> before = as_built.before();
  std::vector<CaseFigures> left_out(cases.size());
  Calibration out;
  for (const Physique& physique : distinct) {
    std::vector<bool> judged;
    for (size_t i = 0; i < cases.size(); ++i)
      judged.push_back(physiques[i] == physique);
    const std::unique_ptr<Subject> other = physique == Physique() ? nullptr : remake(physique);
    out = Calibrator(other ? *other : subject, cases, options).run(judged);
    for (size_t i = 0; i < cases.size(); ++i)
      if (judged[i]) left_out[i] = out.cases[i];
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

}  // namespace fascia::fit
