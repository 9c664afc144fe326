#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "geometry/error.h"
#include "runtime/drivers/aliases.h"
#include "runtime/drivers/curves.h"
#include "runtime/drivers/table.h"
#include "runtime/drivers/text.h"
#include "runtime/drivers/timecode.h"

namespace fascia::runtime {
namespace {

std::string where(std::size_t row, std::string_view column) {
  return "curves: row " + std::to_string(row) + ", column " + shown(column) + ": ";
}

/// Seconds in one unit of a column of times, by the column's name; 0 when it is none.
double time_unit(std::string_view name) {
  const std::string key = spelled(name);
  for (const char* seconds :
       {"time",          "times",        "seconds",      "sec",          "t",
        "timestamp",     "timestamps",   "times(s)",     "time(s)",      "time[s]",
        "timesec",       "timeseconds",  "timestampsec", "timecode",     "time(sec)",
        "time(seconds)", "timestamp(s)", "elapsed",      "elapsed_time", "elapsed_seconds",
        "unix_time",     "frame_time"})
    if (key == spelled(seconds)) return 1.0;
  for (const char* milliseconds :
       {"time_ms", "times_ms", "timestamp_ms", "timestamp(ms)", "elapsed_ms", "ms", "milliseconds",
        "time(ms)", "time[ms]", "time_milliseconds", "timestamp_milliseconds"})
    if (key == spelled(milliseconds)) return 1e-3;
  for (const char* microseconds : {"time_us", "timestamp_us", "microseconds"})
    if (key == spelled(microseconds)) return 1e-6;
  for (const char* nanoseconds : {"time_ns", "timestamp_ns", "nanoseconds"})
    if (key == spelled(nanoseconds)) return 1e-9;
  return 0.0;
}

/// A mark for a value that a recorder did not have.
bool is_missing(std::string_view cell) {
  const std::string word = lower_ascii(cell);
  return word.empty() || word == "nan" || word == "-nan" || word == "null" || word == "none" ||
         word == "n/a" || word == "na" || word == "-" || word == "nil" || word == "inf" || word == "-inf" ||
         word == "#n/a" || word == "nan(ind)" || word == "-nan(ind)";
}

std::optional<double> cell_number(std::string_view cell) {
  if (const auto value = number(cell)) return value;
  return number(cell, true);  // a cell is no comma's neighbour: it can only be a decimal one
}

/// "57 %" is .57.
std::optional<double> cell_value(std::string_view cell) {
  if (cell.empty() || cell.back() != '%') return cell_number(cell);
  cell.remove_suffix(1);
  while (!cell.empty() && cell.back() == ' ')
    cell.remove_suffix(1);
  const auto percent = cell_number(cell);
  return percent ? std::optional(*percent / 100.0) : std::nullopt;
}

struct Columns {
  std::optional<std::size_t> time;
  double unit = 1.0;
  bool is_timecode = false;
  std::vector<std::size_t> clocks;  ///< every column of times, `time` among them
};

bool is_timecode_column(const Table& table, std::size_t column) {
  for (const auto& row : table.rows)
    if (!row[column].empty()) return row[column].find_first_of(":;") != std::string::npos;
  return false;
}

Columns find_columns(const Table& table) {
  Columns columns;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const double unit = time_unit(table.header[c]);
    if (unit == 0.0) continue;
    columns.clocks.push_back(c);
    const bool is_timecode = is_timecode_column(table, c);
    // Plain times say more than timecodes.
    if (columns.time && !(columns.is_timecode && !is_timecode)) continue;
    columns.time = c;
    columns.unit = unit;
    columns.is_timecode = is_timecode;
  }
  return columns;
}

/// A name in any spelling, but for letters that stand alone: x and X may be pixels and millimetres.
std::string column_key(std::string_view name) {
  constexpr std::string_view joints = "_-. :", sides = "lLrR";
  std::string key = spelled(name) + "|";
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of(joints, begin), name.size());
    if (end == begin + 1 && sides.find(name[begin]) == sides.npos) key += name[begin];
    begin = end + 1;
  }
  return key;
}

/// Two columns for one thing would count twice.
void refuse_repeated_columns(const Table& table) {
  std::map<std::string, std::size_t> seen;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    if (table.header[c].empty()) continue;
    const Alias* alias = find_alias(table.header[c]);
    if (alias && alias->measure == Measure::none) continue;
    const std::string key = alias ? "alias " + alias->name : column_key(table.header[c]);
    const auto [before, is_new] = seen.emplace(key, c);
    if (!is_new)
      throw Error("curves: row 1: columns " + std::to_string(before->second + 1) + " (" +
                  shown(table.header[before->second]) + ") and " + std::to_string(c + 1) + " (" +
                  shown(table.header[c]) + ") are the same: take one of them out");
  }
}

std::vector<double> timecode_column(const Table& table, std::size_t column, double given, Curves& result) {
  std::vector<Timecode> codes;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto code = timecode(table.rows[row][column]);
    if (!code)
      throw Error(where(table.lines[row], table.header[column]) + "\"" + shown(table.rows[row][column]) +
                  "\" is not hours:minutes:seconds:frame");
    codes.push_back(*code);
  }
  for (std::size_t row = 0; given > 0.0 && row < codes.size(); ++row)
    if (std::floor(codes[row].frame) >= std::round(given))
      throw Error(where(table.lines[row], table.header[column]) + "frame " +
                  std::to_string(static_cast<int>(codes[row].frame)) + " cannot be in a second of " +
                  std::to_string(static_cast<int>(std::round(given))) + ": give another rate (--fps-in)");
  TimecodeTimes times = timecode_times(codes, given);
  char rate[32];
  std::snprintf(rate, sizeof rate, "%.6g", times.rate);
  result.frames_per_second = times.rate;
  const std::string counted = std::string("timecode of ") + rate + " frames a second" +
                              (times.is_drop_frame ? ", with dropped frames" : "");
  result.notes.push_back(times.rate_is_known ? counted : counted + ", as nothing in the take shows its rate");
  return times.seconds;
}

std::vector<double> plain_column(const Table& table, std::size_t column) {
  std::vector<double> times;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& cell = table.rows[row][column];
    const auto time = cell_number(cell);
    if (!time)
      throw Error(where(table.lines[row], table.header[column]) + "\"" + shown(cell) + "\" is not a number");
    times.push_back(*time);
  }
  return times;
}

/// Times in seconds: a wall clock in milli-, micro- or nanoseconds is known by its size; steps no recorder
/// makes are milliseconds.
void to_seconds(std::vector<double>& times, double unit, double given, Curves& result) {
  if (given > 0.0) {
    unit = given;
  } else if (unit == 1.0 && times.size() > 1) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i)
      steps.push_back(std::abs(times[i] - times[i - 1]));
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    const bool is_wall_clock = std::abs(times[0]) > 1e11;
    if (is_wall_clock || (times.size() >= 10 && *middle >= 4.0 && *middle <= 250.0)) {
      const double size = std::abs(times[0]);
      unit = size > 1e17 ? 1e-9 : size > 1e14 ? 1e-6 : 1e-3;
      result.notes.emplace_back(unit == 1e-3   ? "times are taken as milliseconds"
                                : unit == 1e-6 ? "times are taken as microseconds"
                                               : "times are taken as nanoseconds");
    }
  }
  const double first = times[0];
  for (double& time : times)
    time = (time - first) * unit;
  result.start = first * unit;
}

/// The order in which times rise. A row a little out of its place is put there; of rows at one time the last
/// counts; time that goes back for good is refused.
std::vector<std::size_t> order_of(const Table& table, const std::vector<double>& times, std::string_view name,
                                  Curves& result) {
  constexpr std::size_t farthest = 16;
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  std::size_t moved = 0, first_moved = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t away = order[i] > i ? order[i] - i : i - order[i];
    if (away > farthest) {
      std::size_t row = 1;
      while (row + 1 < times.size() && times[row] >= times[row - 1])
        ++row;
      throw Error(where(table.lines[row], name) +
                  "time goes back, and not for a few rows: are these two takes?");
    }
    if (away > 0 && moved++ == 0) first_moved = table.lines[i];
  }
  std::vector<std::size_t> kept;
  std::size_t repeated = 0;
  for (const std::size_t row : order) {
    if (!kept.empty() && times[kept.back()] == times[row]) {
      kept.back() = row;
      ++repeated;
    } else {
      kept.push_back(row);
    }
  }
  if (moved > 0)
    result.notes.push_back("rows were not in the order of time and are sorted, from row " +
                           std::to_string(first_moved) + " on");
  if (repeated > 0)
    result.notes.push_back(std::to_string(repeated) +
                           " rows have the time of the row before; the last of each counts");
  return kept;
}

/// Rows in which OpenFace found no face.
bool is_lost(const Table& table, const std::vector<std::string>& row) {
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const std::string name = spelled(table.header[c]);
    if (name != "success" && name != "confidence") continue;
    const auto value = cell_number(row[c]);
    if (value && *value < 0.5) return true;
  }
  return false;
}

struct Gaps {
  std::size_t cells = 0, first_line = 0, lost = 0;
};

/// A take is as long as its rows, whichever of their cells are empty: the first and the last value are held.
void hold_ends(Curve& curve, double first, double last) {
  if (curve.times.front() > first) {
    curve.times.insert(curve.times.begin(), first);
    curve.values.insert(curve.values.begin(), curve.values.front());
  }
  if (curve.times.back() < last) {
    curve.times.push_back(last);
    curve.values.push_back(curve.values.back());
  }
}

/// Whether a column has cells, and none of them is a number: labels, names of pictures.
bool is_text(const Table& table, std::size_t column) {
  bool has_letters = false;
  for (const auto& row : table.rows) {
    if (is_missing(row[column])) continue;
    const auto is_letter = [](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80;
    };
    if (cell_value(row[column])) return false;
    has_letters = has_letters || std::any_of(row[column].begin(), row[column].end(), is_letter);
  }
  return has_letters;
}

Curve read_column(const Table& table, std::size_t c, const std::vector<std::size_t>& order,
                  const std::vector<double>& times, const std::vector<bool>& lost, Gaps& gaps) {
  Curve curve;
  curve.name = table.header[c];
  for (const std::size_t row : order) {
    if (lost[row]) continue;
    const std::string& cell = table.rows[row][c];
    if (is_missing(cell)) {
      if (!cell.empty() && gaps.cells++ == 0) gaps.first_line = table.lines[row];
      continue;
    }
    const auto value = cell_value(cell);
    if (!value) throw Error(where(table.lines[row], curve.name) + "\"" + shown(cell) + "\" is not a number");
    curve.times.push_back(times[row]);
    curve.values.push_back(static_cast<float>(*value));
  }
  if (!curve.times.empty()) hold_ends(curve, times[order.front()], times[order.back()]);
  return curve;
}

std::vector<double> times_of(const Table& table, const Columns& columns, const ReadOptions& options,
                             Curves& result) {
  if (columns.time && columns.is_timecode)
    return timecode_column(table, *columns.time, options.frames_per_second, result);
  std::vector<double> times(table.rows.size());
  if (options.frames_per_second > 0.0) {
    for (std::size_t row = 0; row < times.size(); ++row)
      times[row] = static_cast<double>(row) / options.frames_per_second;
    result.frames_per_second = options.frames_per_second;
    return times;
  }
  if (!columns.time)
    throw Error(
        "curves: neither JSON, glTF nor a table with a `time` (seconds) or `Timecode` column in its first "
        "line; "
        "rows without times need their rate (--fps-in)");
  times = plain_column(table, *columns.time);
  to_seconds(times, columns.unit, options.time_unit, result);
  return times;
}

}  // namespace

Curves read_csv_curves(std::string_view text, const ReadOptions& options) {
  const Table table = read_table(text);
  const Columns columns = find_columns(table);
  if (!columns.time && options.frames_per_second <= 0.0) {
    Curves none;
    times_of(table, columns, options, none);
  }
  if (table.rows.empty()) throw Error("curves: the CSV file has no rows");
  refuse_repeated_columns(table);
  Curves result;
  const std::vector<double> times = times_of(table, columns, options, result);
  const std::string clock = columns.time ? table.header[*columns.time] : "time";
  const std::vector<std::size_t> order = order_of(table, times, clock, result);
  Gaps gaps;
  std::vector<bool> lost(table.rows.size());
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    lost[row] = is_lost(table, table.rows[row]);
    gaps.lost += lost[row];
  }
  std::string texts;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    if (table.header[c].empty()) continue;
    if (std::find(columns.clocks.begin(), columns.clocks.end(), c) != columns.clocks.end()) continue;
    if (const Alias* alias = find_alias(table.header[c]); alias && alias->measure == Measure::none) continue;
    if (is_text(table, c)) {
      texts += (texts.empty() ? "" : ", ") + shown(table.header[c]);
      continue;
    }
    Curve curve = read_column(table, c, order, times, lost, gaps);
    if (!curve.times.empty()) result.curves.push_back(std::move(curve));
  }
  if (result.curves.empty()) throw Error("curves: the CSV file has no column of values");
  if (!texts.empty()) result.notes.push_back("columns without a number are left out: " + texts);
  if (gaps.lost > 0)
    result.notes.push_back(std::to_string(gaps.lost) +
                           " rows without a face found (success, confidence) are bridged");
  if (gaps.cells > 0)
    result.notes.push_back(std::to_string(gaps.cells) +
                           " cells without a number are bridged, the first in row " +
                           std::to_string(gaps.first_line));
  if (!table.short_lines.empty())
    result.notes.push_back(std::to_string(table.short_lines.size()) +
                           " rows end early and are bridged, the first row " +
                           std::to_string(table.short_lines[0]));
  return result;
}

}  // namespace fascia::runtime
