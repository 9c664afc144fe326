#include "runtime/drivers/response.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::runtime {
namespace {

/// Slope at a knot between pieces of lengths `before` and `after` that rise by `first` and `second` a unit:
/// their weighted harmonic mean, which keeps both pieces monotone.
float slope_between(float before, float after, float first, float second) {
  if (first <= 0.0F || second <= 0.0F) return 0.0F;
  const float a = 2.0F * after + before, b = after + 2.0F * before;
  return (a + b) / (a / first + b / second);
}

/// Slope at an end, by the parabola through the three knots beside it, within what keeps the piece monotone.
float slope_at_end(float length, float next, float first, float second) {
  const float slope = ((2.0F * length + next) * first - length * second) / (length + next);
  return std::clamp(slope, 0.0F, 3.0F * first);
}

}  // namespace

Response::Response(std::span<const float> weights, std::span<const float> shares) {
  if (weights.size() != shares.size()) throw Error("a response has not as many shares as weights");
  if (weights.empty()) return;
  knots_.push_back({0.0F, 0.0F, 0.0F});
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (!(weights[k] > knots_.back().weight && weights[k] < 1.0F))
      throw Error("the weights of a response do not rise between 0 and 1");
    if (!(shares[k] >= knots_.back().share && shares[k] <= 1.0F))
      throw Error("the shares of a response fall, or leave 0 to 1");
    knots_.push_back({weights[k], shares[k], 0.0F});
  }
  knots_.push_back({1.0F, 1.0F, 0.0F});
  const auto length = [&](std::size_t k) { return knots_[k + 1].weight - knots_[k].weight; };
  const auto rise = [&](std::size_t k) { return (knots_[k + 1].share - knots_[k].share) / length(k); };
  const std::size_t last = knots_.size() - 1;
  for (std::size_t k = 1; k < last; ++k)
    knots_[k].slope = slope_between(length(k - 1), length(k), rise(k - 1), rise(k));
  knots_[0].slope = slope_at_end(length(0), length(1), rise(0), rise(1));
  knots_[last].slope = slope_at_end(length(last - 1), length(last - 2), rise(last - 1), rise(last - 2));
}

std::size_t Response::piece(float size) const {
  std::size_t k = 1;
  while (k + 1 < knots_.size() && knots_[k].weight < size)
    ++k;
  return k;
}

float Response::share(float weight) const {
  const float size = std::abs(weight);
  if (knots_.empty() || size == 0.0F || !(size < 1.0F)) return weight;
  const std::size_t k = piece(size);
  const Knot &a = knots_[k - 1], &b = knots_[k];
  const float length = b.weight - a.weight, t = (size - a.weight) / length, u = 1.0F - t;
  const float share = u * u * ((1.0F + 2.0F * t) * a.share + t * length * a.slope) +
                      t * t * ((1.0F + 2.0F * u) * b.share - u * length * b.slope);
  return std::copysign(share, weight);
}

float Response::slope(float weight) const {
  const float size = std::abs(weight);
  if (knots_.empty() || !(size < 1.0F)) return 1.0F;
  const std::size_t k = piece(size);
  const Knot &a = knots_[k - 1], &b = knots_[k];
  const float length = b.weight - a.weight, t = (size - a.weight) / length, u = 1.0F - t;
  return 6.0F * t * u * (b.share - a.share) / length + u * (1.0F - 3.0F * t) * a.slope +
         t * (1.0F - 3.0F * u) * b.slope;
}

}  // namespace fascia::runtime
