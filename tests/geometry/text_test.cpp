#include "geometry/text.h"

#include <gtest/gtest.h>

namespace fascia {
namespace {

TEST(Text, EndingsAreComparedInLowerCase) {
  EXPECT_EQ(extension_of("heads/Head.GLB"), ".glb");
  EXPECT_EQ(extension_of("take.v2.Csv"), ".csv");
  EXPECT_EQ(extension_of("folder.d/name"), "");
  EXPECT_EQ(extension_of(".hidden"), "");
}

TEST(Text, BytesBeyondAsciiStayAsTheyAre) {
  EXPECT_EQ(lower_case("\xC3\x84 HEAD"), "\xC3\x84 head");
}

TEST(Text, MarkupIsShownAsText) {
  EXPECT_EQ(escaped_markup("<a href=\"x\">&</a>"), "&lt;a href=&quot;x&quot;&gt;&amp;&lt;/a&gt;");
  EXPECT_EQ(escaped_markup(std::string_view("a\0b\x1B\n\t", 6)), "a?b?\n\t");
}

}  // namespace
}  // namespace fascia
