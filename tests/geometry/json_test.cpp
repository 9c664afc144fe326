#include "geometry/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "geometry/error.h"

namespace fascia {
namespace {

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(Json, RefusesDeepJsonAndOnlyThat) {
  EXPECT_NO_THROW(check_depth(nested(greatest_depth), "x"));
  EXPECT_THROW(check_depth(nested(greatest_depth + 1), "x"), Error);
  // Brackets within strings, behind an escaped quote too, do not nest.
  EXPECT_NO_THROW(check_depth("{\"a\":\"\\\"" + std::string(1000, '[') + "\"}", "x"));
  // Many, side by side, are not deep.
  std::string wide = "[";
  for (int i = 0; i < 1000; ++i)
    wide += "[],";
  EXPECT_NO_THROW(check_depth(wide + "1]", "x"));
}

TEST(Json, IsParsedOrDiscardedOrRefused) {
  EXPECT_EQ(parse_json<nlohmann::json>("[1,2]", "x").size(), 2u);
  EXPECT_TRUE(parse_json<nlohmann::ordered_json>("[1,2", "x").is_discarded());
  EXPECT_THROW(parse_json<nlohmann::json>(nested(100000), "x"), Error);
}

}  // namespace
}  // namespace fascia
