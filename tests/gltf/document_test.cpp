#include "gltf/edit/document.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "gltf/edit/appendix.h"
#include "gltf/edit/uri.h"

namespace fascia::gltf {
namespace {

std::vector<uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

OutsideFile nothing(const std::string&) {
  return {std::nullopt, "is not there"};
}

TEST(Uri, DecodesDataAndPercent) {
  const auto data = data_uri("data:image/webp;base64,AQIDBA==");
  ASSERT_TRUE(data);
  EXPECT_EQ(data->bytes, (std::vector<uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(data->media_type, "image/webp");
  EXPECT_FALSE(data_uri("tex.png"));
  EXPECT_THROW(data_uri("data:text/plain,hello"), Error);
  EXPECT_EQ(percent_decoded("skin%20%C3%A4%2"), "skin \xC3\xA4%2");
  EXPECT_TRUE(has_scheme("https://x/y.png"));
  EXPECT_FALSE(has_scheme("C:\\tex\\y.png"));
  EXPECT_FALSE(has_scheme("tex/y.png"));
}

TEST(Uri, TellsPicturesByTheirFirstBytes) {
  EXPECT_EQ(picture_type(bytes_of("\x89PNG\r\n")), "image/png");
  EXPECT_EQ(picture_type(bytes_of("\xFF\xD8\xFF")), "image/jpeg");
  EXPECT_EQ(picture_type(bytes_of("RIFF1234WEBPVP8 ")), "image/webp");
  EXPECT_EQ(picture_type(bytes_of("\xABKTX 20\xBB\r\n")), "image/ktx2");
  EXPECT_EQ(picture_type(bytes_of("hello")), "");
  EXPECT_EQ(picture_type_of_name("A.KTX2"), "image/ktx2");
}

TEST(SelfContained, GivesPicturesTheirOwnTypes) {
  Document document{R"({"asset":{"version":"2.0"},"images":[{"uri":"a.webp"},{"uri":"b.png"},{"uri":"a.webp"},
                       {"uri":"data:image/webp;base64,AQID"}]})",
                    {}};
  const auto resolve = [](const std::string& uri) -> OutsideFile {
    // The second lies about itself: its bytes say KTX2.
    return {bytes_of(uri == "a.webp" ? "RIFF1234WEBP" : "\xABKTX 20\xBB"), ""};
  };
  std::vector<std::string> warnings;
  const Json root = Json::parse(self_contained(document, resolve, "x", &warnings).json);
  EXPECT_TRUE(warnings.empty());
  const Json& images = root["images"];
  EXPECT_EQ(images[0]["mimeType"], "image/webp");
  EXPECT_EQ(images[1]["mimeType"], "image/ktx2");
  EXPECT_EQ(images[3]["mimeType"], "image/webp");
  EXPECT_EQ(images[0]["bufferView"], images[2]["bufferView"]);
  for (const Json& image : images)
    EXPECT_FALSE(image.contains("uri"));
}

TEST(SelfContained, AMissingOrRemotePictureIsAWarning) {
  Document document{
      R"({"asset":{"version":"2.0"},"images":[{"uri":"gone.png"},{"uri":"https://x.org/y.png"}]})", {}};
  std::vector<std::string> warnings;
  const Json root = Json::parse(self_contained(document, nothing, "x", &warnings).json);
  EXPECT_EQ(root["images"][0]["uri"], "gone.png");
  EXPECT_EQ(root["images"][1]["uri"], "https://x.org/y.png");
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_NE(warnings[0].find("gone.png"), std::string::npos);
}

TEST(SelfContained, AMissingBufferIsAnErrorThatNamesIt) {
  Document document{R"({"asset":{"version":"2.0"},"buffers":[{"uri":"head.bin","byteLength":4}]})", {}};
  try {
    self_contained(document, nothing, "'head.gltf'");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("head.bin"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("'head.gltf'"), std::string::npos);
  }
}

TEST(SelfContained, WhatIsWholeComesBackByteByByte) {
  const Document document{
      R"({ "asset":{"version":"2.0"}, "extras" : {"a":1.50},"buffers":[{"byteLength":3}]})", {1, 2, 3, 0}};
  const Document same = self_contained(document, nothing, "x");
  EXPECT_EQ(same.json, document.json);
  EXPECT_EQ(same.bin, document.bin);
}

TEST(SelfContained, NamesThatAreNotUtf8AreRepairedAndSaid) {
  std::vector<std::string> warnings;
  const Document document{"{\"asset\":{\"version\":\"2.0\"},\"materials\":[{\"name\":\"H\xE4ut\"}]}", {}};
  const Json root = Json::parse(self_contained(document, nothing, "x", &warnings).json);
  EXPECT_EQ(root["materials"][0]["name"], "H\xC3\xA4ut");
  EXPECT_EQ(warnings.size(), 1U);
}

TEST(Appendix, StoresTheSameContentOnce) {
  Json root = Json::object();
  std::vector<uint8_t> bin;
  Appendix appendix(root, bin);
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  const std::size_t first = appendix.add_floats(values, 3);
  EXPECT_EQ(appendix.add_floats(values, 3), first);
  EXPECT_NE(appendix.add_floats(values, 2), first);  // another shape over the same bytes
  EXPECT_EQ(bin.size(), 24U);
  EXPECT_EQ(root["bufferViews"].size(), 1U);
}

TEST(Appendix, IsSparseOnlyWhereThatIsSmaller) {
  Json root = Json::object();
  std::vector<uint8_t> bin;
  Appendix appendix(root, bin);
  std::vector<Vec3f> few(100, Vec3f::Zero());
  few[7] = Vec3f(1, -2, 3);
  const auto added = [&](const std::vector<Vec3f>& vectors) {
    const std::size_t index = appendix.add_vectors(vectors, true);
    return Json(root["accessors"][index]);
  };
  const Json sparse = added(few);
  EXPECT_EQ(sparse["sparse"]["count"], 1);
  EXPECT_EQ(sparse["min"], Json({0.0, -2.0, 0.0}));
  EXPECT_EQ(sparse["max"], Json({1.0, 0.0, 3.0}));
  const Json none = added(std::vector<Vec3f>(100, Vec3f::Zero()));
  EXPECT_EQ(none["sparse"]["count"], 1);
  const Json dense = added(std::vector<Vec3f>(100, Vec3f::Ones()));
  EXPECT_FALSE(dense.contains("sparse"));
}

}  // namespace
}  // namespace fascia::gltf
