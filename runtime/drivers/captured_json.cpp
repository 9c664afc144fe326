#include "runtime/drivers/captured_json.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/error.h"
#include "runtime/drivers/aliases.h"
#include "runtime/drivers/text.h"

namespace fascia::runtime {
namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& what) {
  throw Error("curves: " + what);
}

/// The member whose name, in any spelling, is one of `names`; null when there is none.
const Json* member(const Json& object, std::initializer_list<const char*> names) {
  if (!object.is_object()) return nullptr;
  for (const char* name : names)
    for (const auto& [key, value] : object.items())
      if (spelled(key) == spelled(name)) return &value;
  return nullptr;
}

double rate_of(const Json& root, const ReadOptions& options, double otherwise) {
  if (options.frames_per_second > 0.0) return options.frames_per_second;
  const Json* rate = member(root, {"exportFps", "fps", "frameRate", "frames_per_second"});
  if (!rate) return otherwise;
  if (!rate->is_number() || !(rate->get<double>() > 0)) fail("the frame rate is not a number above 0");
  return rate->get<double>();
}

/// Curves as they grow frame by frame, in the order their names appear.
class Growing {
 public:
  void add(const std::string& name, double time, const Json& value, std::size_t frame) {
    if (value.is_null()) return;
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      fail("frame " + std::to_string(frame) + ": the value of " + name + " is not a number");
    const auto [place, is_new] = index_.emplace(name, curves_.size());
    if (is_new) curves_.push_back({name, {}, {}, Interpolation::linear, {}, {}});
    Curve& curve = curves_[place->second];
    if (!curve.times.empty() && !(time > curve.times.back())) {
      if (time < curve.times.back()) fail("frame " + std::to_string(frame) + ": time goes back");
      curve.values.back() = value.get<float>();  // of two at one time the last counts
      return;
    }
    curve.times.push_back(time);
    curve.values.push_back(value.get<float>());
  }
  Curves done() {
    Curves result;
    result.curves = std::move(curves_);
    return result;
  }

 private:
  std::vector<Curve> curves_;
  std::map<std::string, std::size_t> index_;
};

std::vector<std::string> texts(const Json& list, const char* what) {
  std::vector<std::string> names;
  if (!list.is_array()) fail(std::string(what) + " is not a list of names");
  for (const Json& name : list) {
    if (!name.is_string()) fail(std::string(what) + " is not a list of names");
    names.push_back(name.get<std::string>());
  }
  return names;
}

/// Rows of one number a name.
void add_rows(const Json& rows, const std::vector<std::string>& names, double rate, std::size_t first,
              Growing& growing) {
  if (!rows.is_array()) fail("the weights are not a list of frames");
  for (std::size_t f = 0; f < rows.size(); ++f) {
    if (!rows[f].is_array() || rows[f].size() != names.size())
      fail("frame " + std::to_string(first + f) + " has not one number for each of the " +
           std::to_string(names.size()) + " names");
    for (std::size_t i = 0; i < names.size(); ++i)
      growing.add(names[i], static_cast<double>(first + f) / rate, rows[f][i], first + f);
  }
}

Curves read_audio2face(const Json& root, const ReadOptions& options) {
  const double rate = rate_of(root, options, 30.0);
  Growing growing;
  add_rows(root.at("weightMat"), texts(root.at("facsNames"), "facsNames"), rate, 0, growing);
  Curves result = growing.done();
  result.frames_per_second = rate;
  return result;
}

bool is_azure_chunk(const Json& object) {
  const Json* shapes = member(object, {"BlendShapes"});
  return shapes && shapes->is_array() && !shapes->empty() && (*shapes)[0].is_array();
}

Curves read_azure_chunks(const Json& chunks, const ReadOptions& options) {
  const double rate = rate_of(Json::object(), options, 60.0);
  Growing growing;
  std::size_t next = 0;
  for (const Json& chunk : chunks) {
    if (!is_azure_chunk(chunk)) fail("an entry of the list has no BlendShapes");
    const Json* index = member(chunk, {"FrameIndex"});
    const std::size_t first = index && index->is_number_unsigned() ? index->get<std::size_t>() : next;
    const Json& rows = *member(chunk, {"BlendShapes"});
    add_rows(rows, named_order("azure_speech"), rate, first, growing);
    next = first + rows.size();
  }
  Curves result = growing.done();
  result.frames_per_second = rate;
  return result;
}

/// Each viseme rises from the one before and falls to the next.
Curves read_viseme_events(const Json& events) {
  std::vector<std::pair<double, std::string>> list;
  double largest = 0.0;
  for (const Json& event : events) {
    const Json* id = member(event, {"visemeId"});
    const Json* offset = member(event, {"audioOffset", "offset", "time"});
    if (!id || !offset || !id->is_number_integer() || !offset->is_number())
      fail("entry " + std::to_string(list.size()) + " has no audioOffset and visemeId");
    list.emplace_back(offset->get<double>(), "msviseme_" + std::to_string(id->get<int>()));
    largest = std::max(largest, std::abs(list.back().first));
  }
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  // The service counts in ticks of 100 ns; its samples divide them to milliseconds.
  const double unit = largest > 1e6 ? 1e-7 : 1e-3;
  std::map<std::string, std::map<double, float>> keys;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t k = i == 0 ? 0 : i - 1; k < std::min(i + 2, list.size()); ++k) {
      float& value = keys[list[i].second].emplace(list[k].first * unit, 0.0F).first->second;
      if (k == i || list[k].second == list[i].second) value = 1.0F;
    }
  Curves result;
  for (const auto& [name, values] : keys) {
    Curve curve;
    curve.name = name;
    for (const auto& [time, value] : values) {
      curve.times.push_back(time);
      curve.values.push_back(value);
    }
    result.curves.push_back(std::move(curve));
  }
  result.notes.push_back(std::string("viseme times are taken as ") +
                         (unit == 1e-3 ? "milliseconds" : "ticks of 100 ns"));
  return result;
}

constexpr std::initializer_list<const char*> second_names = {"time", "timestamp", "t", "seconds", "timeCode"};
constexpr std::initializer_list<const char*> millisecond_names = {"timestampMs", "time_ms", "ms",
                                                                  "milliseconds"};
constexpr std::initializer_list<const char*> weight_names = {"blendShapes", "faceBlendshapes", "blendshape",
                                                             "weights",     "shapes",          "categories",
                                                             "values",      "coefficients"};

std::optional<double> time_of(const Json& frame, const ReadOptions& options, bool& is_plain) {
  const Json* plain = member(frame, second_names);
  const Json* fine = member(frame, millisecond_names);
  const Json* time = plain ? plain : fine;
  if (!time || !time->is_number()) return std::nullopt;
  is_plain = plain != nullptr;
  const double unit = options.time_unit > 0.0 ? options.time_unit : plain ? 1.0 : 1e-3;
  return time->get<double>() * unit;
}

/// The list or object of weights in a frame, however deep a program packs it.
const Json* weights_of(const Json& frame) {
  const Json* weights = member(frame, weight_names);
  for (int depth = 0; weights && depth < 3; ++depth) {
    if (weights->is_array() && weights->size() == 1 && !member((*weights)[0], {"score", "value", "weight"}))
      weights = &(*weights)[0];  // one face of several
    const Json* inner = member(*weights, {"categories"});
    if (!inner) break;
    weights = inner;
  }
  return weights;
}

void add_frame(const Json& frame, double time, std::size_t number, const std::vector<std::string>& names,
               Growing& growing) {
  const Json* weights = weights_of(frame);
  if (!weights) {
    if (!frame.is_object()) fail("frame " + std::to_string(number) + " is no object");
    for (const auto& [name, value] : frame.items())
      if (value.is_number() && !member(Json{{name, 0}}, second_names) &&
          !member(Json{{name, 0}}, millisecond_names))
        growing.add(name, time, value, number);
    return;
  }
  if (weights->is_object()) {
    for (const auto& [name, value] : weights->items())
      growing.add(name, time, value, number);
    return;
  }
  if (!weights->is_array()) fail("frame " + std::to_string(number) + ": its weights are no list");
  for (std::size_t i = 0; i < weights->size(); ++i) {
    const Json& entry = (*weights)[i];
    const Json* name = member(entry, {"categoryName", "name", "displayName", "shape"});
    const Json* value = member(entry, {"score", "value", "weight"});
    if (name && value && name->is_string())
      growing.add(name->get<std::string>(), time, *value, number);
    else if (entry.is_number() && weights->size() == names.size())
      growing.add(names[i], time, entry, number);
    else
      fail("frame " + std::to_string(number) + ": entry " + std::to_string(i) +
           " has no name and value (categoryName, score)");
  }
}

Curves read_frames(const Json& root, const Json& frames, const ReadOptions& options) {
  std::vector<std::string> names;
  if (const Json* list = member(root, {"names", "blendShapeNames", "facsNames"}))
    names = texts(*list, "names");
  const double rate = rate_of(root, options, 0.0);
  bool is_plain = false;
  std::vector<double> times;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const auto time = options.frames_per_second > 0.0 ? std::nullopt : time_of(frames[f], options, is_plain);
    if (!time && !(rate > 0.0))
      fail("frame " + std::to_string(f) + " has no time, and the file no frame rate (--fps-in)");
    times.push_back(time ? *time : static_cast<double>(f) / rate);
  }
  Curves result;
  const double step =
      times.size() > 1 ? (times.back() - times.front()) / static_cast<double>(times.size() - 1) : 0;
  // Steps no recorder makes in seconds.
  const bool is_fine = is_plain && options.time_unit <= 0.0 && (step >= 4.0 || std::abs(times[0]) > 1e11);
  Growing growing;
  for (std::size_t f = 0; f < frames.size(); ++f)
    add_frame(frames[f], is_fine ? (times[f] - times[0]) * 1e-3 : times[f], f, names, growing);
  result = growing.done();
  if (is_fine) result.notes.push_back("times are taken as milliseconds");
  result.frames_per_second = rate;
  return result;
}

}  // namespace

std::optional<Curves> read_captured_json(const Json& root, const ReadOptions& options) {
  if (root.is_object()) {
    if (root.contains("weightMat") && root.contains("facsNames")) return read_audio2face(root, options);
    if (is_azure_chunk(root)) return read_azure_chunks(Json::array({root}), options);
    const Json* frames = member(root, {"frames", "data", "results"});
    if (frames && frames->is_array() && !frames->empty()) return read_frames(root, *frames, options);
    return std::nullopt;
  }
  if (!root.is_array() || root.empty()) return std::nullopt;
  if (is_azure_chunk(root[0])) return read_azure_chunks(root, options);
  if (member(root[0], {"visemeId"})) return read_viseme_events(root);
  return read_frames(Json::object(), root, options);
}

}  // namespace fascia::runtime
