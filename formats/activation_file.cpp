#include "formats/activation_file.h"

#include <nlohmann/json.hpp>

#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/json.h"

namespace fascia::formats {

std::vector<std::pair<std::string, double>> read_activations(const std::filesystem::path& file) {
  const std::string name = "'" + file.string() + "'";
  const auto content = parse_json<nlohmann::json>(read_bytes(file), name);
  if (!content.is_object() || !content.contains("activations") || !content["activations"].is_object())
    throw Error(name + " is not an activations file: {\"activations\": {NAME: VALUE, ...}}");
  std::vector<std::pair<std::string, double>> values;
  for (const auto& [channel, value] : content["activations"].items()) {
    if (!value.is_number()) throw Error(name + ": the activation '" + channel + "' is not a number");
    values.emplace_back(channel, value.get<double>());
  }
  return values;
}

}  // namespace fascia::formats
