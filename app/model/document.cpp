#include "app/model/document.h"

#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/json.h"

namespace fascia::app {

namespace {

using Json = nlohmann::ordered_json;

const Json* entry(const Json& edits, const char* list, const std::string& name) {
  const auto found = edits.find(list);
  if (found == edits.end() || !found->is_object()) return nullptr;
  const auto item = found->find(name);
  return item == found->end() ? nullptr : &*item;
}

void take_out(Json& edits, const char* list, const std::string& name) {
  const auto found = edits.find(list);
  if (found == edits.end() || !found->is_object()) return;
  found->erase(name);
  if (found->empty()) edits.erase(list);
}

}  // namespace

void set_muscle_entry(DocumentState& state, const std::string& muscle, const char* key, const Json& value) {
  Json& muscles = state.edits["muscles"];
  if (!muscles.is_object()) muscles = Json::object();
  Json& item = muscles[muscle];
  if (!item.is_object()) item = Json::object();
  if (value.is_null())
    item.erase(key);
  else
    item[key] = value;
  if (item.empty()) take_out(state.edits, "muscles", muscle);
}

std::optional<Vec3> landmark_edit(const DocumentState& state, const std::string& name) {
  const Json* item = entry(state.edits, "landmarks", name);
  if (!item || !item->is_array() || item->size() != 3) return std::nullopt;
  for (const Json& number : *item)
    if (!number.is_number()) return std::nullopt;
  return Vec3((*item)[0].get<double>(), (*item)[1].get<double>(), (*item)[2].get<double>());
}

void set_landmark(DocumentState& state, const std::string& name, const Vec3& point) {
  state.edits["landmarks"][name] = {point[0], point[1], point[2]};
}

void clear_landmark(DocumentState& state, const std::string& name) {
  take_out(state.edits, "landmarks", name);
}

std::vector<std::string> edited_landmarks(const DocumentState& state) {
  std::vector<std::string> names;
  const auto found = state.edits.find("landmarks");
  if (found != state.edits.end() && found->is_object())
    for (const auto& [name, point] : found->items())
      names.push_back(name);
  return names;
}

double muscle_number(const DocumentState& state, const std::string& muscle, const char* key,
                     double otherwise) {
  const Json* item = entry(state.edits, "muscles", muscle);
  if (!item || !item->is_object() || !item->contains(key) || !item->at(key).is_number()) return otherwise;
  return item->at(key).get<double>();
}

void set_muscle_number(DocumentState& state, const std::string& muscle, const char* key, double value,
                       double otherwise) {
  set_muscle_entry(state, muscle, key, value == otherwise ? Json() : Json(value));
}

bool muscle_is_present(const DocumentState& state, const std::string& muscle) {
  const Json* item = entry(state.edits, "muscles", muscle);
  return !item || !item->is_object() || item->value("present", Json(true)) != Json(false);
}

void set_muscle_present(DocumentState& state, const std::string& muscle, bool is_present) {
  set_muscle_entry(state, muscle, "present", is_present ? Json() : Json(false));
}

std::string muscle_variant(const DocumentState& state, const std::string& muscle) {
  const Json* item = entry(state.edits, "muscles", muscle);
  if (!item || !item->is_object() || !item->contains("variant") || !item->at("variant").is_string())
    return "";
  return item->at("variant").get<std::string>();
}

void set_muscle_variant(DocumentState& state, const std::string& muscle, const std::string& variant) {
  set_muscle_entry(state, muscle, "variant", variant.empty() ? Json() : Json(variant));
}

void set_pose(DocumentState& state, const std::string& name, double value, double rest) {
  if (value == rest)
    state.pose.erase(name);
  else
    state.pose[name] = value;
}

std::string to_text(const DocumentState& state) {
  Json layers = Json::array();
  for (const TakeLayer& layer : state.take.layers)
    layers.push_back({{"file", layer.file}, {"weight", layer.weight}, {"is_muted", layer.is_muted}});
  const Json json = {{"head", state.head},
                     {"edits", state.edits},
                     {"pose", state.pose},
                     {"take",
                      {{"file", state.take.file},
                       {"begin", state.take.begin},
                       {"end", state.take.end},
                       {"loops", state.take.loops},
                       {"weight", state.take.weight},
                       {"is_muted", state.take.is_muted},
                       {"layers", layers}}}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

DocumentState state_from_text(const std::string& text, const std::string& where) {
  try {
    check_depth(text, "'" + where + "'");
    const Json json = Json::parse(text);
    DocumentState state;
    state.head = json.at("head").get<std::string>();
    state.edits = json.at("edits");
    if (!state.edits.is_object()) throw Error("'" + where + "': \"edits\" is not an object");
    state.pose = json.at("pose").get<std::map<std::string, double>>();
    const Json& take = json.at("take");
    state.take = {take.at("file").get<std::string>(),
                  take.at("begin").get<double>(),
                  take.at("end").get<double>(),
                  take.at("loops").get<bool>(),
                  take.value("weight", 1.0),
                  take.value("is_muted", false),
                  {}};
    for (const Json& layer : take.value("layers", Json::array()))
      state.take.layers.push_back({layer.at("file").get<std::string>(), layer.at("weight").get<double>(),
                                   layer.at("is_muted").get<bool>()});
    return state;
  } catch (const Json::exception& error) {
    throw Error("'" + where + "' is not a saved session: " + error.what());
  }
}

Json read_edits_file(const std::filesystem::path& path) {
  const std::vector<uint8_t> bytes = formats::read_bytes(path);
  Json edits = parse_json<Json>(bytes, "'" + path.string() + "'");
  if (!edits.is_object())
    throw Error("'" + path.string() + "' is not an edits file: it must be a JSON object (docs/muscles.md)");
  return edits;
}

std::string text_of_edits(const Json& edits) {
  return edits.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_edits_file(const std::filesystem::path& path, const Json& edits) {
  formats::write_text(path, text_of_edits(edits));
}

}  // namespace fascia::app
