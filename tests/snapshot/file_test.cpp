// What a snapshot is as a file: packed numbers, text, and what is refused.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "geometry/error.h"
#include "snapshot/file.h"
#include "snapshot/junit.h"
#include "snapshot/packing.h"

namespace fascia::snapshot {
namespace {

TEST(Packing, GivesBackEveryNumber) {
  constexpr int32_t least = std::numeric_limits<int32_t>::min(), most = std::numeric_limits<int32_t>::max();
  std::vector<int32_t> numbers = {0, 1, -1, least, most, least, 63, 64, -64, -65};
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i)
    numbers.push_back(static_cast<int32_t>(random()));
  for (const size_t stride : {1, 2, 3, 7}) {
    const std::string text = pack(numbers, stride);
    EXPECT_EQ(unpack(text, stride, numbers.size()), numbers) << stride;
    EXPECT_THROW(unpack(text, stride, numbers.size() + 1), Error);
    EXPECT_THROW(unpack(text, stride, numbers.size() - 1), Error);
    EXPECT_THROW(unpack(text, stride, size_t{1} << 40), Error) << "before memory is taken for them";
  }
  EXPECT_EQ(pack({}, 3), "");
  EXPECT_TRUE(unpack("", 3, 0).empty());
}

TEST(Packing, RejectsInvalidData) {
  const std::string text = pack({1, 2, 3, 4, 5, 6}, 3);
  for (size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = damaged[i] == 'A' ? 'B' : 'A';
    // Bits beyond the last byte may differ without a trace; nothing else may.
    try {
      EXPECT_EQ(unpack(damaged, 3, 6), (std::vector<int32_t>{1, 2, 3, 4, 5, 6})) << i;
    } catch (const Error&) {
    }
    EXPECT_THROW(unpack(text.substr(0, i), 3, 6), Error) << i;
  }
  EXPECT_THROW(unpack("no base64!", 3, 6), Error);
}

Snapshot small() {
  Snapshot snapshot;
  snapshot.rig = "00ff";
  snapshot.level = "low";
  snapshot.reasons = {"first recorded", "the \"chin\" was too stiff"};
  snapshot.meshes = {{0, 0, 100}, {2, 1, 50}};
  snapshot.regions = {{"chin", {{0, 3}, {0, 99}, {1, 7}}, 0.03}, {"nose", {{1, 49}}, 0.5}};
  snapshot.poses = {{"smile", {{"arkit:mouthSmileLeft", 1.0}, {"jaw_open", 0.25}}},
                    {"jaw", {{"jaw_open", 1}}}};
  snapshot.takes = {{"take.csv", "takes/take.csv", "abcd", 60.0, {0, 12, 24}}};
  for (const std::string& name : state_names(snapshot)) {
    State state{name, {}};
    for (int i = 0; i < 12; ++i)
      state.quanta.push_back(static_cast<int32_t>(snapshot.states.size()) * 100 - 7 * i);
    snapshot.states.push_back(state);
  }
  return snapshot;
}

TEST(File, GivesBackTheSnapshot) {
  const Snapshot before = small();
  const std::string text = to_text(before);
  const Snapshot after = from_text(text, "file");
  EXPECT_EQ(to_text(after), text);
  EXPECT_EQ(after.regions[0].vertices, before.regions[0].vertices);
  EXPECT_EQ(after.regions[1].tolerance_mm, 0.5);
  EXPECT_EQ(after.poses[0].values, before.poses[0].values);
  EXPECT_EQ(after.takes[0].frames, before.takes[0].frames);
  ASSERT_EQ(after.states.size(), 6U);
  for (size_t s = 0; s < after.states.size(); ++s) {
    EXPECT_EQ(after.states[s].name, before.states[s].name);
    EXPECT_EQ(after.states[s].quanta, before.states[s].quanta);
  }
  EXPECT_EQ(after.states[4].name, "take.csv at 0.200 s");
}

TEST(File, SaysInPlainNumbersWhereRegionsGo) {
  // State "smile" is number 1: the nose's vertex lies at quanta 37, 30, 23 of 0.01 mm.
  EXPECT_NE(to_text(small()).find("\"nose\": [0.37,0.3,0.23,0.53]"), std::string::npos) << to_text(small());
}

TEST(File, RefusesWhatIsNoSnapshot) {
  const std::string text = to_text(small());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    changed.replace(at, from.size(), to);
    return changed;
  };
  for (const std::string& wrong :
       {std::string(), std::string("{}"), std::string("[1]"), text.substr(0, text.size() / 2),
        std::string(100000, '['), with("\"fascia_snapshot\": 1", "\"fascia_snapshot\": 2"),
        with("\"quantum_mm\": 0.01", "\"quantum_mm\": 0"), with("\"count\":3", "\"count\":4"),
        with("\"count\":3", "\"count\":-1"), with("\"count\":3", "\"count\":99999999999"),
        with("[0,0,100]", "[0,0,99]"), with("[0,0,100]", "[0,0]"),
        with("\"frames\":[0,12,24]", "\"frames\":[0,24,12]"),
        with("\"frames\":[0,12,24]", "\"frames\":[0,12]"), with("\"fps\":60.0", "\"fps\":0"),
        with("\"packed\": \"e", "\"packed\": \"f"), with("\"tolerance_mm\":0.5", "\"tolerance_mm\":0")})
    try {
      from_text(wrong, "'file'");
      ADD_FAILURE() << wrong.substr(0, 300);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind("'file'", 0), 0U) << error.what();
    }
}

std::string refusal_of(const std::string& text) {
  try {
    from_text(text, "'file'");
    return "none";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(File, BoundsWhatAllRegionsAndStatesTake) {
  Snapshot snapshot = small();
  snapshot.meshes = {{0, 0, 600'000}};
  snapshot.regions = {{"chin", std::vector<Vertex>(600'000), 0.03},
                      {"nose", std::vector<Vertex>(600'000), 0.03}};
  for (State& state : snapshot.states)
    state.quanta.assign(3 * snapshot.vertex_count(), 0);
  EXPECT_NE(refusal_of(to_text(snapshot)).find("more than a million vertices"), std::string::npos);

  snapshot.regions = {{"chin", std::vector<Vertex>(600'001), 0.03}};
  for (State& state : snapshot.states)
    state.quanta.assign(3 * snapshot.vertex_count(), 0);
  EXPECT_NE(refusal_of(to_text(snapshot)).find("more vertices than the meshes have"), std::string::npos);

  snapshot.regions = {{"chin", std::vector<Vertex>(600'000), 0.03}};
  for (State& state : snapshot.states)
    state.quanta.assign(3 * snapshot.vertex_count(), 0);
  EXPECT_EQ(refusal_of(to_text(snapshot)), "none");
  while (snapshot.poses.size() < 40) {
    snapshot.poses.push_back(snapshot.poses[0]);
    snapshot.states.push_back(snapshot.states[0]);
  }
  EXPECT_NE(refusal_of(to_text(snapshot)).find("more than twenty million places"), std::string::npos);
}

TEST(File, SaysHowDeepItMayBeNested) {
  EXPECT_EQ(refusal_of(std::string(100000, '[')), "'file': it is nested more than 16 deep");
}

TEST(Poses, AreReadWithRegions) {
  Request request;
  read_poses(R"({"poses": {"smile": {"a": 1, "b": 0.5}, "rest": {}},
                 "regions": {"chin": {"landmarks": ["pogonion"], "radius_mm": 8, "tolerance_mm": 0.2},
                             "tip": {"mesh": 1, "primitive": 2, "vertices": [4, 5]}}})",
             "file", request);
  ASSERT_EQ(request.poses.size(), 2U);
  EXPECT_EQ(request.poses[0].values, (Values{{"a", 1.0}, {"b", 0.5}}));
  ASSERT_EQ(request.regions.size(), 2U);
  EXPECT_EQ(request.regions[0].radius_mm, 8.0);
  EXPECT_EQ(request.regions[0].tolerance_mm, 0.2);
  EXPECT_EQ(request.regions[1].vertices, (std::vector<uint32_t>{4, 5}));
  for (const char* wrong :
       {"", "[]", "{}", R"({"poses": 1})", R"({"poses": {"x": {"a": "b"}}})", R"({"poses": {"x": 1}})",
        R"({"regions": {"r": {}}})", R"({"regions": {"r": {"landmarks": []}}})",
        R"({"regions": {"r": {"landmarks": 4}}})",
        R"({"regions": {"r": {"landmarks": ["a"], "radius_mm": -1}}})"}) {
    Request other;
    EXPECT_THROW(read_poses(wrong, "file", other), Error) << wrong;
  }
}

TEST(Junit, NamesEveryStateAndEscapes) {
  Snapshot then = small(), now = small();
  then.states[1].name = now.states[1].name = "smile <&>";
  now.states[1].quanta[0] += 100;
  const std::string xml = junit(then, compare(then, now), "faces", 0.0);
  EXPECT_NE(xml.find("tests=\"6\" failures=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("name=\"smile &lt;&amp;&gt;\">"), std::string::npos) << xml;
  EXPECT_NE(xml.find("chin: 0.577 mm on average, 1.000 mm at vertex 3 of mesh 0"), std::string::npos) << xml;
}

TEST(Junit, SaysWhatWasAllowedOfThisCheck) {
  Snapshot then = small(), now = small();
  now.states[1].quanta[0] += 100;
  const std::string xml = junit(then, compare(then, now, 0.125), "faces", 0.125);
  EXPECT_NE(xml.find("; 0.125 mm allowed"), std::string::npos) << xml;
}

}  // namespace
}  // namespace fascia::snapshot
