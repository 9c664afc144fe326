#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fascia::runtime {

/// A table of text cells, trimmed and without their quotes.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< as long as the header at least
  std::vector<std::size_t> lines;              ///< of each row, in the file, from 1
  char separator = ',';
  std::vector<std::size_t> short_lines;  ///< lines with fewer cells than the header, filled with empty ones
};

/// Reads a table whose first line (after blank lines, lines that begin with # and Excel's `sep=`) names its
/// columns. Cells are parted by whichever of comma, semicolon, tab and | parts the header into most, may be
/// quoted as in RFC 4180, and with another separator than the comma may have decimal commas. Throws
/// fascia::Error, with the line, for a row of more cells than the header, or a quote that does not end.
Table read_table(std::string_view text);

}  // namespace fascia::runtime
