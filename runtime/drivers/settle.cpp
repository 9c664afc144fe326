#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "geometry/error.h"
#include "runtime/drivers/aliases.h"
#include "runtime/drivers/curves.h"

namespace fascia::runtime {
namespace {

constexpr double longest_take = 6 * 3600.0;  // seconds
/// A recording in which nothing comes for so long, and for so many of its usual steps, was stopped between.
constexpr double longest_pause = 600.0;  // seconds
constexpr double most_steps = 100.0;
constexpr double noted_gap = 60.0;  // seconds
constexpr double pause_left = 1.0;  // seconds that remain of such a pause

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

float peak(const Curve& curve) {
  float most = 0.0F;
  for (const float value : curve.values)
    most = std::max(most, std::abs(value));
  return most;
}

void scale(Curve& curve, float by) {
  for (auto* list : {&curve.values, &curve.tangents_in, &curve.tangents_out})
    for (float& value : *list)
      value *= by;
}

/// The first of a few names, and how many more there are.
std::string some(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 3; ++i)
    text += (i > 0 ? ", " : "") + names[i];
  return names.size() > 3 ? text + " and " + std::to_string(names.size() - 3) + " more" : text;
}

/// All times at which any curve has a key, rising, each once.
std::vector<double> times_of_keys(const Curves& curves) {
  std::vector<double> times;
  const std::vector<double>* last = nullptr;
  for (const Curve& curve : curves.curves) {
    if (last == nullptr || *last != curve.times)
      times.insert(times.end(), curve.times.begin(), curve.times.end());
    last = &curve.times;
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

double median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i)
    steps.push_back(times[i] - times[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

struct Pause {
  double end = 0.0;    ///< seconds, where the file has it
  double taken = 0.0;  ///< seconds that are taken off, of this pause and of all before it
};

/// Shortens pauses of the recorder to one second, so that they are not simulated, and notes other long gaps.
void shorten_pauses(Curves& curves) {
  const std::vector<double> times = times_of_keys(curves);
  if (times.size() < 2) return;
  // Of two keys nothing tells whether the time between them is meant.
  const double longest = times.size() > 2 ? std::max(longest_pause, most_steps * median_step(times))
                                          : std::numeric_limits<double>::infinity();
  std::vector<Pause> pauses;
  double taken = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double pause = times[i] - times[i - 1];
    if (pause <= longest) {
      if (pause > noted_gap)
        curves.notes.push_back("there is no row for " + rounded(pause) + " s from " +
                               rounded(times[i - 1] - times.front()) +
                               " s on, and all of that time is played: if it is not meant, cut it out");
      continue;
    }
    pauses.push_back({times[i], taken += pause - pause_left});
    curves.notes.push_back("nothing was recorded for " + rounded(pause) + " s from " +
                           rounded(times[i - 1] - times.front()) +
                           " s on: of this pause 1 s is left, and what follows comes earlier");
  }
  for (Curve& curve : curves.curves) {
    std::size_t passed = 0;
    for (double& time : curve.times) {
      while (passed < pauses.size() && time >= pauses[passed].end)
        ++passed;
      if (passed > 0) time -= pauses[passed - 1].taken;
    }
  }
}

void start_at_zero(Curves& curves) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Curve& curve : curves.curves) {
    if (curve.times.empty()) continue;
    first = std::min(first, curve.times.front());
    last = std::max(last, curve.times.back());
  }
  if (!std::isfinite(first)) return;
  if (last - first > longest_take)
    throw Error("curves: they last " + rounded((last - first) / 3600.0) +
                " hours, and a take at most 6: if its times are not seconds, say what they are (`time_ms`)");
  curves.start += first;
  if (first != 0.0)
    for (Curve& curve : curves.curves)
      for (double& time : curve.times)
        time -= first;
}

/// OpenFace gives action units as intensity and as presence: the first says more.
void prefer_intensity(Curves& curves) {
  std::map<std::string, bool> has_intensity;
  for (const Curve& curve : curves.curves)
    if (const Alias* alias = find_alias(curve.name); alias && alias->measure == Measure::intensity)
      has_intensity[alias->targets[0].first] = true;
  std::erase_if(curves.curves, [&](const Curve& curve) {
    const Alias* alias = find_alias(curve.name);
    return alias && alias->measure == Measure::presence && has_intensity[alias->targets[0].first];
  });
}

constexpr float most_percent = 150.0F;  // captures go beyond 100 a little
constexpr float most_intensity = 5.5F;  // below, a value may be an intensity from 0 to 5

/// Whether a column is percent though the others are shares: it goes beyond intensities, and more than a few
/// of its values do beyond 1; one or two in a take are faults of the capture.
bool is_percent(const Curve& curve) {
  const float most = peak(curve);
  if (!(most > most_intensity && most <= most_percent)) return false;
  std::size_t active = 0, beyond = 0;
  for (const float value : curve.values) {
    active += std::abs(value) > 0.02F;
    beyond += std::abs(value) > 1.5F;
  }
  return beyond >= std::min<std::size_t>(2, curve.values.size()) && 10 * beyond >= active;
}

/// Shares beyond 1: action units from 0 to 5, percent, or a value that will be clamped.
void scale_to_shares(Curves& curves) {
  std::vector<Curve*> shares, units;
  for (Curve& curve : curves.curves) {
    const Alias* alias = find_alias(curve.name);
    const Measure measure = alias ? alias->measure : Measure::share;
    if (measure == Measure::intensity) scale(curve, 0.2F);
    if (measure == Measure::share) shares.push_back(&curve);
    if (measure == Measure::action_unit) units.push_back(&curve);
  }
  const auto largest = [](const std::vector<Curve*>& list) {
    float most = 0.0F;
    for (const Curve* curve : list)
      most = std::max(most, peak(*curve));
    return most;
  };
  const float unit_peak = largest(units);
  if (unit_peak > 1.5F && unit_peak <= most_intensity) {
    curves.notes.push_back("action units reach " + rounded(unit_peak) + ": taken as intensities from 0 to 5");
    for (Curve* curve : units)
      scale(*curve, 0.2F);
  } else {
    shares.insert(shares.end(), units.begin(), units.end());
  }
  std::size_t beyond = 0, active = 0;
  for (const Curve* curve : shares) {
    active += peak(*curve) > 0.02F;
    beyond += peak(*curve) > 1.5F;
  }
  const float most = largest(shares);
  if (most > 2.0F && most <= most_percent && 2 * beyond > active) {
    curves.notes.push_back("values reach " + rounded(most) + ": taken as percent");
    for (Curve* curve : shares)
      scale(*curve, 0.01F);
    return;
  }
  std::vector<std::string> names, percent;
  for (Curve* curve : shares) {
    if (is_percent(*curve)) {
      percent.push_back(curve->name);
      scale(*curve, 0.01F);
    } else if (peak(*curve) > 1.001F) {
      names.push_back(curve->name);
    }
  }
  if (!percent.empty())
    curves.notes.push_back("values reach " + rounded(most) + " in some columns: taken as percent in " +
                           some(percent));
  if (!names.empty())
    curves.notes.push_back("values beyond 1, up to " + rounded(largest(shares)) +
                           ", are cut off at the channels' ends: " + some(names));
}

}  // namespace

void settle(Curves& curves) {
  std::erase_if(curves.curves, [](const Curve& curve) {
    const Alias* alias = find_alias(curve.name);
    return curve.times.empty() || (alias && alias->measure == Measure::none);
  });
  if (curves.curves.empty()) throw Error("curves: the file has no column of values");
  prefer_intensity(curves);
  shorten_pauses(curves);
  start_at_zero(curves);
  scale_to_shares(curves);
}

}  // namespace fascia::runtime
