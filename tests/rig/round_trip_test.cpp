#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "gltf/read/container.h"
#include "rig/model/fields.h"
#include "rig/read/read.h"
#include "rig/write/write.h"
#include "tests/rig/tiny_rig.h"

namespace fascia {
namespace {

using Json = nlohmann::ordered_json;

/// Every number and text of a rig in one string of bytes, by walking the field lists: two rigs are equal when
/// theirs are.
class Collector {
 public:
  void text(const char* name, const std::string& value) { add(name, value.data(), value.size()); }
  template <class T>
  void number(const char* name, T value) {
    add(name, &value, sizeof value);
  }
  void bounded(const char* name, double value, double, double) { number(name, value); }
  void hash(const char*, uint64_t) {}
  void vector(const char* name, const rig::Vec3f& value) { add(name, value.data(), 12); }
  void matrix(const char* name, const rig::Mat4f& value) { add(name, value.data(), 64); }
  template <class Enum>
  void choice(const char* name, Enum value, std::span<const std::string_view>) {
    add(name, &value, sizeof value);
  }
  template <class Body>
  void object(const char*, const Body& body) {
    body(*this);
  }
  template <class T, class Body>
  void array(const char* name, const std::vector<T>& list, const Body& body) {
    const std::size_t size = list.size();
    add(name, &size, sizeof size);
    for (std::size_t i = 0; i < size; ++i)
      body(*this, list[i], i);
  }
  template <class T>
  void list(const char* name, const std::vector<T>& values, std::size_t) {
    add(name, values.data(), values.size() * sizeof(T));
    ++lists;
  }
  template <class T>
  void unbounded(const char* name, const std::vector<T>& values, std::size_t length) {
    list(name, values, length);
  }
  template <class T>
  void index(const char* name, const std::vector<T>& values, std::size_t length, std::size_t) {
    list(name, values, length);
  }
  void offsets(const char* name, const std::vector<uint32_t>& values, std::size_t length) {
    list(name, values, length);
  }
  void triangles(const char* name, const std::vector<rig::Triangle>& values, std::size_t limit) {
    list(name, values, limit);
  }
  void texts(const char* name, const std::vector<std::string>& values) {
    for (const std::string& value : values)
      text(name, value);
  }
  template <class T>
  void names(const char* name, const std::vector<T>& values, std::string T::*member) {
    for (const T& value : values)
      text(name, value.*member);
  }
  template <class T, class M>
  void column(const char* name, const std::vector<T>& values, M T::*member) {
    for (const T& value : values)
      add(name, &(value.*member), sizeof(M));
  }

  std::string bytes;
  int lists = 0;

 private:
  void add(const char* name, const void* data, std::size_t size) {
    bytes += std::string(name) + ":" + std::to_string(size) + "=";
    if (size > 0) bytes.append(static_cast<const char*>(data), size);
  }
};

Collector collect(const rig::Rig& rig) {
  Collector all;
  rig::skull_fields(all, rig.skull);
  rig::smas_fields(all, rig.smas);
  const rig::MuscleTable table = rig::pack_muscles(rig.muscles);
  rig::muscle_table_fields(all, table, 0);
  for (std::size_t level = 0; level < rig.tissue.levels.size(); ++level) {
    rig::tissue_level_fields(all, rig.tissue.levels[level], {});
    for (const rig::Binding& binding : rig.tissue.bindings[level])
      rig::binding_fields(all, binding, 0);
  }
  rig::actuation_fields(all, rig.actuation);
  if (rig.tissue.mechanics) rig::mechanics_fields(all, *rig.tissue.mechanics);
  all.matrix("input", rig.input_to_metres);
  return all;
}

TEST(RoundTrip, EveryFieldComesBackEqual) {
  const rig::Rig before = test::tiny_rig();
  const rig::RigFile after = rig::read(test::tiny_rig_file());
  const Collector a = collect(before), b = collect(after.rig);
  EXPECT_GT(a.lists, 40);
  EXPECT_EQ(a.bytes.size(), b.bytes.size());
  EXPECT_TRUE(a.bytes == b.bytes);
}

TEST(RoundTrip, InfinityIsKeptThoughGltfForbidsIt) {
  const rig::RigFile file = rig::read(test::tiny_rig_file());
  const auto& limits = file.rig.tissue.levels[0].spring_limit_strain;
  EXPECT_EQ(limits.back(), std::numeric_limits<float>::infinity());
  EXPECT_EQ(limits.front(), 0.3F);
}

TEST(RoundTrip, WritingAgainGivesTheSameBytes) {
  const std::vector<uint8_t> once = test::tiny_rig_file();
  EXPECT_EQ(once, test::tiny_rig_file());
  // A rig that is written over a rig replaces it.
  const rig::RigFile file = rig::read(once);
  EXPECT_EQ(once, rig::write(rig::glb_source(once), file.rig));
}

TEST(RoundTrip, TheHeadStaysAsItCame) {
  const rig::GltfSource head = test::tiny_head();
  const rig::RigFile file = rig::read(test::tiny_rig_file());
  const Json before = Json::parse(head.json), after = Json::parse(file.json);
  for (const char* key : {"asset", "scene", "scenes", "nodes", "materials", "meshes", "animations"})
    EXPECT_EQ(before[key], after[key]) << key;
  for (const char* key : {"accessors", "bufferViews"})
    for (std::size_t i = 0; i < before[key].size(); ++i)
      EXPECT_EQ(before[key][i], after[key][i]);
  EXPECT_EQ(0, std::memcmp(head.bin.data(), file.bin.data(), head.bin.size()));
  EXPECT_FALSE(after.contains("extensionsRequired"));
  for (const auto& [name, object] : after["extensions"].items())
    EXPECT_NE(std::find(after["extensionsUsed"].begin(), after["extensionsUsed"].end(), name),
              after["extensionsUsed"].end());
  EXPECT_EQ(after["extensions"].size(), 5U);
}

TEST(RoundTrip, TheOriginalComesBack) {
  const rig::GltfSource head = test::tiny_head();
  const rig::GltfSource back = rig::original(rig::glb_source(test::tiny_rig_file()));
  EXPECT_EQ(Json::parse(head.json), Json::parse(back.json));
  EXPECT_EQ(head.bin, back.bin);
}

TEST(RoundTrip, TheSourceRecordComesBack) {
  rig::GltfSource head = test::tiny_head();
  head.record = {"obj", R"({"order":[2,1,0]})", {'v', ' ', '1', '\n', 0, 255}};
  const std::vector<uint8_t> bytes = rig::write(head, test::tiny_rig());
  EXPECT_EQ(rig::read(bytes).source, head.record);
  const rig::GltfSource back = rig::original(rig::glb_source(bytes));
  EXPECT_EQ(back.record, head.record);
  EXPECT_EQ(back.bin, head.bin);
  // Rebuilding from the rig keeps the record.
  EXPECT_EQ(bytes, rig::write(rig::glb_source(bytes), test::tiny_rig()));
}

TEST(RoundTrip, BulkNumbersLieInAccessorsOfTheirOwn) {
  const rig::RigFile file = rig::read(test::tiny_rig_file());
  const Json root = Json::parse(file.json);
  const Json& level = root["extensions"]["FASCIA_tissue"]["levels"][0];
  const Json& rest = root["accessors"][level["rest"].get<std::size_t>()];
  EXPECT_EQ(rest["componentType"], 5126);
  EXPECT_EQ(rest["type"], "VEC3");
  EXPECT_EQ(rest["count"], 3 * 289);
  const Json& kinds = root["accessors"][level["kinds"].get<std::size_t>()];
  EXPECT_EQ(kinds["componentType"], 5121);
  const Json& springs = root["accessors"][level["springNodes"].get<std::size_t>()];
  EXPECT_EQ(springs["componentType"], 5123);
  EXPECT_EQ(springs["type"], "VEC2");
  EXPECT_NE(rest["bufferView"], kinds["bufferView"]);
  EXPECT_EQ(root["bufferViews"][rest["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() % 4,
            0U);
  // The whole of the JSON is small beside the numbers.
  EXPECT_LT(file.json.size(), 40000U);
}

TEST(RoundTrip, PrimitivesComeWithTheRig) {
  const rig::RigFile file = rig::read(test::tiny_rig_file());
  ASSERT_EQ(file.primitives.size(), 1U);
  EXPECT_EQ(file.primitives[0].name, "face");
  EXPECT_EQ(file.primitives[0].positions.size(), 289U);
  EXPECT_EQ(file.primitives[0].triangles.size(), 512U);
  const rig::Binding& binding = file.rig.tissue.bindings[0][0];
  const rig::Vec3f in_rig = (binding.to_rig * file.primitives[0].positions[7].homogeneous()).head<3>();
  EXPECT_LT((in_rig - file.rig.tissue.levels[0].rest[7]).norm(), 1e-6F);
}

TEST(Embed, JoinsExternalAndDataBuffersAndTakesImagesIn) {
  rig::GltfSource source;
  source.json = R"({"asset":{"version":"2.0"},"buffers":[{"uri":"a%20b.bin","byteLength":5},)"
                R"({"uri":"data:application/octet-stream;base64,AQIDBA==","byteLength":4,"name":"second"}],)"
                R"("bufferViews":[{"buffer":0,"byteLength":5},{"buffer":1,"byteOffset":1,"byteLength":3}],)"
                R"("images":[{"uri":"t.png"},{"uri":"missing.png"}]})";
  source.resolve = [](const std::string& uri) -> std::optional<std::vector<uint8_t>> {
    if (uri == "a b.bin") return std::vector<uint8_t>{9, 8, 7, 6, 5};
    if (uri == "t.png") return std::vector<uint8_t>{0x89, 'P', 'N', 'G', 1};
    return std::nullopt;
  };
  const rig::GltfSource joined = rig::embed(source);
  const std::vector<uint8_t> expected = {9, 8, 7, 6, 5, 0,    0,   0,   1,   2, 3,
                                         4, 0, 0, 0, 0, 0x89, 'P', 'N', 'G', 1};
  EXPECT_EQ(joined.bin, expected);
  const Json root = Json::parse(joined.json);
  EXPECT_EQ(root["buffers"], Json::parse(R"([{"byteLength":21}])"));
  EXPECT_EQ(root["bufferViews"][1], Json::parse(R"({"buffer":0,"byteOffset":9,"byteLength":3})"));
  EXPECT_EQ(root["images"][0], Json::parse(R"({"bufferView":2,"mimeType":"image/png"})"));
  EXPECT_EQ(root["images"][1]["uri"], "missing.png");
}

TEST(Embed, SaysWhichFileIsMissing) {
  rig::GltfSource source;
  source.json = R"({"asset":{"version":"2.0"},"buffers":[{"uri":"head.bin","byteLength":5}]})";
  try {
    rig::embed(source);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("head.bin"), std::string::npos);
  }
}

}  // namespace
}  // namespace fascia
