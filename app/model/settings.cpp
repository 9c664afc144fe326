#include "app/model/settings.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "formats/files.h"
#include "geometry/json.h"

namespace fascia::app {

namespace {

using Json = nlohmann::ordered_json;

/// Takes `key` when it is there and of the right kind.
template <class T>
void take(const Json& json, const char* key, T& value) {
  const auto found = json.find(key);
  if (found == json.end()) return;
  try {
    value = found->get<T>();
  } catch (const Json::exception&) {
    // The value as it is by default stays.
  }
}

std::string text_of(const std::filesystem::path& file) {
  const std::vector<uint8_t> bytes = formats::read_bytes(file);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Layers layers_of(const std::string& names) {
  Layers layers;
  layers.skin = false;
  std::istringstream words(names);
  for (std::string word; std::getline(words, word, ',');) {
    for (const auto& [name, layer] : {std::pair("skin", &layers.skin),
                                      {"fat", &layers.fat},
                                      {"smas", &layers.smas},
                                      {"muscles", &layers.muscles},
                                      {"ligaments", &layers.ligaments},
                                      {"skull", &layers.skull},
                                      {"lattice", &layers.lattice},
                                      {"landmarks", &layers.landmarks},
                                      {"strain", &layers.strain}})
      if (word == name) *layer = true;
  }
  if (layers.skin && layers.has_depth()) layers.skin_opacity = 0.35;
  return layers;
}

std::string names_of(const Layers& layers) {
  std::string names;
  for (const auto& [is_on, name] : {std::pair(layers.skin, "skin,eyes"),
                                    {layers.skull, "skull"},
                                    {layers.fat, "fat"},
                                    {layers.smas, "smas"},
                                    {layers.muscles, "muscles"},
                                    {layers.ligaments, "ligaments"},
                                    {layers.lattice, "lattice"},
                                    {layers.landmarks, "landmarks"},
                                    {layers.strain, "strain"}})
    if (is_on) names += (names.empty() ? "" : ",") + std::string(name);
  return names.empty() ? "eyes" : names;
}

void Settings::remember(const std::string& file) {
  recent.erase(std::remove(recent.begin(), recent.end(), file), recent.end());
  recent.insert(recent.begin(), file);
  const size_t most = 8;
  if (recent.size() > most) recent.resize(most);
}

std::filesystem::path state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state && *state == '/') return std::filesystem::path(state) / "fascia";
  const char* home = std::getenv("HOME");
  if (home && *home == '/') return std::filesystem::path(home) / ".local/state/fascia";
  std::error_code status;
  return std::filesystem::temp_directory_path(status) / "fascia-state";
}

Settings read_settings(const std::filesystem::path& file) {
  Settings settings;
  try {
    const Json json = parse_json<Json>(formats::read_bytes(file), file.string());
    if (!json.is_object()) return settings;
    take(json, "width", settings.width);
    take(json, "height", settings.height);
    take(json, "scale", settings.scale);
    take(json, "light", settings.is_light);
    take(json, "panel_width", settings.panel_width);
    take(json, "panel", settings.panel);
    take(json, "symmetric", settings.is_symmetric);
    std::string layers = names_of(settings.layers);
    take(json, "layers", layers);
    settings.layers = layers_of(layers);
    take(json, "textures", settings.layers.has_textures);
    take(json, "skin_opacity", settings.layers.skin_opacity);
    take(json, "recent", settings.recent);
    take(json, "favourites", settings.favourites);
    take(json, "export_folder", settings.export_folder);
  } catch (const std::exception&) {
    return settings;
  }
  settings.width = std::clamp(settings.width, 640, 8192);
  settings.height = std::clamp(settings.height, 480, 8192);
  settings.scale = std::clamp(settings.scale, 0.0, 4.0);
  settings.panel_width = std::clamp(settings.panel_width, 280.0, 720.0);
  settings.layers.skin_opacity = std::clamp(settings.layers.skin_opacity, 0.05, 1.0);
  return settings;
}

void write_settings(const std::filesystem::path& file, const Settings& settings) {
  const Json json = {{"width", settings.width},
                     {"height", settings.height},
                     {"scale", settings.scale},
                     {"light", settings.is_light},
                     {"panel_width", settings.panel_width},
                     {"panel", settings.panel},
                     {"symmetric", settings.is_symmetric},
                     {"layers", names_of(settings.layers)},
                     {"textures", settings.layers.has_textures},
                     {"skin_opacity", settings.layers.skin_opacity},
                     {"recent", settings.recent},
                     {"favourites", settings.favourites},
                     {"export_folder", settings.export_folder}};
  try {
    std::filesystem::create_directories(file.parent_path());
    formats::write_text(file, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  } catch (const std::exception&) {
    // Nothing is lost but comfort.
  }
}

std::optional<DocumentState> Autosave::left_behind() const {
  std::error_code status;
  if (!std::filesystem::is_regular_file(file_, status)) return std::nullopt;
  try {
    return state_from_text(text_of(file_), file_.string());
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void Autosave::keep(const DocumentState& state) {
  if (kept_ && *kept_ == state) return;
  try {
    std::filesystem::create_directories(file_.parent_path());
    formats::write_text(file_, to_text(state));
    kept_ = state;
  } catch (const std::exception&) {
    // A full disk must not end the session that it was to save.
  }
}

}  // namespace fascia::app
