#include "fit/calibration.h"

#include <algorithm>
#include <cmath>

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

  Calibration run() {
    Calibration out;
    Eigen::VectorXd gains = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(count_));
    std::vector<Evidence> all;
    for (int round = 0; round <= options_.rounds; ++round) {
      all = evidence(gains);
      if (round == 0)
        for (size_t i = 0; i < cases_.size(); ++i)
          out.cases.push_back(
              {cases_[i].name, std::sqrt(all[i].mean_square), 0.0, share(all[i]), 0.0, 0.0, 0.0});
      if (round < options_.rounds) gains = best_gains(all, gains, cases_.size());
    }
    for (size_t i = 0; i < cases_.size(); ++i) {
      out.cases[i].after_mm = std::sqrt(all[i].mean_square);
      out.cases[i].after_share = share(all[i]);
      const Evidence without = evidence_of(i, best_gains(all, gains, i));
      out.cases[i].left_out_mm = std::sqrt(without.mean_square);
      out.cases[i].left_out_share = share(without);
    }
    out.gains.assign(gains.data(), gains.data() + gains.size());
    sum_up(all, out);
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

  std::vector<Evidence> evidence(const Eigen::VectorXd& gains) {
    std::vector<Evidence> all;
    for (size_t i = 0; i < cases_.size(); ++i)
      all.push_back(evidence_of(i, gains));
    return all;
  }

  /// The gains that all evidence but that of case `left_out` asks for, from where it was taken.
  Eigen::VectorXd best_gains(const std::vector<Evidence>& all, const Eigen::VectorXd& at,
                             size_t left_out) const {
    const auto count = static_cast<Eigen::Index>(count_);
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
    double motion = 0.0;
    for (size_t i = 0; i < all.size(); ++i) {
      if (i == left_out) continue;
      curvature += all[i].hessian;
      slope += all[i].slope;
      motion += all[i].target_square;
    }
    const double prior = options_.prior * motion / static_cast<double>(std::max<size_t>(1, all.size())),
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
    return gains;
  }

  void sum_up(const std::vector<Evidence>& all, Calibration& out) const {
    double whole = 0.0, before = 0.0, after = 0.0, left_out = 0.0;
    for (size_t i = 0; i < all.size(); ++i) {
      whole += all[i].target_square;
      before += out.cases[i].before_mm * out.cases[i].before_mm;
      after += out.cases[i].after_mm * out.cases[i].after_mm;
      left_out += out.cases[i].left_out_mm * out.cases[i].left_out_mm;
    }
    if (!(whole > 0.0)) return;
    out.before_share = 1.0 - before / whole;
    out.after_share = 1.0 - after / whole;
    out.left_out_share = 1.0 - left_out / whole;
  }

  Subject& subject_;
  const std::vector<CalibrationCase>& cases_;
  CalibrationOptions options_;
  Fitter fitter_;
  size_t count_;
  std::vector<size_t> other_side_;
};

}  // namespace

Calibration calibrate(Subject& subject, const std::vector<CalibrationCase>& cases,
                      const CalibrationOptions& options) {
  if (cases.empty()) throw Error("there is no expression to calibrate by");
  return Calibrator(subject, cases, options).run();
}

}  // namespace fascia::fit
