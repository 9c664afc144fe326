// Files as capture programs and spreadsheets write them, of our own making: each with its right values.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "geometry/error.h"
#include "runtime/drivers/aliases.h"
#include "runtime/drivers/curves.h"
#include "runtime/drivers/text.h"
#include "runtime/drivers/timecode.h"

namespace fascia::runtime {
namespace {

Curves read(const std::string& text, const ReadOptions& options = {}) {
  return read_curves({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, options);
}

std::string message_of(const std::string& text, const ReadOptions& options = {}) {
  try {
    read(text, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

float value(const Curves& curves, const std::string& name, double seconds) {
  for (const Curve& curve : curves.curves)
    if (curve.name == name) return curve.at(seconds);
  ADD_FAILURE() << "no curve " << name;
  return NAN;
}

bool has_note(const Curves& curves, const std::string& words) {
  for (const std::string& note : curves.notes)
    if (note.find(words) != std::string::npos) return true;
  return false;
}

std::string utf16(const std::string& ascii, bool big, bool mark) {
  std::string text = mark ? (big ? "\xFE\xFF" : "\xFF\xFE") : "";
  for (const char c : ascii) {
    if (big) text += '\0';
    text += c;
    if (!big) text += '\0';
  }
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

TEST(Number, IsReadExactlyInEveryNotation) {
  for (const char* text :
       {"0", "-0.25", "1e-3", "12345.6789", "1E+2", "0.1", "9007199254740993", "4.9e-324",
        "1.7976931348623157e308", "123456789012345678901234567890", "0.000000000000000000001", "-.5", "7."})
    EXPECT_EQ(number(text), std::strtod(text, nullptr)) << text;
  EXPECT_EQ(number("+0,5", true), 0.5);
  EXPECT_EQ(number("1e-400"), 0.0);
  for (const char* text : {"", "-", ".", "1e", "0x10", "1,5", "1 2", "nan", "inf", "1e999", "--1", "1.2.3"})
    EXPECT_FALSE(number(text).has_value()) << text;
}

TEST(Tables, AreTheSameInEveryWriting) {
  const std::string plain = "time,jawOpen,mouthSmileLeft\n0,0,0.25\n0.5,0.75,0.5\n1,0.5,0\n";
  const std::string german = replaced(replaced(plain, ",", ";"), ".", ",");
  const std::string writings[] = {
      plain,
      replaced(plain, "\n", "\r\n"),
      replaced(plain, "\n", "\r"),
      "\xEF\xBB\xBF" + plain,
      german,
      replaced(plain, ",", "\t"),
      replaced(replaced(plain, ",", "\t"), ".", ","),
      replaced(plain, ",", "|"),
      "\"time\",\"jawOpen\",\"mouthSmileLeft\"\n\"0\",\"0\",\"0,25\"\n\"0,5\",\"0,75\",\"0,5\"\n\"1\",\"0,"
      "5\",\"0\"\n",
      "sep=;\r\n" + replaced(german, "\n", "\r\n"),
      "# a recorder's remark\n\n" + replaced(plain, ",", " , "),
      utf16(plain, false, true),
      utf16(plain, true, true),
      utf16(plain, false, false),
      replaced(plain, "\n", ",\n"),  // an empty column
  };
  for (const std::string& writing : writings) {
    const Curves curves = read(writing);
    ASSERT_EQ(curves.curves.size(), 2U) << writing;
    EXPECT_EQ(curves.duration(), 1.0) << writing;
    EXPECT_FLOAT_EQ(value(curves, "jawOpen", 0.25), 0.375F) << writing;
    EXPECT_FLOAT_EQ(value(curves, "mouthSmileLeft", 0.75), 0.25F) << writing;
  }
}

TEST(Tables, BridgeWhatIsMissingAndRefuseWhatIsBroken) {
  const Curves curves = read("time,a,b\n0,0,1\n1,nan,1\n2,,1\n3,0.6,1\n4,0.8\n");
  EXPECT_FLOAT_EQ(value(curves, "a", 1), 0.2F);
  EXPECT_FLOAT_EQ(value(curves, "a", 2), 0.4F);
  EXPECT_TRUE(has_note(curves, "1 cells without a number are bridged, the first in row 3"));
  EXPECT_TRUE(has_note(curves, "1 rows end early"));
  EXPECT_NE(message_of("time,a\n0,0\n1,0.5x\n").find("row 3, column a: \"0.5x\""), std::string::npos);
  EXPECT_NE(message_of("time,a\n0,0\n0,5,0,25\n").find("row 3: 4 cells under a header of 2"),
            std::string::npos);
  EXPECT_NE(message_of("time,a\n0,\"0\n1,1\n").find("row 2: a quote"), std::string::npos);
  EXPECT_NE(message_of("time,a\nx,0\n").find("row 2, column time"), std::string::npos);
  const std::string twice = message_of("time,jawOpen,b,JawOpen\n0,0,0,0\n");
  EXPECT_NE(twice.find("columns 2 (jawOpen) and 4 (JawOpen) are the same"), std::string::npos) << twice;
  EXPECT_NE(message_of("time,mouthSmile_L,mouthSmileLeft\n0,0,0\n").find("are the same"), std::string::npos);
}

TEST(Tables, ValuesBeyondAllRangeAreRefused) {
  EXPECT_NE(message_of("time,head yaw\n0,1\n0.5,-1e308\n").find("head yaw"), std::string::npos);
  EXPECT_NE(message_of(R"({"fps":30,"channels":{"jaw_open":[0,3e38]}})").find("jaw_open"), std::string::npos);
  EXPECT_EQ(read("time,jaw_open\n0,0\n1,12345678\n").curves.size(), 1U);
}

TEST(Tables, TimeCountsFromTheFirstKey) {
  for (const double start : {0.0, -0.5, 600.0, 36000.0, 1732780800.25}) {
    char text[200];
    std::snprintf(text, sizeof text, "time,jawOpen\n%.4f,0\n%.4f,1\n", start, start + 0.5);
    const Curves curves = read(text);
    EXPECT_NEAR(curves.duration(), 0.5, 1e-6) << start;
    EXPECT_NEAR(value(curves, "jawOpen", 0.25), 0.5, 1e-5) << start;
    EXPECT_NEAR(curves.start, start, 1e-6);
  }
  // Milliseconds: by their name, since 1970, by steps no recorder makes in seconds, or as told.
  EXPECT_NEAR(read("time_ms,jawOpen\n0,0\n500,1\n").duration(), 0.5, 1e-12);
  EXPECT_NEAR(read("timestamp,jawOpen\n1732780800250,0\n1732780800750,1\n").duration(), 0.5, 1e-9);
  EXPECT_NEAR(read("timestamp,jawOpen\n1732780800250000000,0\n1732780800750000000,1\n").duration(), 0.5,
              1e-6);
  EXPECT_NEAR(read("time_ns,jawOpen\n0,0\n500000000,1\n").duration(), 0.5, 1e-12);
  std::string steps = "time,jawOpen\n";
  for (int i = 0; i < 31; ++i)
    steps += std::to_string(33 * i) + ",0\n";
  EXPECT_NEAR(read(steps).duration(), 0.99, 1e-9);
  EXPECT_TRUE(has_note(read(steps), "milliseconds"));
  EXPECT_NEAR(read(steps, {0.0, 1.0}).duration(), 990.0, 1e-9);
  // Five seconds between a few keys are five seconds.
  EXPECT_NEAR(read("time,jawOpen\n0,0\n5,1\n10,0\n").duration(), 10.0, 1e-12);
  EXPECT_NE(message_of("time,jawOpen\n0,0\n90000,1\n").find("25 hours"), std::string::npos);
  // Rows without a time, at the rate that is given.
  EXPECT_NE(message_of("frame,jawOpen\n0,0\n1,1\n").find("--fps-in"), std::string::npos);
  EXPECT_NEAR(read("frame,jawOpen\n0,0\n1,1\n", {25.0, 0.0}).duration(), 0.04, 1e-12);
}

TEST(Tables, CellsMayBePercent) {
  const Curves curves = read("time;jawOpen;browInnerUp\n0;0%;0,1\n1;57,5 %;0,1\n");
  EXPECT_FLOAT_EQ(value(curves, "jawOpen", 1), 0.575F);
  EXPECT_FLOAT_EQ(value(curves, "browInnerUp", 1), 0.1F);
  EXPECT_NE(message_of("time,jawOpen\n0,%\n").find("\"%\" is not a number"), std::string::npos);
}

TEST(Tables, APauseOfTheRecorderIsShortened) {
  std::string text = "time,jawOpen,browInnerUp\n";
  for (int row = 0; row < 62; ++row) {
    const double time = row / 30.0 + (row > 30 ? 3600.0 : 0.0);
    text += std::to_string(time) + "," + (row > 30 ? "1" : "0") + "," + (row == 10 ? "" : "0.5") + "\n";
  }
  const Curves curves = read(text);
  EXPECT_TRUE(has_note(curves, "nothing was recorded for 3600 s from 1 s on"));
  EXPECT_NEAR(curves.duration(), 1.0 + 1.0 + 1.0, 1e-5);  // a second of the pause is left
  EXPECT_FLOAT_EQ(value(curves, "jawOpen", 1.0), 0.0F);
  EXPECT_NEAR(value(curves, "jawOpen", 1.5), 0.5, 1e-4);
  EXPECT_FLOAT_EQ(value(curves, "jawOpen", 2.01), 1.0F);
  // Minutes between keys that somebody set are minutes.
  const Curves keyed = read("time,jawOpen\n0,0\n700,1\n1400,0\n");
  EXPECT_NEAR(keyed.duration(), 1400.0, 1e-9);
  EXPECT_FALSE(has_note(keyed, "nothing was recorded"));
  EXPECT_TRUE(has_note(keyed, "there is no row for 700 s from 700 s on"));
  EXPECT_TRUE(has_note(read("time,jawOpen\n0,0\n3600,1\n"), "there is no row for 3600 s from 0 s on"));
  EXPECT_FALSE(has_note(read("time,jawOpen\n0,0\n60,1\n"), "there is no row"));
}

TEST(Tables, RowsALittleOutOfOrderAreSortedAndTwoTakesAreRefused) {
  const Curves curves = read("time,a\n0,0\n2,0.2\n1,0.1\n3,0.3\n3,0.4\n");
  EXPECT_TRUE(has_note(curves, "sorted, from row 3"));
  EXPECT_FLOAT_EQ(value(curves, "a", 1), 0.1F);
  EXPECT_FLOAT_EQ(value(curves, "a", 3), 0.4F);
  std::string two = "time,a\n";
  for (int take = 0; take < 2; ++take)
    for (int i = 0; i < 40; ++i)
      two += std::to_string(0.02 * i) + ",0\n";
  EXPECT_NE(message_of(two).find("row 42, column time: time goes back"), std::string::npos)
      << message_of(two);
}

/// A Live Link Face take of so many frames, as a phone writes it: a ramp of jawOpen of 1 a `rate` frames.
std::string live_link(int rate, int first, int frames, int step = 1, char mark = ':', int dropped = 0) {
  std::string text = "Timecode,BlendShapeCount,JawOpen\r\n";
  for (int i = 0; i < frames; i += step) {
    int count = first + i;
    if (dropped > 0) {  // SMPTE ST 12-1: numbers skipped in each minute but every tenth
      const int minute = 60 * rate - dropped, ten = 10 * minute + dropped;
      const int tens = count / ten, rest = count % ten;
      count += 9 * dropped * tens + (rest > dropped ? dropped * ((rest - dropped) / minute) : 0);
    }
    const int seconds = count / rate;
    char row[80];
    std::snprintf(row, sizeof row, "%02d:%02d:%02d%c%02d.250,61,%.6f\r\n", seconds / 3600 % 24,
                  seconds / 60 % 60, seconds % 60, mark, count % rate, static_cast<double>(i) / rate / 100);
    text += row;
  }
  return text;
}

TEST(Timecodes, GiveTheirOwnRate) {
  for (const int rate : {24, 25, 30, 50, 60, 120})
    for (const int step : {1, 2}) {
      const Curves curves = read(live_link(rate, 3600 * rate + 7, 3 * rate, step));
      EXPECT_DOUBLE_EQ(curves.frames_per_second, rate);
      EXPECT_NEAR(value(curves, "JawOpen", 1.5), 0.015, 1e-6) << rate << " " << step;
      EXPECT_TRUE(has_note(curves, std::to_string(rate) + " frames a second"));
    }
  EXPECT_DOUBLE_EQ(read(live_link(60, 5, 20)).frames_per_second, 60.0);
  EXPECT_TRUE(has_note(read(live_link(60, 5, 20)), "nothing in the take shows its rate"));
  EXPECT_DOUBLE_EQ(read(live_link(30, 5, 20), {30.0, 0.0}).frames_per_second, 30.0);
  // Past midnight, time goes on.
  EXPECT_NEAR(read(live_link(30, 24 * 3600 * 30 - 45, 90)).duration(), 89.0 / 30, 1e-9);
}

TEST(Timecodes, DroppedFramesAreCounted) {
  for (const int rate : {30, 60})
    for (const char mark : {';', ':'}) {
      // From just before one minute to after the next.
      const Curves curves =
          read(replaced(live_link(rate, 50 * rate, 90 * rate, 1, mark, rate / 15), ",", "\t"));
      EXPECT_NEAR(curves.frames_per_second, rate / 1.001, 1e-9) << mark;
      EXPECT_NEAR(curves.duration(), (90.0 * rate - 1) * 1.001 / rate, 1e-6) << rate << mark;
      EXPECT_TRUE(has_note(curves, "dropped frames"));
    }
  // Ten frames about the beginning of a minute tell the rate too.
  for (const int rate : {30, 60})
    for (const int dropped : {0, rate / 15}) {
      const Curves curves = read(live_link(rate, 60 * rate - 5, 10, 1, ':', dropped));
      EXPECT_NEAR(curves.frames_per_second, dropped > 0 ? rate / 1.001 : rate, 1e-9) << dropped;
      EXPECT_NEAR(curves.duration(), 9.0 / curves.frames_per_second, 1e-6) << rate << dropped;
      EXPECT_FALSE(has_note(curves, "nothing in the take shows"));
    }
  // 10 minutes of drop-frame code are 10 minutes: 00:10:00;00 is frame 17,982 (SMPTE ST 12-1).
  const TimecodeTimes times = timecode_times({*timecode("00:00:00;00"), *timecode("00:10:00;00")}, 29.97);
  EXPECT_NEAR(times.seconds[1], 17982 * 1001.0 / 30000, 1e-9);
}

TEST(Values, PercentAndIntensitiesAreScaledWithAWarning) {
  const Curves percent = read("time,jawOpen,mouthSmileLeft,LeftEyeYaw\n0,0,100,0.2\n1,50,20,0.2\n");
  EXPECT_FLOAT_EQ(value(percent, "jawOpen", 1), 0.5F);
  EXPECT_FLOAT_EQ(value(percent, "LeftEyeYaw", 1), 0.2F);
  EXPECT_TRUE(has_note(percent, "percent"));
  // One value beyond 1 among shares is no percent.
  const Curves shares = read("time,jawOpen,a,b,c\n0,0,1,1,1\n1,1.3,0,0,0\n");
  EXPECT_FLOAT_EQ(value(shares, "jawOpen", 1), 1.3F);
  EXPECT_TRUE(has_note(shares, "up to 1.3"));
  // A column of percent beside shares is scaled alone; a spike among shares is cut off as it is.
  const Curves mixed = read("time,jawOpen,a,b,c,d\n0,0,1,1,0,1\n1,30,0,40,0.5,1\n2,60,0.5,0.5,1,1\n");
  EXPECT_FLOAT_EQ(value(mixed, "jawOpen", 1), 0.3F);
  EXPECT_FLOAT_EQ(value(mixed, "a", 0), 1.0F);
  EXPECT_FLOAT_EQ(value(mixed, "b", 1), 40.0F);
  EXPECT_TRUE(has_note(mixed, "taken as percent in jawOpen"));
  const Curves half = read("time,a,b,c,d\n0,50,40,0.3,0.5\n1,80,60,0.9,0.7\n2,60,70,0.9,0.2\n");
  EXPECT_FLOAT_EQ(value(half, "a", 1), 0.8F);
  EXPECT_FLOAT_EQ(value(half, "c", 1), 0.9F);
  // Beyond 100, in a single row, mostly low, and weak.
  EXPECT_FLOAT_EQ(value(read("time,a,b\n0,50,20\n1,103,40\n"), "a", 1), 1.03F);
  EXPECT_FLOAT_EQ(value(read("time,a,b,c\n0,50,0.2,0.3\n"), "a", 0), 0.5F);
  const Curves low = read("time,a,b,c\n0,0.5,1,1\n1,30,0,0\n2,20,1,1\n3,1,0,0\n4,1.1,1,1\n");
  EXPECT_FLOAT_EQ(value(low, "a", 1), 0.3F);
  EXPECT_FLOAT_EQ(value(read("time,a,b,c\n0,0,1,1\n1,5,0,0\n2,8,1,1\n"), "a", 2), 0.08F);
  EXPECT_TRUE(has_note(mixed, "up to 40"));
  // OpenFace: intensities from 0 to 5, presences only where there is no intensity, rows without a face
  // bridged.
  const Curves openface = read(
      "frame, face_id, timestamp, confidence, success, AU12_r, AU12_c, AU28_c, pose_Rx, gaze_angle_x\n"
      "1, 0, 0.000, 0.98, 1, 0.00, 0, 1, 0.1, 0.2\n2, 0, 0.040, 0.02, 0, 5.00, 1, 1, 0.1, 0.2\n"
      "3, 0, 0.080, 0.98, 1, 2.50, 1, 1, 0.1, 0.2\n");
  EXPECT_FLOAT_EQ(value(openface, "AU12_r", 0.08), 0.5F);
  EXPECT_FLOAT_EQ(value(openface, "AU12_r", 0.04), 0.25F);
  EXPECT_EQ(openface.curves.size(), 4U);
  EXPECT_TRUE(has_note(openface, "1 rows without a face"));
  const Curves units = read("time,AU12,AU4\n0,0,1\n1,4,1\n");
  EXPECT_FLOAT_EQ(value(units, "AU12", 1), 0.8F);
  EXPECT_FLOAT_EQ(value(units, "AU4", 1), 0.2F);
}

TEST(Captures, OpenFaceWithItsLandmarksIsRead) {
  // Names that differ in case alone are other things: pixels and millimetres.
  std::string header = "frame,face_id,timestamp,confidence,success", row = ",0,0.04,0.98,1";
  for (const char* kind :
       {"eye_lmk_x_", "eye_lmk_y_", "eye_lmk_X_", "eye_lmk_Y_", "x_", "y_", "X_", "Y_", "p_"})
    for (int i = 0; i < 3; ++i) {
      header += "," + std::string(kind) + std::to_string(i);
      row += ",101.5";
    }
  const Curves curves = read(header + ",AU12_r\n1" + row + ",2.5\n");
  EXPECT_FLOAT_EQ(value(curves, "AU12_r", 0), 0.5F);
}

TEST(Captures, ColumnsOfTextAreLeftOut) {
  const Curves curves = read("time (seconds),input,jawOpen,label\n0,a.jpg,0.2,happy\n1,b.jpg,0.4,sad\n");
  ASSERT_EQ(curves.curves.size(), 1U);
  EXPECT_FLOAT_EQ(value(curves, "jawOpen", 1), 0.4F);
  EXPECT_TRUE(has_note(curves, "columns without a number are left out"));
}

TEST(Captures, JsonOfManyProgramsIsRead) {
  const Curves audio2face = read(
      R"({"exportFps":25,"numPoses":2,"numFrames":3,"facsNames":["jawOpen","mouthPucker"],"weightMat":[[0,1],[0.5,0.5],[1,0]]})");
  EXPECT_NEAR(audio2face.duration(), 0.08, 1e-12);
  EXPECT_FLOAT_EQ(value(audio2face, "jawOpen", 0.06), 0.75F);
  const Curves mediapipe = read(
      R"([{"timestampMs":1000,"faceBlendshapes":[{"categories":[{"categoryName":"_neutral","score":0.1},{"categoryName":"jawOpen","score":0}]}]},)"
      R"({"timestampMs":1500,"faceBlendshapes":[]},)"
      R"({"timestampMs":2000,"faceBlendshapes":[{"categories":[{"categoryName":"_neutral","score":0.1},{"categoryName":"jawOpen","score":0.5}]}]}])");
  ASSERT_EQ(mediapipe.curves.size(), 1U);
  EXPECT_FLOAT_EQ(value(mediapipe, "jawOpen", 0.5), 0.25F);
  const Curves frames =
      read(R"({"fps":10,"frames":[{"blendShapes":{"JawOpen":0.1}},{"blendShapes":{"JawOpen":0.3}}]})");
  EXPECT_FLOAT_EQ(value(frames, "JawOpen", 0.1), 0.3F);
  const Curves beside = read(R"([{"time":3,"jawOpen":0.1},{"time":4,"jawOpen":0.3}])");
  EXPECT_FLOAT_EQ(value(beside, "jawOpen", 0.5), 0.2F);
  std::string row;
  for (int i = 0; i < 55; ++i)
    row += (i > 0 ? "," : "") + std::to_string(i / 100.0);
  const Curves azure = read(R"([{"FrameIndex":0,"BlendShapes":[[)" + row + "],[" + row +
                            R"(]]},{"FrameIndex":2,"BlendShapes":[[)" + row + "]]}]");
  EXPECT_NEAR(azure.duration(), 2.0 / 60, 1e-12);
  EXPECT_FLOAT_EQ(value(azure, "eyeBlinkLeft", 0), 0.0F);
  EXPECT_FLOAT_EQ(value(azure, "jawOpen", 0), 0.17F);
  EXPECT_FLOAT_EQ(value(azure, "tongueOut", 0), 0.51F);
  const Curves visemes = read(
      R"([{"audioOffset":500000,"visemeId":0},{"audioOffset":1500000,"visemeId":21},{"audioOffset":2500000,"visemeId":2}])");
  EXPECT_FLOAT_EQ(value(visemes, "msviseme_21", 0.05), 0.5F);
  EXPECT_FLOAT_EQ(value(visemes, "msviseme_21", 0.1), 1.0F);
  EXPECT_FLOAT_EQ(value(visemes, "msviseme_2", 0.2), 1.0F);
  EXPECT_NE(message_of(R"([{"jawOpen":0.1}])").find("no time"), std::string::npos);
  EXPECT_NE(message_of(R"({"facsNames":["a","b"],"weightMat":[[0,1],[0]]})").find("frame 1"),
            std::string::npos);
  EXPECT_NE(message_of(R"({"asset":{"version":"2.0"}})").find(".glb"), std::string::npos);
}

TEST(Names, AreKnownInEverySpelling) {
  for (const char* name :
       {"mouthSmileLeft", "MouthSmileLeft", "mouthSmile_L", "MouthSmile_L", "mouth_smile_left",
        "mouth_smile_l", "MOUTH_SMILE_LEFT", "mouthSmile.L", "mouthSmile_Left", "mouth smile left"})
    EXPECT_EQ(spelled(name), "mouthsmileleft") << name;
  const auto reads = [](const char* name) {
    for (const std::string& reading : readings(name))
      if (spelled(reading) == "mouthsmileleft") return true;
    return false;
  };
  for (const char* name : {"BS_node.mouthSmileLeft", "blendShapes.MouthSmileLeft", "head__mouthSmileLeft",
                           "ARKit.mouthSmileLeft", "arkit:mouthSmileLeft", "face|mouthSmile_L",
                           "bs_mouthSmile_L", "L_mouthSmile", "rig.head.mouthSmile.L"})
    EXPECT_TRUE(reads(name)) << name;
  const auto target = [](const char* name) {
    const Alias* alias = find_alias(name);
    return alias && !alias->targets.empty() ? alias->targets[0].first : std::string();
  };
  EXPECT_EQ(target("Joy"), "vrm:happy");
  EXPECT_EQ(target("SORROW"), "vrm:sad");
  EXPECT_EQ(target("Blink_L"), "vrm:blinkLeft");
  EXPECT_EQ(target("AU12_r"), "au:12");
  EXPECT_EQ(target("AU12_R"), "au:R12");
  EXPECT_EQ(target("AU12L"), "au:L12");
  EXPECT_EQ(target("AU1_L"), "au:L1");
  EXPECT_EQ(target("eyesClosed"), "arkit:eyeBlinkLeft");
  EXPECT_EQ(target("A"), "vrm:aa");
  EXPECT_EQ(target("LeftEyeYaw"), "eye_yaw_left");
  EXPECT_EQ(target("HeadYaw"), "yaw");
  EXPECT_EQ(find_alias("nobody_knows_this"), nullptr);
}

}  // namespace
}  // namespace fascia::runtime
