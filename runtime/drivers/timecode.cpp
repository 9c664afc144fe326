#include "runtime/drivers/timecode.h"

#include <algorithm>
#include <cmath>

#include "runtime/drivers/text.h"

namespace fascia::runtime {
namespace {

long second_of(const Timecode& code) {
  return 3600L * code.hours + 60L * code.minutes + code.seconds;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What the rows say of the number of frames in a second.
struct Seen {
  double highest = 0.0;            ///< frame number
  std::vector<double> rates;       ///< where a second follows another within a minute
  std::vector<double> drop_rates;  ///< where a minute that drops frames begins
};

Seen look(const std::vector<Timecode>& codes) {
  Seen seen;
  std::vector<double> steps;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    seen.highest = std::max(seen.highest, codes[i].frame);
    if (i > 0 && second_of(codes[i]) == second_of(codes[i - 1]) && codes[i].frame > codes[i - 1].frame)
      steps.push_back(codes[i].frame - codes[i - 1].frame);
  }
  if (steps.empty()) return seen;
  const double step = median(steps);
  for (std::size_t i = 1; i < codes.size(); ++i) {
    if (second_of(codes[i]) != second_of(codes[i - 1]) + 1) continue;
    const double rate = codes[i - 1].frame + step - codes[i].frame;
    const bool begins_minute = codes[i].seconds == 0 && codes[i].minutes % 10 != 0;
    (begins_minute ? seen.drop_rates : seen.rates).push_back(rate);
  }
  return seen;
}

/// The usual rate nearest above, when it is near: clocks round, and a row may be missing.
double usual_rate(double rate) {
  for (const double usual : {24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0, 240.0})
    if (std::abs(rate - usual) < 0.75) return usual;
  return std::max(1.0, std::round(rate));
}

/// The same from the frames numbered between two seconds of which the later begins a minute: two or four less
/// where numbers are dropped.
double rate_by_minute(double rate) {
  if (std::abs(rate - 28.0) < 0.5) return 30.0;
  if (std::abs(rate - 56.0) < 0.5) return 60.0;
  return usual_rate(rate);
}

}  // namespace

std::optional<Timecode> timecode(std::string_view text) {
  double fields[4] = {};
  Timecode code;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t end = i < 3 ? text.find_first_of(i == 2 ? ":;." : ":;") : std::string_view::npos;
    if (i < 3 && end == std::string_view::npos) return std::nullopt;
    const auto field = number(text.substr(0, end));
    if (!field || *field < 0 || *field > 1e6 || (i < 3 && *field != std::floor(*field))) return std::nullopt;
    fields[i] = *field;
    if (i == 2) code.marks_drop_frame = text[end] != ':';
    if (i < 3) text.remove_prefix(end + 1);
  }
  if (fields[1] >= 60 || fields[2] >= 60) return std::nullopt;
  code.hours = static_cast<int>(fields[0]);
  code.minutes = static_cast<int>(fields[1]);
  code.seconds = static_cast<int>(fields[2]);
  code.frame = fields[3];
  return code;
}

TimecodeTimes timecode_times(const std::vector<Timecode>& codes, double given) {
  TimecodeTimes result;
  const Seen seen = look(codes);
  const double least = std::floor(seen.highest) + 1.0;
  double nominal = 60.0;
  if (given > 0.0) {
    nominal = std::round(given);
  } else if (!seen.rates.empty()) {
    nominal = std::max(usual_rate(median(seen.rates)), least);
  } else if (!seen.drop_rates.empty()) {
    nominal = std::max(rate_by_minute(median(seen.drop_rates)), least);
  } else if (least > 60.0) {
    nominal = usual_rate(least);
  }
  result.rate_is_known = given > 0.0 || !seen.rates.empty() || !seen.drop_rates.empty();
  const bool can_drop = nominal == 30.0 || nominal == 60.0;
  const double dropped = nominal == 60.0 ? 4.0 : 2.0;
  result.is_drop_frame = !codes.empty() && codes[0].marks_drop_frame && can_drop;
  if (can_drop && !seen.drop_rates.empty() && std::abs(median(seen.drop_rates) - (nominal - dropped)) < 0.5)
    result.is_drop_frame = true;
  result.rate = result.is_drop_frame ? nominal * 1000.0 / 1001.0 : given > 0.0 ? given : nominal;
  double first = 0.0, days = 0.0, before = 0.0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    double count = static_cast<double>(second_of(codes[i])) * nominal + codes[i].frame;
    const long minutes = 60L * codes[i].hours + codes[i].minutes;
    if (result.is_drop_frame) count -= dropped * static_cast<double>(minutes - minutes / 10);
    double time = count / result.rate;
    if (i > 0 && time + days < before - 12 * 3600.0) days += 24 * 3600.0;  // past midnight
    time += days;
    if (i == 0) first = time;
    before = time;
    result.seconds.push_back(time - first);
  }
  return result;
}

}  // namespace fascia::runtime
