#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "gltf/read/container.h"
#include "rig/model/extensions.h"
#include "sim/face_model.h"
#include "tests/rig/tiny_rig.h"

namespace fascia {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

std::string file_text(const std::filesystem::path& path) {
  std::ifstream stream(path);
  EXPECT_TRUE(stream) << path;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::filesystem::path folder(const std::string& extension) {
  return std::filesystem::path(FASCIA_RIG_SPEC) / extension;
}

/// A schema by its file name. The two of the glTF core that ours build on are given here in short: an
/// object, and an index.
const Json* schema_file(const std::string& uri) {
  static std::map<std::string, Json> known = {
      {"glTFProperty.schema.json", Json::parse(R"({"type":"object"})")},
      {"glTFid.schema.json", Json::parse(R"({"type":"integer","minimum":0})")}};
  const std::string name = std::filesystem::path(uri).filename();
  const auto found = known.find(name);
  if (found != known.end()) return &found->second;
  for (const std::string& extension : rig::extensions) {
    const auto path = folder(extension) / "schema" / name;
    if (std::filesystem::exists(path)) return &(known[name] = Json::parse(file_text(path)));
  }
  ADD_FAILURE() << "no schema " << uri;
  return nullptr;
}

const Json& root_schema(const std::string& extension) {
  return *schema_file("glTF." + extension + ".schema.json");
}

/// What the schema of `extension` finds wrong with `object`, or nothing.
std::string faults(const std::string& extension, const Json& object) {
  valijson::Schema schema;
  valijson::SchemaParser parser;
  const Adapter adapter(root_schema(extension));
  parser.populateSchema(adapter, schema, schema_file, [](const Json*) {});
  valijson::Validator validator;
  valijson::ValidationResults results;
  std::string text;
  if (validator.validate(schema, Adapter(object), &results)) return text;
  for (const auto& fault : results) {
    for (const std::string& part : fault.context)
      text += part;
    text += ": " + fault.description + "\n";
  }
  return text;
}

Json tiny_extensions() {
  const rig::GltfSource file = rig::glb_source(test::tiny_rig_file());
  return Json::parse(file.json)["extensions"];
}

/// Every property of `object` must stand in its schema, and so on down.
void expect_described(const Json& object, const Json& schema, const std::string& path) {
  for (const auto& [name, value] : object.items()) {
    ASSERT_TRUE(schema["properties"].contains(name)) << path << "/" << name << " is not in the schema";
    const Json& property = schema["properties"][name];
    if (value.is_object()) {
      expect_described(value, *schema_file(property["allOf"][0]["$ref"]), path + "/" + name);
    } else if (value.is_array() && !value.empty() && value[0].is_object()) {
      for (const Json& element : value)
        expect_described(element, *schema_file(property["items"]["$ref"]), path + "/" + name);
    }
  }
}

TEST(Schema, TheRigIsValid) {
  const Json extensions = tiny_extensions();
  for (const std::string& extension : rig::extensions)
    EXPECT_EQ(faults(extension, extensions[extension]), "") << extension;
}

TEST(Schema, MistakesAreFound) {
  const Json extensions = tiny_extensions();
  Json skull = extensions["FASCIA_skull"];
  skull["cranium"]["positions"] = "many";
  EXPECT_NE(faults("FASCIA_skull", skull).find("positions"), std::string::npos);
  Json tissue = extensions["FASCIA_tissue"];
  tissue["levels"][0]["bindings"][0]["positionHash"] = "0xff";
  EXPECT_NE(faults("FASCIA_tissue", tissue), "");
  Json muscles = extensions["FASCIA_muscles"];
  muscles["muscles"][0].erase("name");
  EXPECT_NE(faults("FASCIA_muscles", muscles), "");
  for (const std::string& extension : rig::extensions) {
    Json object = extensions[extension];
    object["specVersion"] = "2.0";
    EXPECT_NE(faults(extension, object), "") << extension;
    object.erase("specVersion");
    EXPECT_NE(faults(extension, object), "") << extension;
  }
}

TEST(Schema, EverythingWrittenIsDescribed) {
  const Json extensions = tiny_extensions();
  for (const std::string& extension : rig::extensions)
    expect_described(extensions[extension], root_schema(extension), extension);
}

TEST(Schema, EveryPropertyIsDocumentedOnItsPage) {
  for (const std::string& extension : rig::extensions) {
    const std::string page = file_text(folder(extension) / "README.md");
    for (const auto& entry : std::filesystem::directory_iterator(folder(extension) / "schema")) {
      EXPECT_NE(page.find(entry.path().filename()), std::string::npos) << entry.path();
      const Json schema = Json::parse(file_text(entry.path()));
      EXPECT_EQ(schema["$id"], entry.path().filename().string());
      for (const auto& [name, property] : schema["properties"].items())
        if (name != "extensions" && name != "extras") {
          EXPECT_NE(page.find("| `" + name + "` |"), std::string::npos)
              << extension << " " << schema["$id"] << ": " << name;
        }
    }
  }
}

/// The values that the page of FASCIA_tissue gives for rigs without constants of their own, by property.
std::map<std::string, std::vector<double>> documented_constants() {
  std::map<std::string, std::vector<double>> values;
  std::istringstream page(file_text(folder("FASCIA_tissue") / "README.md"));
  bool is_within = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("### ")) is_within = line == "### mechanics";
    if (!is_within || !line.starts_with("| `")) continue;
    const std::string name = line.substr(3, line.find('`', 3) - 3);
    std::string last = line.substr(line.rfind('|', line.size() - 2) + 1);
    while (last.find("−") != std::string::npos)
      last.replace(last.find("−"), std::string("−").size(), "-");
    for (std::size_t at = 0; (at = last.find_first_of("-0123456789", at)) != std::string::npos;) {
      std::size_t length = 0;
      values[name].push_back(std::stod(last.substr(at), &length));
      at += length;
    }
  }
  return values;
}

TEST(Schema, RigsWithoutConstantsGetTheDocumentedOnes) {
  const sim::FaceModelOptions options = sim::face_options_of(rig::Tissue{});
  const sim::ContactOptions& contact = options.contact;
  const auto list = [](const sim::FacingRange& r) { return std::vector{r.before, r.behind, r.beside}; };
  const std::map<std::string, std::vector<double>> used = {
      {"stiffnessDamping", {options.stiffness_damping}},
      {"massDamping", {options.mass_damping}},
      {"activationRise", {options.dynamics.rise}},
      {"activationDecay", {options.dynamics.decay}},
      {"initialForceSlope", {options.initial_force_slope}},
      {"globeStiffness", {contact.globe_stiffness}},
      {"boneStiffness", {contact.bone_stiffness}},
      {"facingStiffness", {contact.facing_stiffness}},
      {"contactThickness", {contact.thickness}},
      {"lidThickness", {contact.lid_thickness}},
      {"friction", {contact.friction}},
      {"stickyReach", {contact.sticky_reach}},
      {"stickyStiffness", {contact.sticky_stiffness}},
      {"lipRange", list(contact.lips)},
      {"lidRange", list(contact.lids)}};
  EXPECT_EQ(documented_constants(), used);
}

}  // namespace
}  // namespace fascia
