#include "formats/obj_lines.h"

#include <cstdio>
#include <string>

namespace fascia::formats {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Bytes of the line end at `at`: LF, CR, or CR LF; 0 when there is none.
size_t line_end(std::string_view text, size_t at) {
  if (at >= text.size()) return 0;
  if (text[at] == '\n') return 1;
  if (text[at] != '\r') return 0;
  return at + 1 < text.size() && text[at + 1] == '\n' ? 2 : 1;
}

/// Bytes of a blank at `at`: a space, a tab, or a backslash with the line end it folds; 0 when there is none.
size_t blank(std::string_view text, size_t at, size_t& line) {
  if (at >= text.size()) return 0;
  if (text[at] == ' ' || text[at] == '\t') return 1;
  if (text[at] != '\\') return 0;
  const size_t end = line_end(text, at + 1);
  if (end == 0) return 0;
  ++line;
  return 1 + end;
}

size_t skip_blanks(std::string_view text, size_t at, size_t& line) {
  for (size_t step = blank(text, at, line); step > 0; step = blank(text, at, line))
    at += step;
  return at;
}

/// End of the word that begins at `at`.
size_t word_end(std::string_view text, size_t at) {
  for (size_t line = 0; at < text.size(); ++at)
    if (line_end(text, at) > 0 || blank(text, at, line) > 0) break;
  return at;
}

/// The beginning of the next line.
size_t next_line(std::string_view text, size_t at, size_t& line) {
  while (at < text.size()) {
    if (const size_t fold = blank(text, at, line); fold > 0) {
      at += fold;
      continue;
    }
    if (const size_t end = line_end(text, at); end > 0) {
      ++line;
      return at + end;
    }
    ++at;
  }
  return at;
}

}  // namespace

std::vector<ObjVertex> obj_vertices(std::string_view text) {
  std::vector<ObjVertex> vertices;
  size_t line = 1;
  for (size_t at = text.substr(0, 3) == byte_order_mark ? 3 : 0; at < text.size();
       at = next_line(text, at, line)) {
    const size_t first_line = line;
    at = skip_blanks(text, at, line);
    const size_t keyword = word_end(text, at);
    if (text.substr(at, keyword - at) != "v") continue;
    ObjVertex vertex;
    vertex.line = first_line;
    at = keyword;
    for (auto& [begin, end] : vertex.coordinates) {
      begin = skip_blanks(text, at, line);
      at = end = word_end(text, begin);
    }
    vertices.push_back(vertex);
  }
  return vertices;
}

std::string plain_obj(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  size_t line = 0;
  for (size_t at = text.substr(0, 3) == byte_order_mark ? 3 : 0; at < text.size();) {
    if (const size_t end = line_end(text, at); end > 0) {
      plain.push_back('\n');
      at += end;
    } else if (text[at] == '\\' && blank(text, at, line) > 0) {
      plain.push_back(' ');
      at += blank(text, at, line);
    } else {
      plain.push_back(text[at++]);
    }
  }
  return plain;
}

std::string with_vertices(std::string_view before, const std::map<int, Vec3>& moved, int decimals) {
  const std::vector<ObjVertex> vertices = obj_vertices(before);
  std::string text;
  size_t copied = 0;
  for (const auto& [vertex, place] : moved)
    for (int k = 0; k < 3; ++k) {
      const auto [begin, end] = vertices.at(static_cast<size_t>(vertex)).coordinates[static_cast<size_t>(k)];
      char digits[64];
      std::snprintf(digits, sizeof digits, "%.*f", decimals, place[k]);
      text += before.substr(copied, begin - copied);
      text += digits;
      copied = end;
    }
  return text.append(before.substr(copied));
}

}  // namespace fascia::formats
