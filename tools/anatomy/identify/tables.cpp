#include "tools/anatomy/identify/tables.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace fascia::identify {
namespace {

/// One shape of one head, as it is or in the mirror.
struct Observation {
  FittedHead* head;
  const Eigen::VectorXd* truth;
  double square, weight;
  bool is_mirrored;
};

/// Sum of squared error over the shape's square, and its model by the parameters.
struct Model {
  double value = 0.0;
  Eigen::MatrixXd curvature;
  Eigen::VectorXd slope;  ///< half the gradient
};

class RowFit {
 public:
  RowFit(const ShapeEntry& entry, const Weights& base, std::vector<FittedHead>& heads,
         const TableOptions& options, std::vector<Parameter> list)
      : base_(base), options_(options), list_(std::move(list)) {
    double sum = 0.0;
    for (FittedHead& head : heads)
      for (const bool is_mirrored : {false, true}) {
        if (is_mirrored && !options.both_sides) continue;
        const std::string name = is_mirrored ? entry.mirror() : entry.name();
        const auto found = head.face->shapes().find(name);
        if (name.empty() || found == head.face->shapes().end()) continue;
        const double sides = entry.mirror().empty() ? 1.0 : 0.5;
        seen_.push_back({&head, &found->second.truth, found->second.truth.squaredNorm(), sides * head.weight,
                         is_mirrored});
        sum += seen_.back().weight;
      }
    for (Observation& o : seen_)
      o.weight /= sum;
  }

  bool empty() const { return seen_.empty(); }
  const std::vector<Parameter>& list() const { return list_; }

  Weights weights(const Eigen::VectorXd& x) const {
    Weights total = base_;
    for (size_t p = 0; p < list_.size(); ++p)
      for (const auto& [name, limit] : list_[p].limits)
        total[name] += x[static_cast<Eigen::Index>(p)] * limit;
    return total;
  }

  double price(const Eigen::VectorXd& x) const {
    return options_.ridge * x.squaredNorm() + options_.sparsity * x.cwiseAbs().sum();
  }

  /// Error at `x`; with `model` also its linearisation. One thread a head.
  double look(const Eigen::VectorXd& x, Model* model, std::vector<double>* shares = nullptr) {
    const Weights own = weights(x), other = mirrored(own);
    std::vector<double> values(seen_.size());
    std::vector<Eigen::MatrixXd> curvatures(seen_.size());
    std::vector<Eigen::VectorXd> slopes(seen_.size());
    const auto work = [&](size_t o) {
      const Observation& seen = seen_[o];
      const Weights& played = seen.is_mirrored ? other : own;
      const Eigen::VectorXd gap = seen.head->pose(played) - *seen.truth;
      values[o] = gap.squaredNorm() / seen.square;
      if (model == nullptr) return;
      std::vector<Parameter> list = list_;
      if (seen.is_mirrored)
        for (Parameter& p : list)
          p.limits = mirrored(p.limits);
      const Eigen::MatrixXd jacobian = seen.head->slopes(played, list);
      curvatures[o] = jacobian.transpose() * jacobian / seen.square;
      slopes[o] = jacobian.transpose() * gap / seen.square;
    };
    run_by_head(work);
    double sum = 0.0;
    for (size_t o = 0; o < seen_.size(); ++o)
      sum += seen_[o].weight * values[o];
    if (shares != nullptr) *shares = values;
    if (model != nullptr) {
      const auto n = static_cast<Eigen::Index>(list_.size());
      model->value = sum;
      model->curvature = Eigen::MatrixXd::Zero(n, n);
      model->slope = Eigen::VectorXd::Zero(n);
      for (size_t o = 0; o < seen_.size(); ++o) {
        model->curvature += seen_[o].weight * curvatures[o];
        model->slope += seen_[o].weight * slopes[o];
      }
    }
    return sum;
  }

  /// Coordinate descent on the model with its prices, within `reach` of `x` and 0 to 1.
  Eigen::VectorXd aim(const Model& model, const Eigen::VectorXd& x, double reach) const {
    const auto n = x.size();
    Eigen::MatrixXd curvature = model.curvature;
    curvature.diagonal().array() += options_.ridge + 1e-9;
    Eigen::VectorXd next = x, pull = model.slope + options_.ridge * x;
    for (int sweep = 0; sweep < 500; ++sweep) {
      double largest = 0.0;
      for (Eigen::Index i = 0; i < n; ++i) {
        const double wanted = next[i] - (pull[i] + 0.5 * options_.sparsity) / curvature(i, i);
        const double change =
            std::clamp(wanted, std::max(0.0, x[i] - reach), std::min(1.0, x[i] + reach)) - next[i];
        if (change == 0.0) continue;
        pull += change * curvature.col(i);
        next[i] += change;
        largest = std::max(largest, std::abs(change));
      }
      if (largest < 1e-6) break;
    }
    return next;
  }

  Eigen::VectorXd run(Eigen::VectorXd x, int rounds) {
    if (x.size() == 0) return x;  // all of the row is given
    double reach = 0.35;
    Model model;
    look(x, &model);
    double value = model.value + price(x);
    for (int round = 0; round < rounds && reach > 0.01; ++round) {
      const Eigen::VectorXd there = aim(model, x, reach);
      if ((there - x).cwiseAbs().maxCoeff() < 0.005) break;
      const double next = look(there, nullptr) + price(there);
      if (next >= value) {
        reach *= 0.4;
        continue;
      }
      const double gain = value - next;
      x = there;
      value = next;
      if (gain < 5e-4) break;
      look(x, &model);
    }
    last_ = model;
    return x;
  }

  /// Leaves out, one after the other, what the rest can do nearly as well.
  Eigen::VectorXd pruned(const Eigen::VectorXd& start) {
    Eigen::VectorXd x = run(start, options_.rounds);
    std::vector<Parameter> kept;
    std::vector<double> values;
    for (size_t p = 0; p < list_.size(); ++p) {
      const auto i = static_cast<Eigen::Index>(p);
      if (x[i] < 0.01 || x[i] * x[i] * last_.curvature(i, i) < options_.least_gain) continue;
      kept.push_back(list_[p]);
      values.push_back(x[i]);
    }
    if (kept.empty() || kept.size() == list_.size()) return x;
    list_ = std::move(kept);
    return run(Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())), 4);
  }

  const std::vector<Observation>& seen() const { return seen_; }

 private:
  /// Observations of one head one after the other, heads on two threads.
  template <class Work>
  void run_by_head(const Work& work) {
    const auto half = [&](size_t which) {
      for (size_t o = 0; o < seen_.size(); ++o) {
        size_t head = 0;
        for (size_t other = 1; other <= o; ++other)
          head += seen_[other].head != seen_[other - 1].head ? 1 : 0;
        if (head % 2 == which) work(o);
      }
    };
    std::thread second([&] { half(1); });
    half(0);
    second.join();
  }

  Weights base_;
  TableOptions options_;
  std::vector<Parameter> list_;
  std::vector<Observation> seen_;
  Model last_;
};

}  // namespace

FittedRow fit_row(const ShapeEntry& entry, const Weights& base, const Weights& start,
                  std::vector<FittedHead>& heads, const TableOptions& options, double reach) {
  Weights played = base;
  for (const auto& [name, value] : entry.given)
    played[name] += value;
  for (const auto& [name, value] : entry.bones)
    played[name] += value;
  const std::vector<Parameter> list = parameters(entry, heads[0].face->subject().channels(), reach);
  RowFit fit(entry, played, heads, options, list);
  FittedRow row;
  if (fit.empty()) return row;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(list.size()));
  Weights left = start;  // of the present row, from which the fit sets out
  for (const auto& [name, value] : entry.given)
    if (left.contains(name)) left[name] -= value;
  for (const bool is_both : {true, false})  // what two sides share before what one has more
    for (size_t p = 0; p < list.size(); ++p) {
      if ((list[p].limits.size() > 1) != is_both) continue;
      double most = 1.0;
      for (const auto& [name, limit] : list[p].limits)
        most = std::min(most, left.contains(name) ? left[name] / limit : 0.0);
      if (most <= 0.0) continue;
      x[static_cast<Eigen::Index>(p)] = most;
      for (const auto& [name, limit] : list[p].limits)
        left[name] -= most * limit;
    }
  x = fit.pruned(x);
  std::vector<double> errors;
  row.share = 1.0 - fit.look(x, nullptr, &errors);
  for (const double error : errors)
    row.shares.push_back(1.0 - error);
  row.weights = fit.weights(x);
  for (const auto& [name, value] : base)  // of the shape that it corrects
    row.weights[name] -= value;
  std::erase_if(row.weights, [](const auto& item) { return std::abs(item.second) < 0.005; });
  return row;
}

}  // namespace fascia::identify
