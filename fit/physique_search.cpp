#include "fit/physique_search.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fascia::fit {

namespace {

/// In the order in which they are tried.
std::array<double*, 8> factors_of(Physique& physique) {
  auto& [depth, stiffness, shortening, breadth] = physique;
  return {&depth,         &stiffness,  &shortening[2], &shortening[1],
          &shortening[0], &breadth[2], &breadth[1],    &breadth[0]};
}

}  // namespace

std::vector<Physique> PhysiqueSearch::run() {
  if (!tried({})) return std::vector<Physique>(count_ + 1);
  Physique best;
  for (double* factor : factors_of(best))
    search(best, *factor);
  std::vector<Physique> result;
  for (size_t without = 0; without <= count_; ++without)
    result.push_back(trials_[best_of(without)].physique);
  return result;
}

/// In shares of the expressions' motion, as a gain's is: 1 for a factor at its bound.
double PhysiqueSearch::price_of(Physique physique) const {
  const double width = std::log(options_.most_factor);
  double sum = 0.0;
  for (const double* factor : factors_of(physique))
    sum += std::pow(std::log(*factor) / width, 2);
  return options_.prior * sum;
}

bool PhysiqueSearch::tried(const Physique& physique) {
  std::optional<Prospect> prospect = foresee_(physique);
  if (!prospect) return false;
  const double price = price_of(physique) * prospect->motion;
  trials_.push_back({physique, std::move(*prospect), price});
  return true;
}

/// What a trial leaves of all expressions but `without`; of all where that is none of them.
double PhysiqueSearch::value(size_t trial, size_t without) const {
  const Trial& at = trials_[trial];
  return at.price + (without < count_ ? at.prospect.without[without] : at.prospect.whole);
}

size_t PhysiqueSearch::best_of(size_t without) const {
  size_t best = 0;
  for (size_t t = 1; t < trials_.size(); ++t)
    if (value(t, without) < value(best, without)) best = t;
  return best;
}

/// Both sides of a factor, then the vertex of the parabola through the three; leaves the best.
void PhysiqueSearch::search(Physique& best, double& factor) {
  const size_t middle = best_of(count_);
  const double step = 0.5 * std::log(options_.most_factor);
  double values[3] = {0.0, value(middle, count_), 0.0};
  for (const int side : {-1, 1}) {
    factor = std::exp(side * step);
    if (!tried(best)) {
      factor = 1.0;
      return;
    }
    values[side + 1] = value(trials_.size() - 1, count_);
  }
  const double bend = values[0] - 2.0 * values[1] + values[2];
  const double vertex = bend > 0.0              ? 0.5 * step * (values[0] - values[2]) / bend
                        : values[0] < values[2] ? -2.0 * step
                                                : 2.0 * step;
  factor = std::clamp(std::exp(vertex), options_.least_factor, options_.most_factor);
  if (std::abs(std::log(factor)) > 0.02) tried(best);  // changes below 2 % are ignored
  best = trials_[best_of(count_)].physique;
}

}  // namespace fascia::fit
