#include "tools/anatomy/identify/table_file.h"

#include <fstream>

#include "geometry/error.h"

namespace fascia::identify {
namespace {

/// `value` on one line, with a space after each comma.
std::string in_line(const Json& value) {
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, inner] : value.items()) {
    if (!text.empty()) text += ", ";
    if (value.is_object()) text += Json(key).dump() + ": ";
    text += in_line(inner);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

}  // namespace

Json read_table(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error("'" + path.string() + "' cannot be read");
  return Json::parse(file);
}

void write_table(const std::filesystem::path& path, const Json& table) {
  std::ofstream file(path);
  file << "{\n";
  for (const auto& [key, value] : table.items())
    if (key != "expressions") file << "  " << Json(key).dump() << ": " << in_line(value) << ",\n";
  file << "  \"expressions\": [\n";
  const Json& rows = table["expressions"];
  for (size_t r = 0; r < rows.size(); ++r)
    file << "    " << in_line(rows[r]) << (r + 1 < rows.size() ? ",\n" : "\n");
  file << "  ]\n}\n";
}

}  // namespace fascia::identify
