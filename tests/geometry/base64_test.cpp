#include "geometry/base64.h"

#include <gtest/gtest.h>

namespace fascia {
namespace {

std::vector<uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

TEST(Base64, MatchesTheVectorsOfRfc4648) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, text] : vectors) {
    EXPECT_EQ(to_base64(bytes_of(plain)), text);
    EXPECT_EQ(from_base64(text), bytes_of(plain));
  }
}

TEST(Base64, ReadsBothAlphabetsWithAndWithoutPadding) {
  const std::vector<uint8_t> bytes = {0xFB, 0xFF};
  EXPECT_EQ(from_base64("+/8="), bytes);
  EXPECT_EQ(from_base64("-_8"), bytes);
}

TEST(Base64, CountsTheCharactersItSkips) {
  size_t skipped = 7;
  EXPECT_EQ(from_base64("Zm9v", &skipped), bytes_of("foo"));
  EXPECT_EQ(skipped, 0U);
  EXPECT_EQ(from_base64("Zm\n9v!", &skipped), bytes_of("foo"));
  EXPECT_EQ(skipped, 2U);
}

}  // namespace
}  // namespace fascia
