#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "geometry/error.h"
#include "runtime/drivers/curves.h"

namespace fascia::runtime {
namespace {

Curves read(const std::string& text) {
  return read_curves({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

std::string message_of(const std::string& text) {
  try {
    read(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const Curve& curve(const Curves& curves, const std::string& name) {
  for (const Curve& candidate : curves.curves)
    if (candidate.name == name) return candidate;
  ADD_FAILURE() << "no curve " << name;
  static const Curve none;
  return none;
}

TEST(Curve, InterpolatesAndHoldsItsEnds) {
  Curve line{"a", {1, 2, 4}, {0, 1, 0}, Interpolation::linear, {}, {}};
  EXPECT_EQ(line.at(0), 0.0F);
  EXPECT_FLOAT_EQ(line.at(1.25), 0.25F);
  EXPECT_FLOAT_EQ(line.at(3), 0.5F);
  EXPECT_EQ(line.at(9), 0.0F);
  EXPECT_EQ(line.at(std::nan("")), 0.0F);
  line.interpolation = Interpolation::step;
  EXPECT_EQ(line.at(1.99), 0.0F);
  EXPECT_EQ(line.at(2), 1.0F);
  EXPECT_EQ(line.at(3.99), 1.0F);
}

TEST(Curve, CubicGoesThroughItsKeysAndKeepsStraightLinesStraight) {
  const Curve straight{"a", {0, 1, 2, 3}, {0, 2, 4, 6}, Interpolation::cubic, {}, {}};
  for (double t = 0; t <= 3; t += 0.125)
    EXPECT_NEAR(straight.at(t), 2 * t, 1e-6);
  // Hermite with given tangents: a cubic t^3 on [0, 2] comes back exactly.
  const Curve cubic{"b", {0, 2}, {0, 8}, Interpolation::cubic, {0, 12}, {0, 12}};
  for (double t = 0; t <= 2; t += 0.25)
    EXPECT_NEAR(cubic.at(t), t * t * t, 1e-5);
}

TEST(Csv, ReadsTimeAndColumns) {
  const Curves curves = read("\xEF\xBB\xBFtime, jaw_open ,au:12\r\n0,0,0.5\r\n0.5,1,\r\n1,0,1\r\n");
  ASSERT_EQ(curves.curves.size(), 2U);
  EXPECT_FLOAT_EQ(curve(curves, "jaw_open").at(0.25), 0.5F);
  EXPECT_FLOAT_EQ(curve(curves, "au:12").at(0.5), 0.75F);  // the empty cell is left out
  EXPECT_EQ(curves.duration(), 1.0);
}

TEST(Csv, ATakeIsAsLongAsItsRows) {
  const Curves curves = read("time,jaw_open\n10,\n11,0.5\n12,1\n13,\n");
  EXPECT_EQ(curves.start, 10.0);
  EXPECT_EQ(curves.duration(), 3.0);
  for (const auto& [seconds, value] :
       {std::pair{0.0, 0.5F}, {1.0, 0.5F}, {1.5, 0.75F}, {2.0, 1.0F}, {3.0, 1.0F}})
    EXPECT_FLOAT_EQ(curve(curves, "jaw_open").at(seconds), value) << seconds;
}

TEST(Csv, ReadsLiveLinkFaceByItsHeader) {
  const std::string text =
      "Timecode,BlendShapeCount,EyeBlinkLeft,JawRight,JawLeft,HeadYaw\n"
      "10:59:59:58.500,61,0.1,0.2,0.3,-0.4\n"
      "10:59:59:59.500,61,0.2,0.3,0.4,-0.4\n"
      "11:00:00:00.500,61,0.3,0.4,0.5,-0.4\n";
  const Curves curves = read(text);
  EXPECT_EQ(curves.curves.size(), 4U);
  const Curve& right = curve(curves, "JawRight");
  ASSERT_EQ(right.times.size(), 3U);
  EXPECT_EQ(right.times[0], 0.0);
  EXPECT_NEAR(right.times[1], 1.0 / 60, 1e-9);
  EXPECT_NEAR(right.times[2], 2.0 / 60, 1e-9);
  EXPECT_FLOAT_EQ(right.at(1.0 / 60), 0.3F);
  EXPECT_FLOAT_EQ(curve(curves, "JawLeft").at(1.0 / 60), 0.4F);
}

TEST(Csv, ReportsThePositionOfErrors) {
  EXPECT_NE(message_of("time,a\n0,1\n1,x\n").find("row 3, column a"), std::string::npos);
  EXPECT_NE(message_of("time,a\n0,nan\n").find("no column of values"), std::string::npos);
  EXPECT_NE(message_of("a,b\n1,0\n").find("time"), std::string::npos);
  EXPECT_NE(message_of("time,a\n").find("no rows"), std::string::npos);
  EXPECT_NE(message_of("Timecode,a\n12:00,0\n").find("hours"), std::string::npos);
  EXPECT_NE(message_of("  \n").find("empty"), std::string::npos);
}

TEST(Json, ReadsSampledAndKeyedChannels) {
  const Curves sampled = read(R"({"fps":30,"channels":{"a":[0,1,0.5]}})");
  EXPECT_NEAR(sampled.duration(), 2.0 / 30, 1e-12);
  EXPECT_FLOAT_EQ(curve(sampled, "a").at(1.5 / 30), 0.75F);
  const Curves keyed =
      read(R"({"a":{"times":[0,2],"values":[0,1]},"b":{"times":[0,1],"values":[0,1],"interpolation":"step"},)"
           R"("c":{"times":[0,1,2],"values":[0,1,2],"interpolation":"cubic"}})");
  EXPECT_FLOAT_EQ(curve(keyed, "a").at(1), 0.5F);
  EXPECT_FLOAT_EQ(curve(keyed, "b").at(0.9), 0.0F);
  EXPECT_FLOAT_EQ(curve(keyed, "c").at(1.5), 1.5F);
}

TEST(Json, ReportsThePositionOfErrors) {
  EXPECT_NE(message_of("{").find("malformed"), std::string::npos);
  EXPECT_NE(message_of("{}").find("no channel"), std::string::npos);
  EXPECT_NE(message_of(R"({"channels":{"a":[1]}})").find("fps"), std::string::npos);
  EXPECT_NE(message_of(R"({"fps":30,"channels":{"a":[1,"x"]}})").find("channel a"), std::string::npos);
  EXPECT_NE(message_of(R"({"a":{"times":[0,1],"values":[0]}})").find("channel a: 2 times but 1"),
            std::string::npos);
  EXPECT_NE(message_of(R"({"a":{"times":[1,0],"values":[0,1]}})").find("rise"), std::string::npos);
  EXPECT_NE(message_of(R"({"a":{"times":[0],"values":[0],"interpolation":"wild"}})").find("interpolation"),
            std::string::npos);
}

}  // namespace
}  // namespace fascia::runtime
