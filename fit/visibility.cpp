#include "fit/visibility.h"

#include <algorithm>

namespace fascia::fit {

namespace {

constexpr double little_seen = 0.2;  // of what a channel moves: below, it begins to hold
constexpr double held = 1e3;         // of a channel that nothing is seen of, in usual prices of change

}  // namespace

void Visibility::begin(const Eigen::VectorXd& confidence, bool is_next) {
  ever_ =
      is_next && ever_.size() == confidence.size() ? Eigen::VectorXd(ever_.cwiseMax(confidence)) : confidence;
  is_whole_ = ever_ == confidence;
  if (is_whole_) shares_.resize(0);
}

void Visibility::find(const Eigen::VectorXd& shown, const Eigen::VectorXd& whole) {
  shares_.resize(shown.size());
  for (Eigen::Index i = 0; i < shown.size(); ++i)
    shares_[i] = whole[i] > 0.0 ? std::clamp(shown[i] / whole[i], 0.0, 1.0) : 1.0;
}

double Visibility::hold(Eigen::Index i) const {
  const double unseen = std::max(0.0, 1.0 - share(i) / little_seen);
  return held * unseen * unseen;
}

}  // namespace fascia::fit
