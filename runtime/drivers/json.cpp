#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/json.h"
#include "runtime/drivers/captured_json.h"
#include "runtime/drivers/curves.h"

namespace fascia::runtime {
namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw Error("curves: channel " + name + ": " + what);
}

std::vector<double> numbers(const Json& object, const std::string& name, const char* what) {
  if (!object.is_array()) fail(name, std::string(what) + " is not an array of numbers");
  std::vector<double> values;
  for (const Json& value : object) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      fail(name, std::string(what) + " entry " + std::to_string(values.size()) + " is not a number");
    values.push_back(value.get<double>());
  }
  if (values.empty()) fail(name, std::string(what) + " is empty");
  return values;
}

Curve sampled_curve(const std::string& name, const Json& values, double fps) {
  Curve curve;
  curve.name = name;
  for (const double value : numbers(values, name, "its list")) {
    curve.times.push_back(static_cast<double>(curve.times.size()) / fps);
    curve.values.push_back(static_cast<float>(value));
  }
  return curve;
}

Interpolation interpolation_of(const std::string& name, const Json& object) {
  const Json word = object.value("interpolation", Json("linear"));
  if (word == "linear") return Interpolation::linear;
  if (word == "step") return Interpolation::step;
  if (word == "cubic") return Interpolation::cubic;
  fail(name, "interpolation is not linear, step or cubic");
}

Curve keyed_curve(const std::string& name, const Json& object) {
  if (!object.is_object() || !object.contains("times") || !object.contains("values"))
    fail(name, "not an object with \"times\" and \"values\"");
  Curve curve;
  curve.name = name;
  curve.times = numbers(object["times"], name, "times");
  for (const double value : numbers(object["values"], name, "values"))
    curve.values.push_back(static_cast<float>(value));
  if (curve.times.size() != curve.values.size())
    fail(name, std::to_string(curve.times.size()) + " times but " + std::to_string(curve.values.size()) +
                   " values");
  for (std::size_t i = 1; i < curve.times.size(); ++i)
    if (!(curve.times[i] > curve.times[i - 1]))
      fail(name, "times must rise; entry " + std::to_string(i) + " does not");
  curve.interpolation = interpolation_of(name, object);
  return curve;
}

}  // namespace

Curves read_json_curves(std::string_view text, const ReadOptions& options) {
  Json root;
  try {
    check_depth(text, "curves");
    root = Json::parse(text);
  } catch (const Json::exception& error) {
    throw Error(std::string("curves: malformed JSON: ") + error.what());
  }
  if (root.is_object() && root.contains("asset"))
    throw Error("curves: a .gltf file keeps its numbers beside itself: save it as .glb");
  if (auto captured = read_captured_json(root, options)) return *captured;
  if (!root.is_object()) throw Error("curves: the JSON holds no frames and no channels");
  Curves result;
  if (root.contains("channels")) {
    const Json fps =
        options.frames_per_second > 0.0 ? Json(options.frames_per_second) : root.value("fps", Json());
    if (!fps.is_number() || !(fps.get<double>() > 0))
      throw Error("curves: \"fps\" is missing or not above 0");
    if (!root["channels"].is_object()) throw Error("curves: \"channels\" is not an object");
    result.frames_per_second = fps.get<double>();
    for (const auto& [name, values] : root["channels"].items())
      result.curves.push_back(sampled_curve(name, values, fps.get<double>()));
  } else {
    for (const auto& [name, object] : root.items())
      result.curves.push_back(keyed_curve(name, object));
  }
  if (result.curves.empty()) throw Error("curves: the JSON file names no channel");
  return result;
}

}  // namespace fascia::runtime
