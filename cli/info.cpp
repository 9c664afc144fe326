#include <memory>
#include <nlohmann/json.hpp>

#include "anatomy/anatomy.h"
#include "cli/common.h"
#include "cli/posing.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "sim/realtime/model.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

struct InfoRequest {
  std::filesystem::path rig;
  bool channels = false, validate = false, names = false;
};

Json contents(const rig::RigFile& file) {
  const rig::Rig& rig = file.rig;
  Json json;
  json["source"] = file.source.format.empty() ? "glb" : file.source.format;
  json["meshes"] = Json::array();
  for (const rig::Primitive& primitive : file.primitives)
    json["meshes"].push_back({{"name", primitive.name},
                              {"vertices", primitive.positions.size()},
                              {"triangles", primitive.triangles.size()}});
  json["skull"] = {{"cranium_triangles", rig.skull.cranium.triangles.size()},
                   {"mandible_triangles", rig.skull.mandible.triangles.size()},
                   {"landmarks", rig.skull.landmarks.size()}};
  json["smas"] = {{"vertices", rig.smas.surface.positions.size()},
                  {"triangles", rig.smas.surface.triangles.size()}};
  size_t fibres = 0;
  for (const rig::Muscle& muscle : rig.muscles)
    fibres += muscle.fibre_offsets.empty() ? 0 : muscle.fibre_offsets.size() - 1;
  json["muscles"] = {{"count", rig.muscles.size()}, {"fibres", fibres}};
  json["tissue"] = Json::object();
  for (const rig::TissueLevel& level : rig.tissue.levels)
    json["tissue"][level.name] = {{"nodes", level.rest.size()}, {"springs", level.spring_nodes.size()}};
  json["channels"] = rig.actuation.channels.size();
  json["sets"] = Json::object();
  for (const rig::NamedSet& set : rig.actuation.sets)
    json["sets"][set.name] = set.members.size();
  return json;
}

Json channel_list(const rig::Rig& rig) {
  Json list = Json::array();
  for (const rig::Channel& channel : rig.actuation.channels)
    list.push_back({{"name", channel.name},
                    {"group", channel.group},
                    {"minimum", channel.minimum},
                    {"maximum", channel.maximum},
                    {"rest", channel.rest},
                    {"unit", channel.unit}});
  return list;
}

void say(const Common& common, const Json& json, const rig::Rig& rig, const InfoRequest& request) {
  if (request.channels) {
    for (const rig::Channel& channel : rig.actuation.channels) {
      char line[160];
      std::snprintf(line, sizeof line, "%-46s %-9s %7.3f .. %6.3f  rest %.3f %s", channel.name.c_str(),
                    channel.group.c_str(), static_cast<double>(channel.minimum),
                    static_cast<double>(channel.maximum), static_cast<double>(channel.rest),
                    channel.unit.c_str());
      common.say(line);
    }
    for (const rig::NamedSet& set : rig.actuation.sets) {
      std::string members;
      for (const std::string& member : set.members)
        members += " " + member;
      common.say(set.name + ":" + members);
    }
    return;
  }
  for (const auto& [key, value] : json.items())
    common.say(key + ": " + value.dump());
}

/// Throws when some level of the tissue cannot be simulated.
void check_tissue(const rig::Rig& rig, const std::string& name) {
  for (size_t level = 0; level < rig.tissue.levels.size(); ++level) {
    const std::string fault =
        sim::realtime::model_fault(sim::lattice_of(rig.tissue.levels[level]), sim::jaw_of(rig.skull.jaw));
    if (!fault.empty())
      throw Error("'" + name + "': FASCIA_tissue/levels/" + std::to_string(level) + ": " + fault);
  }
}

/// Throws what a host would hear when it loads the rig.
void check_load(const std::vector<uint8_t>& bytes, const std::string& name) {
  fascia_asset* asset = nullptr;
  check(fascia_asset_load(bytes.data(), bytes.size(), &asset), "'" + name + "'");
  fascia_asset_release(asset);
}

/// The table of other programs' names, which needs no rig.
void list_names(const Common& common) {
  const Json table = Json::parse(anatomy::embedded_file("aliases.json"));
  for (const Json& vocabulary : table["vocabularies"]) {
    common.say(vocabulary["name"].get<std::string>() + ": " + vocabulary["title"].get<std::string>());
    for (const auto& [name, targets] : vocabulary["names"].items()) {
      std::string meaning;
      for (const auto& [target, share] : targets.items()) {
        char factor[32] = "";
        if (share.get<double>() != 1.0) std::snprintf(factor, sizeof factor, "%g ", share.get<double>());
        meaning += (meaning.empty() ? "" : " + ") + std::string(factor) + target;
      }
      common.say("  " + name + std::string(name.size() < 22 ? 22 - name.size() : 1, ' ') +
                 (meaning.empty() ? "(nothing of the face)" : meaning));
    }
  }
  common.say(
      "Every rig's own names, ARKit's, action units, visemes and VRM's are known in any spelling: "
      "mouthSmile_L, MouthSmileLeft, blendShapes.mouthSmileLeft, viseme_PP, AU12.");
  common.report(table);
}

void run(const Common& common, const InfoRequest& request) {
  if (request.names) return list_names(common);
  if (request.rig.empty()) throw UsageError("RIG is required; 'fascia info --help' explains");
  // Reading checks every index, accessor and fingerprint; what is unsound does not come through.
  const std::vector<uint8_t> bytes = formats::read_bytes(request.rig);
  const rig::RigFile file = rig::read(bytes, request.rig.string());
  Json json = contents(file);
  if (request.channels) json["channel_list"] = channel_list(file.rig);
  if (request.validate) {
    check_tissue(file.rig, request.rig.string());
    check_load(bytes, request.rig.string());
    json["valid"] = true;
  }
  say(common, json, file.rig, request);
  if (request.validate) common.say("'" + request.rig.string() + "' is sound");
  common.report(json);
}

}  // namespace

void add_info(const Command& tool, Common& common) {
  auto request = std::make_shared<InfoRequest>();
  const Command command = tool.command("info", "Describe a rig, and validate it");
  command.positional("RIG", &request->rig, "Rig (.glb)").default_text("none, allowed only with --names");
  command.flag("--names", request->names, "List the accepted names of other programs; needs no rig");
  command.flag("--channels", request->channels, "List every channel and vocabulary");
  command.flag("--validate", request->validate, "Validate the rig");
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
