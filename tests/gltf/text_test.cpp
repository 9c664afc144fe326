#include "gltf/read/text.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"

namespace fascia::gltf {
namespace {

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(Text, ADeepFileIsAnErrorBeforeAnyParserSeesIt) {
  const std::string json = R"({"asset":{"version":"2.0"},"extras":)" + nested(100000) + "}";
  EXPECT_THROW(load_model(glb_bytes(json, {}), "deep.glb"), Error);
}

TEST(Text, KnowsUtf8) {
  EXPECT_TRUE(is_utf8("plain"));
  EXPECT_TRUE(is_utf8("h\xC3\xA4ut"));
  EXPECT_TRUE(is_utf8("\xF0\x9F\x98\x80"));
  for (const char* bad :
       {"\xE4", "\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xC3", "\x80", "\xE0\x80\x80"})
    EXPECT_FALSE(is_utf8(bad)) << bad;
}

TEST(Text, ReadsLatin1WhereItIsNotUtf8) {
  EXPECT_EQ(as_utf8("h\xE4ut"), "h\xC3\xA4ut");
  EXPECT_EQ(as_utf8("h\xC3\xA4ut \xFF"), "h\xC3\xA4ut \xC3\xBF");
  EXPECT_TRUE(is_utf8(as_utf8("\xED\xA0\x80\xC0\xAF\xC3")));
}

}  // namespace
}  // namespace fascia::gltf
