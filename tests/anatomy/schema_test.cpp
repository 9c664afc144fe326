#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "anatomy/anatomy.h"

namespace fascia::anatomy {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

Json schema_of(const std::string& file) {
  const std::string stem =
      file.rfind("expressions/", 0) == 0 ? "expressions" : file.substr(0, file.find('.'));
  std::ifstream stream(std::string(FASCIA_ANATOMY_SCHEMA) + "/" + stem + ".schema.json");
  return Json::parse(stream);
}

/// The first complaints of validating `document`; empty when it is sound.
std::string complaints(const Json& schema_document, const Json& document) {
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(Adapter(schema_document), schema);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, Adapter(document), &results)) return {};
  std::string text = "invalid";
  valijson::ValidationResults::Error error;
  for (int i = 0; i < 5 && results.popError(error); ++i) {
    text += "\n ";
    for (const std::string& part : error.context)
      text += part;
    text += ": " + error.description;
  }
  return text;
}

TEST(AnatomySchemas, EveryDataFileIsValid) {
  int checked = 0;
  for (const std::string& file : embedded_files()) {
    if (!file.ends_with(".json")) continue;
    EXPECT_EQ(complaints(schema_of(file), Json::parse(embedded_file(file))), "") << file;
    ++checked;
  }
  EXPECT_EQ(checked, 16);
}

TEST(AnatomySchemas, MistakesAreCaught) {
  Json muscles = Json::parse(embedded_file("muscles.json"));
  const Json schema = schema_of("muscles.json");
  muscles["muscles"][0]["kind"] = "cloth";
  EXPECT_NE(complaints(schema, muscles), "");
  muscles = Json::parse(embedded_file("muscles.json"));
  muscles["muscles"][0].erase("origin");
  EXPECT_NE(complaints(schema, muscles), "");
  muscles = Json::parse(embedded_file("muscles.json"));
  muscles["muscles"][0]["peak_shortning"] = 0.2;
  EXPECT_NE(complaints(schema, muscles), "");

  Json landmarks = Json::parse(embedded_file("landmarks.json"));
  landmarks["landmarks"][0]["skin"] = {1.0, 2.0};
  EXPECT_NE(complaints(schema_of("landmarks.json"), landmarks), "");

  Json tissue = Json::parse(embedded_file("tissue.json"));
  tissue["smas_depths"]["sites"][0]["fraction"] = 1.5;
  EXPECT_NE(complaints(schema_of("tissue.json"), tissue), "");
}

}  // namespace
}  // namespace fascia::anatomy
