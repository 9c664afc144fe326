#include "snapshot/file.h"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "snapshot/packing.h"

namespace fascia::snapshot {

namespace {

using Json = nlohmann::ordered_json;
constexpr int version = 1;
constexpr double least_said_mm = 0.1;  // in the lines for people

/// On one line; names need not be UTF-8, JSON has to be.
std::string line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

double rounded(double mm) {
  const double value = std::round(1e2 * mm) / 1e2;
  return value == 0.0 ? 0.0 : value;  // no -0
}

/// Mean of a region's numbers along x, y, z and the largest length, millimetres.
std::array<double, 4> summary(const Snapshot& snapshot, const State& state, size_t region) {
  std::array<double, 4> sum = {};
  const size_t first = snapshot.first_vertex(region), count = snapshot.regions[region].vertices.size();
  for (size_t v = first; v < first + count; ++v) {
    double squared = 0.0;
    for (size_t k = 0; k < 3; ++k) {
      const double mm = snapshot.quantum_mm * state.quanta[3 * v + k];
      sum[k] += mm / double(count);
      squared += mm * mm;
    }
    sum[3] = std::max(sum[3], std::sqrt(squared));
  }
  for (double& value : sum)
    value = rounded(value);
  return sum;
}

std::string meshes_text(const Snapshot& snapshot) {
  Json meshes = Json::array();
  for (const Mesh& mesh : snapshot.meshes)
    meshes.push_back({mesh.mesh, mesh.primitive, mesh.vertex_count});
  return line(meshes);
}

std::string regions_text(const Snapshot& snapshot) {
  std::string text;
  for (const Region& region : snapshot.regions) {
    std::vector<int32_t> numbers;
    for (const Vertex& vertex : region.vertices) {
      numbers.push_back(static_cast<int32_t>(vertex.mesh));
      numbers.push_back(static_cast<int32_t>(vertex.vertex));
    }
    text += (text.empty() ? "\n  " : ",\n  ") + line({{"name", region.name},
                                                      {"tolerance_mm", region.tolerance_mm},
                                                      {"count", region.vertices.size()},
                                                      {"vertices", pack(numbers, 2)}});
  }
  return text;
}

std::string poses_text(const Snapshot& snapshot) {
  std::string text;
  for (const Pose& pose : snapshot.poses) {
    Json values = Json::array();
    for (const auto& [name, value] : pose.values)
      values.push_back({name, value});
    text += (text.empty() ? "\n  " : ",\n  ") + line({{"name", pose.name}, {"set", values}});
  }
  return text;
}

std::string takes_text(const Snapshot& snapshot) {
  std::string text;
  for (const Take& take : snapshot.takes)
    text += (text.empty() ? "\n  " : ",\n  ") + line({{"name", take.name},
                                                      {"curves", take.path},
                                                      {"hash", take.hash},
                                                      {"fps", take.frames_per_second},
                                                      {"frames", take.frames}});
  return text;
}

std::string states_text(const Snapshot& snapshot) {
  std::string text;
  for (size_t s = 0; s < snapshot.states.size(); ++s) {
    const State& state = snapshot.states[s];
    std::string moves;
    for (size_t r = 0; r < snapshot.regions.size(); ++r) {
      const std::array<double, 4> mm = summary(snapshot, state, r);
      if (s > 0 && mm[3] < least_said_mm) continue;
      moves += (moves.empty() ? "\n    " : ",\n    ") + line(snapshot.regions[r].name) + ": " + line(mm);
    }
    text += (s > 0 ? ",\n  " : "\n  ");
    text += "{\"name\": " + line(state.name) + ", \"mean_and_largest_mm\": {" + moves +
            "},\n   \"packed\": \"" + pack(state.quanta, 3) + "\"}";
  }
  return text;
}

/// A whole number of 32 bits; a larger one, or a fraction, is an error.
uint32_t whole(const Json& json) {
  if (json.is_number_unsigned() && json.get<uint64_t>() <= std::numeric_limits<uint32_t>::max())
    return json.get<uint32_t>();
  throw Error(json.dump().substr(0, 40) + " stands where a whole number from 0 to 4294967295 should");
}

std::vector<uint32_t> whole_numbers(const Json& json) {
  std::vector<uint32_t> list;
  for (const Json& number : json)
    list.push_back(whole(number));
  return list;
}

/// `before`: the vertices of the regions before it.
Region region_from(const Json& json, const std::vector<Mesh>& meshes, size_t before) {
  Region region;
  region.name = json.at("name").get<std::string>();
  region.tolerance_mm = json.at("tolerance_mm").get<double>();
  if (!(region.tolerance_mm > 0.0))
    throw Error("region '" + region.name + "': tolerance_mm has to be above 0");
  const size_t count = whole(json.at("count"));
  size_t most = 0;
  for (const Mesh& mesh : meshes)
    most += mesh.vertex_count;
  if (count > most) throw Error("region '" + region.name + "' watches more vertices than the meshes have");
  check_size(before + count, 1);
  const std::vector<int32_t> numbers = unpack(json.at("vertices").get<std::string>(), 2, 2 * count);
  for (size_t i = 0; i < count; ++i) {
    const Vertex vertex{static_cast<uint32_t>(numbers[2 * i]), static_cast<uint32_t>(numbers[2 * i + 1])};
    if (vertex.mesh >= meshes.size() || vertex.vertex >= meshes[vertex.mesh].vertex_count)
      throw Error("region '" + region.name + "' watches vertices that no mesh has");
    region.vertices.push_back(vertex);
  }
  return region;
}

Take take_from(const Json& json) {
  Take take;
  take.name = json.at("name").get<std::string>();
  take.path = json.at("curves").get<std::string>();
  take.hash = json.at("hash").get<std::string>();
  take.frames_per_second = json.at("fps").get<double>();
  take.frames = json.at("frames").get<std::vector<uint32_t>>();
  if (!(take.frames_per_second >= 1.0 && take.frames_per_second <= 1000.0))
    throw Error("take '" + take.name + "': fps has to lie between 1 and 1000");
  for (size_t i = 0; i < take.frames.size(); ++i)
    if (take.frames[i] > 1000000 || (i > 0 && take.frames[i] <= take.frames[i - 1]))
      throw Error("take '" + take.name + "': its frames have to rise, up to a million");
  return take;
}

Snapshot parsed(const Json& json) {
  if (!json.is_object() || !json.contains("fascia_snapshot"))
    throw Error("it is not a snapshot: 'fascia snapshot record' writes them");
  if (json["fascia_snapshot"] != version)
    throw Error("it is a snapshot of version " + line(json["fascia_snapshot"]) + ", this tool knows " +
                std::to_string(version) + ": record it anew");
  Snapshot snapshot;
  snapshot.rig = json.at("rig").get<std::string>();
  snapshot.level = json.at("level").get<std::string>();
  snapshot.quantum_mm = json.at("quantum_mm").get<double>();
  if (!(snapshot.quantum_mm > 1e-6 && snapshot.quantum_mm < 10.0))
    throw Error("quantum_mm has to lie between 0.000001 and 10");
  snapshot.reasons = json.at("reasons").get<std::vector<std::string>>();
  for (const Json& mesh : json.at("meshes"))
    snapshot.meshes.push_back({whole(mesh.at(0)), whole(mesh.at(1)), whole(mesh.at(2))});
  size_t vertices = 0;
  for (const Json& region : json.at("regions")) {
    snapshot.regions.push_back(region_from(region, snapshot.meshes, vertices));
    vertices += snapshot.regions.back().vertices.size();
  }
  for (const Json& pose : json.at("poses")) {
    snapshot.poses.push_back({pose.at("name").get<std::string>(), {}});
    for (const Json& value : pose.at("set"))
      snapshot.poses.back().values.emplace_back(value.at(0).get<std::string>(), value.at(1).get<double>());
  }
  for (const Json& take : json.at("takes"))
    snapshot.takes.push_back(take_from(take));
  const std::vector<std::string> names = state_names(snapshot);
  const Json& states = json.at("states");
  if (states.size() != names.size())
    throw Error("it has " + std::to_string(states.size()) + " states for " + std::to_string(names.size()) +
                " poses and frames: record it anew");
  check_size(vertices, names.size());
  for (size_t s = 0; s < names.size(); ++s)
    snapshot.states.push_back({names[s], unpack(states[s].at("packed").get<std::string>(), 3, 3 * vertices)});
  return snapshot;
}

double finite(const Json& json, const std::string& what) {
  if (!json.is_number() || !std::isfinite(json.get<double>())) throw Error(what + " is not a number");
  return json.get<double>();
}

Values values_of(const Json& json, const std::string& what) {
  if (!json.is_object()) throw Error(what + " is not {CHANNEL: VALUE, ...}");
  Values values;
  for (const auto& [channel, value] : json.items())
    values.emplace_back(channel, finite(value, what + ": the value of '" + channel + "'"));
  return values;
}

WantedRegion wanted_region(const std::string& name, const Json& json) {
  if (!json.is_object() || json.contains("landmarks") == json.contains("vertices"))
    throw Error("region '" + name + "' needs either landmarks or vertices");
  WantedRegion region;
  region.name = name;
  if (json.contains("landmarks"))
    region.landmarks = json["landmarks"].get<std::vector<std::string>>();
  else
    region.vertices = whole_numbers(json["vertices"]);
  if (json.contains("mesh")) region.mesh = whole(json["mesh"]);
  if (json.contains("primitive")) region.primitive = whole(json["primitive"]);
  for (const auto& [key, number] :
       {std::pair{"radius_mm", &region.radius_mm}, std::pair{"tolerance_mm", &region.tolerance_mm}}) {
    if (!json.contains(key)) continue;
    *number = finite(json[key], "region '" + name + "': " + key);
    if (*number <= 0.0) throw Error("region '" + name + "': " + key + " has to be above 0");
  }
  if (region.landmarks.empty() && region.vertices.empty()) throw Error("region '" + name + "' is empty");
  return region;
}

/// JSON nested deeper than anything of ours would end the parser's recursion on the stack.
Json parse(std::string_view text) {
  constexpr int deepest = 16;
  const auto shallow = [](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) throw Error("it is nested more than " + std::to_string(deepest) + " deep");
    return true;
  };
  Json json = Json::parse(text.begin(), text.end(), shallow, false);
  if (json.is_discarded()) throw Error("it is not JSON");
  return json;
}

}  // namespace

std::string to_text(const Snapshot& snapshot) {
  std::string text = "{\"fascia_snapshot\": " + std::to_string(version) + ",\n";
  text += " \"rig\": " + line(snapshot.rig) + ",\n \"level\": " + line(snapshot.level) + ",\n";
  text += " \"quantum_mm\": " + line(snapshot.quantum_mm) + ",\n \"reasons\": [";
  for (size_t i = 0; i < snapshot.reasons.size(); ++i)
    text += (i > 0 ? ",\n  " : "\n  ") + line(snapshot.reasons[i]);
  text += "],\n \"meshes\": " + meshes_text(snapshot) + ",\n \"regions\": [" + regions_text(snapshot) +
          "],\n \"poses\": [" + poses_text(snapshot) + "],\n";
  text += " \"takes\": [" + takes_text(snapshot) + "],\n \"states\": [" + states_text(snapshot) + "]\n}\n";
  return text;
}

Snapshot from_text(std::string_view text, const std::string& name) {
  try {
    return parsed(parse(text));
  } catch (const Json::exception& error) {
    throw Error(name + ": something of a snapshot is missing or of another kind (" + error.what() +
                "); record it anew");
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

void read_poses(std::string_view text, const std::string& name, Request& request) {
  try {
    const Json json = parse(text);
    if (!json.is_object()) throw Error("it is not {\"poses\": {NAME: {CHANNEL: VALUE}}}");
    if (json.contains("activations"))
      request.poses.push_back({"activations", values_of(json["activations"], "activations")});
    if (json.contains("poses")) {
      if (!json["poses"].is_object()) throw Error("poses is not {NAME: {CHANNEL: VALUE}}");
      for (const auto& [pose, values] : json["poses"].items())
        request.poses.push_back({pose, values_of(values, "pose '" + pose + "'")});
    }
    if (json.contains("regions")) {
      if (!json["regions"].is_object()) throw Error("regions is not {NAME: {...}}");
      for (const auto& [region, entry] : json["regions"].items())
        request.regions.push_back(wanted_region(region, entry));
    }
    if (request.poses.empty() && request.regions.empty())
      throw Error("it has neither poses nor regions: {\"poses\": {NAME: {CHANNEL: VALUE}}}");
  } catch (const Json::exception& error) {
    throw Error(name + ": " + error.what());
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

}  // namespace fascia::snapshot
