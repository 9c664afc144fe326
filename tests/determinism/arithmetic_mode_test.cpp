// A host may round otherwise, flush subnormal numbers to zero or trap: faces move the same to the last bit,
// and the host's mode is left as it was.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstring>
#include <functional>
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
  const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  fascia_asset* asset = nullptr;
  fascia_face* face = nullptr;
  EXPECT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK);
  EXPECT_EQ(fascia_face_create(asset, nullptr, &face), FASCIA_OK);
  fascia_face_set(face, "zygomaticus_major_left", 0.7F);
  EXPECT_EQ(fascia_face_pose(face), FASCIA_OK);
  std::vector<float> all;
  for (int frame = 0; frame < 20; ++frame) {
    fascia_face_set(face, "jaw_open", 0.04F * static_cast<float>(frame));
    EXPECT_EQ(fascia_faces_step(&face, 1, 1.0F / 60.0F, tasks), FASCIA_OK);
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
  EXPECT_EQ(after & 0x8040U, 0x8040U);
  EXPECT_TRUE(same(other, usual));
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

}  // namespace
