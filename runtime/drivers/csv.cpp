#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "geometry/error.h"
#include "runtime/drivers/curves.h"

namespace fascia::runtime {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && blank(text.back()))
    text.remove_suffix(1);
  return text;
}

bool same_name(std::string_view a, std::string_view b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
         });
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> cells(std::string_view line) {
  // A file with semicolons has decimal commas nowhere else in it: take whichever separates.
  const char separator =
      line.find(',') == std::string_view::npos && line.find(';') != std::string_view::npos ? ';' : ',';
  std::vector<std::string_view> parts = split(line, separator);
  for (std::string_view& part : parts)
    part = trimmed(part);
  return parts;
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string where(std::size_t row, std::string_view column) {
  return "curves: row " + std::to_string(row) + ", column " + std::string(column) + ": ";
}

/// A Live Link Face timecode, hh:mm:ss:ff.sub.
struct Timecode {
  double seconds = 0;
  double frame = 0;
};

Timecode timecode(std::string_view text, std::size_t row) {
  std::string plain(text);
  std::replace(plain.begin(), plain.end(), ';', ':');  // drop-frame files
  const auto parts = split(plain, ':');
  if (parts.size() != 4)
    throw Error(where(row, "Timecode") + "\"" + plain + "\" is not hours:minutes:seconds:frame");
  double fields[4] = {};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto field = number(parts[i]);
    if (!field || *field < 0)
      throw Error(where(row, "Timecode") + "\"" + plain + "\" is not hours:minutes:seconds:frame");
    fields[i] = *field;
  }
  return {3600 * fields[0] + 60 * fields[1] + fields[2], fields[3]};
}

struct Table {
  std::vector<std::string_view> header;
  std::vector<std::vector<std::string_view>> rows;
  std::vector<std::size_t> lines;  ///< in the file, from 1
};

Table table_of(std::string_view text) {
  Table table;
  std::size_t line = 0;
  for (const std::string_view raw : split(text, '\n')) {
    ++line;
    if (trimmed(raw).empty()) continue;
    if (table.header.empty()) {
      table.header = cells(raw);
    } else {
      table.rows.push_back(cells(raw));
      table.lines.push_back(line);
    }
  }
  return table;
}

std::optional<std::size_t> column(const Table& table, std::string_view name) {
  for (std::size_t i = 0; i < table.header.size(); ++i)
    if (same_name(table.header[i], name)) return i;
  return std::nullopt;
}

std::vector<double> live_link_times(const Table& table, std::size_t time_column) {
  std::vector<Timecode> codes;
  double highest = 0;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (time_column >= table.rows[row].size()) throw Error(where(table.lines[row], "Timecode") + "missing");
    codes.push_back(timecode(table.rows[row][time_column], table.lines[row]));
    highest = std::max(highest, codes.back().frame);
  }
  // Frames count within a second; a phone records 60 of them.
  const double rate = std::max(60.0, std::floor(highest) + 1);
  std::vector<double> times;
  for (const Timecode& code : codes) {
    double time = code.seconds + code.frame / rate - (codes[0].seconds + codes[0].frame / rate);
    if (time < 0) time += 24 * 3600;  // past midnight
    times.push_back(time);
  }
  return times;
}

std::vector<double> plain_times(const Table& table, std::size_t time_column) {
  std::vector<double> times;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto time =
        time_column < table.rows[row].size() ? number(table.rows[row][time_column]) : std::nullopt;
    if (!time) throw Error(where(table.lines[row], "time") + "not a number");
    times.push_back(*time);
  }
  return times;
}

}  // namespace

Curves read_csv_curves(std::string_view text) {
  const Table table = table_of(text);
  const auto time = column(table, "time"), code = column(table, "Timecode");
  const auto count = column(table, "BlendShapeCount");
  if (!time && !code)
    throw Error(
        "curves: neither JSON, glTF nor a CSV file with a `time` (seconds) or `Timecode` column in its first "
        "line");
  if (table.rows.empty()) throw Error("curves: the CSV file has no rows");
  const std::size_t time_column = time ? *time : *code;
  const std::vector<double> times =
      time ? plain_times(table, time_column) : live_link_times(table, time_column);
  for (std::size_t row = 1; row < times.size(); ++row)
    if (!(times[row] > times[row - 1]))
      throw Error(where(table.lines[row], table.header[time_column]) + "times must rise from row to row");

  Curves result;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    if (c == time_column || (count && c == *count) || table.header[c].empty()) continue;
    Curve curve;
    curve.name = table.header[c];
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      if (c >= table.rows[row].size() || table.rows[row][c].empty()) continue;
      const auto value = number(table.rows[row][c]);
      if (!value)
        throw Error(where(table.lines[row], curve.name) + "\"" + std::string(table.rows[row][c]) +
                    "\" is not a number");
      curve.times.push_back(times[row]);
      curve.values.push_back(static_cast<float>(*value));
    }
    if (!curve.times.empty()) result.curves.push_back(std::move(curve));
  }
  if (result.curves.empty()) throw Error("curves: the CSV file has no column of values");
  return result;
}

}  // namespace fascia::runtime
