// A host may round otherwise, flush subnormal numbers to zero or trap: faces move the same to the last bit,
// and the host's mode is left as it was.
#include <gtest/gtest.h>

#include <cfenv>
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "fascia/fascia.h"
#include "tests/rig/tiny_rig.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace {

/// Positions after a pose and some frames, as bytes.
std::vector<float> play(const fascia_tasks* tasks = nullptr) {
  // Inputs are the same in every mode: they are made once, in the usual one.
  static const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  static const std::vector<float> opening = [] {
    std::vector<float> values;
    for (int frame = 0; frame < 20; ++frame)
      values.push_back(0.04F * static_cast<float>(frame));
    return values;
  }();
  fascia_asset* asset = nullptr;
  fascia_face* face = nullptr;
  EXPECT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK);
  EXPECT_EQ(fascia_face_create(asset, nullptr, &face), FASCIA_OK);
  fascia_face_set(face, "zygomaticus_major_left", 0.7F);
  EXPECT_EQ(fascia_face_pose(face), FASCIA_OK);
  std::vector<float> all;
  for (const float value : opening) {
    fascia_face_set(face, "jaw_open", value);
    EXPECT_EQ(fascia_faces_step(&face, 1, 0.015625F, tasks), FASCIA_OK);
    fascia_vectors positions = {};
    positions.struct_size = sizeof positions;
    EXPECT_EQ(fascia_face_positions(face, 0, &positions), FASCIA_OK);
    all.insert(all.end(), positions.data, positions.data + 3 * positions.count);
  }
  fascia_face_release(face);
  fascia_asset_release(asset);
  return all;
}

bool same(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(ArithmeticMode, RoundingOfTheHostChangesNothing) {
  const std::vector<float> usual = play();
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    std::fesetround(mode);
    const std::vector<float> other = play();
    const int after = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(after, mode);
    EXPECT_TRUE(same(other, usual)) << mode;
  }
}

#if defined(__SSE2__)
TEST(ArithmeticMode, FlushingSubnormalsChangesNothing) {
  const std::vector<float> usual = play();
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040);  // flush to zero, subnormals are zero
  const std::vector<float> other = play();
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  EXPECT_EQ(after, before | 0x8040U);
  EXPECT_TRUE(same(other, usual));
}

/// A host that traps invalid operations and the like is not ended by the library, and still traps afterwards.
TEST(ArithmeticMode, FloatingPointTrapsOfTheHostAreNotTriggered) {
  const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  const unsigned before = _mm_getcsr();
  const unsigned trapping = 0;  // all six exceptions, inexact results too: our arithmetic would spring them
  fascia_asset* asset = nullptr;
  fascia_face* face = nullptr;
  _mm_setcsr(trapping);
  const fascia_result loaded = fascia_asset_load(bytes.data(), bytes.size(), &asset);
  const fascia_result created = fascia_face_create(asset, nullptr, &face);
  const fascia_result set = fascia_face_set(face, "zygomaticus_major_left", 0.7F);
  const fascia_result posed = fascia_face_pose(face);
  const fascia_result stepped = fascia_face_step(face, 0.02F);
  fascia_vectors positions = {};
  positions.struct_size = sizeof positions;
  const fascia_result read = fascia_face_positions(face, 0, &positions);
  fascia_face_release(face);
  fascia_asset_release(asset);
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  for (const fascia_result result : {loaded, created, set, posed, stepped, read})
    EXPECT_EQ(result, FASCIA_OK);
  EXPECT_EQ(after, trapping) << "with no exception marked that the host had not raised";
}

/// Tasks on a thread whose mode is the host's own.
struct OtherThread {
  static void* begin(fascia_task_range run, uint32_t count, uint32_t, void* context, void*) {
    std::thread thread([=] {
      _mm_setcsr(_mm_getcsr() | 0x8040 | _MM_ROUND_UP);
      run(0, count, context);
    });
    thread.join();
    return nullptr;
  }
  static void finish(void*, void*) {}
};

TEST(ArithmeticMode, ThreadsOfTheHostChangeNothing) {
  fascia_tasks tasks = {};
  tasks.struct_size = sizeof tasks;
  tasks.begin = OtherThread::begin;
  tasks.finish = OtherThread::finish;
  EXPECT_TRUE(same(play(&tasks), play()));
}
#endif

/// Numbers are read with a point wherever the host's language writes a comma.
TEST(ArithmeticMode, DecimalCommaOfTheHostLocaleChangesNothing) {
  const auto curve = [] {
    const std::string csv = "time,jaw_open\n0,0.25\n1.5,0.75\n";
    const std::string json = R"({"fps":12.5,"channels":{"jaw_open":[0.25,0.75]}})";
    std::vector<float> values = play();
    for (const std::string& text : {csv, json}) {
      fascia_curves* curves = nullptr;
      EXPECT_EQ(fascia_curves_load(text.data(), text.size(), &curves), FASCIA_OK);
      fascia_curves_info info = {};
      info.struct_size = sizeof info;
      EXPECT_EQ(fascia_curves_get_info(curves, &info), FASCIA_OK);
      values.push_back(static_cast<float>(info.duration));
      fascia_curves_release(curves);
    }
    return values;
  };
  const std::vector<float> usual = curve();
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const char* comma = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"})
    if (comma == nullptr) comma = std::setlocale(LC_ALL, name);
  const std::string made = testing::TempDir() + "locales_with_a_comma";
  if (comma == nullptr && std::system(("mkdir -p '" + made + "' && localedef -i de_DE -f UTF-8 '" + made +
                                       "/de_DE.UTF-8' >/dev/null 2>&1")
                                          .c_str()) == 0) {
    setenv("LOCPATH", made.c_str(), 1);
    comma = std::setlocale(LC_ALL, "de_DE.UTF-8");
  }
  if (comma == nullptr) GTEST_SKIP() << "no language with a decimal comma is installed: see locale -a";
  const std::vector<float> other = curve();
  const std::string point = std::localeconv()->decimal_point;
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(point, ",") << "the host's language is left alone";
  EXPECT_TRUE(same(other, usual));
}

}  // namespace
