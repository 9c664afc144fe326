#include "runtime/drivers/table.h"

#include <algorithm>

#include "geometry/error.h"
#include "runtime/drivers/text.h"

namespace fascia::runtime {
namespace {

/// The cells of a line; false when a quote does not end.
bool split_cells(std::string_view line, char separator, std::vector<std::string>& cells) {
  cells.clear();
  std::string cell;
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (is_quoted) {
      if (c != '"')
        cell += c;
      else if (i + 1 < line.size() && line[i + 1] == '"')
        cell += line[++i];
      else
        is_quoted = false;
    } else if (c == '"' && trimmed(cell).empty()) {
      cell.clear();
      is_quoted = true;
    } else if (c == separator) {
      cells.emplace_back(trimmed(cell));
      cell.clear();
    } else {
      cell += c;
    }
  }
  cells.emplace_back(trimmed(cell));
  return !is_quoted;
}

char separator_of(std::string_view header) {
  char best = ',';
  std::size_t most = 1;
  std::vector<std::string> cells;
  for (const char candidate : {',', ';', '\t', '|'}) {
    split_cells(header, candidate, cells);
    if (cells.size() > most) {
      most = cells.size();
      best = candidate;
    }
  }
  return best;
}

std::string at_line(std::size_t line) {
  return "curves: row " + std::to_string(line) + ": ";
}

}  // namespace

Table read_table(std::string_view text) {
  Table table;
  std::size_t line = 0;
  std::vector<std::string> cells;
  for (const std::string_view raw : lines_of(text)) {
    ++line;
    const std::string_view content = trimmed(raw);
    if (content.empty()) continue;
    if (table.header.empty()) {
      if (content.front() == '#' || lower_ascii(content.substr(0, 4)) == "sep=") continue;
      table.separator = separator_of(raw);
    }
    if (!split_cells(raw, table.separator, cells)) throw Error(at_line(line) + "a quote does not end");
    if (table.header.empty()) {
      table.header = cells;
      continue;
    }
    if (std::all_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty(); }))
      continue;
    while (cells.size() > table.header.size() && cells.back().empty())
      cells.pop_back();
    if (cells.size() > table.header.size())
      throw Error(at_line(line) + std::to_string(cells.size()) + " cells under a header of " +
                  std::to_string(table.header.size()) +
                  "; decimal commas need another separator (; or a tab), or quotes");
    if (cells.size() < table.header.size()) table.short_lines.push_back(line);
    cells.resize(table.header.size());
    table.rows.push_back(cells);
    table.lines.push_back(line);
  }
  return table;
}

}  // namespace fascia::runtime
