#include "gltf/edit/raw_numbers.h"

#include <gtest/gtest.h>

#include "geometry/error.h"

namespace fascia::gltf {
namespace {

TEST(RawNumbers, StayAsTheyAreStoredAndElementsAreAligned) {
  Json root = {
      {"accessors", {{{"componentType", 5120}, {"count", 2}, {"type", "VEC3"}, {"normalized", true}}}}};
  std::vector<uint8_t> bin;
  Appendix appendix(root, bin);
  RawNumbers numbers;
  numbers.width = 3;
  numbers.component = int8;
  numbers.values = {-128, 0, 127, 1, 2, 3};
  const std::size_t added = append_like(root, appendix, numbers, 0, vertex_target);
  const Json& view = root["bufferViews"][root["accessors"][added]["bufferView"].get<std::size_t>()];
  EXPECT_EQ(view["byteStride"], 4);  // three bytes of an attribute are padded to four
  EXPECT_TRUE(root["accessors"][added]["normalized"]);
  const auto read = raw_numbers(root, bin, added, 2);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->values, numbers.values);
  EXPECT_FALSE(raw_numbers(root, bin, added, 3)) << "of another count";
}

TEST(RawNumbers, EqualBytesOfAnotherStrideAreAnotherView) {
  Json root = {{"accessors",
                {{{"componentType", 5121}, {"count", 2}, {"type", "VEC3"}},
                 {{"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}}}}};
  std::vector<uint8_t> bin;
  Appendix appendix(root, bin);
  RawNumbers bytes, floats;
  bytes.width = 3;
  bytes.component = uint8;
  bytes.values.assign(6, 0.0);
  floats.values.assign(2, 0.0);
  const std::size_t a = append_like(root, appendix, bytes, 0, vertex_target),
                    b = append_like(root, appendix, floats, 1, vertex_target);
  EXPECT_NE(root["accessors"][a]["bufferView"], root["accessors"][b]["bufferView"]);
}

TEST(RawNumbers, FewMovedElementsAreSparse) {
  Json root = {{"accessors", {{{"componentType", 5126}, {"count", 9}, {"type", "VEC3"}, {"min", {0}}}}}};
  std::vector<uint8_t> bin;
  Appendix appendix(root, bin);
  RawNumbers numbers;
  numbers.width = 3;
  numbers.values.assign(27, 0.0);
  numbers.at(4)[1] = -2.0;
  const std::size_t added = append_like(root, appendix, numbers, 0, vertex_target, true);
  EXPECT_EQ(root["accessors"][added]["sparse"]["count"], 1);
  EXPECT_EQ(root["accessors"][added]["min"], Json({0.0, -2.0, 0.0}));
  EXPECT_EQ(raw_numbers(root, bin, added, 9)->values, numbers.values);
}

TEST(RawNumbers, RefuseWhatReachesOutside) {
  const std::vector<uint8_t> bin(24, 1);
  const auto refuses = [&](const Json& accessor) {
    Json root = {{"accessors", {accessor}},
                 {"bufferViews", {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 24}}}}};
    EXPECT_THROW(raw_numbers(root, bin, 0, 2), Error) << accessor;
  };
  refuses({{"bufferView", 0}, {"byteOffset", 4}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
  refuses({{"bufferView", 0}, {"componentType", 5130}, {"count", 2}, {"type", "VEC3"}});
  refuses({{"bufferView", 0}, {"componentType", 5126}, {"count", 2}, {"type", "MAT4"}});
  const auto sparse = [](int element) {
    Json indices = {{"bufferView", 0}, {"componentType", 5121}, {"byteOffset", element}};
    return Json{{"count", 1}, {"indices", indices}, {"values", {{"bufferView", 0}}}};
  };
  refuses({{"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}, {"sparse", sparse(30)}});
  Json many = sparse(0);
  many["count"] = 3;
  refuses({{"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}, {"sparse", many}});
}

}  // namespace
}  // namespace fascia::gltf
