// Differences of two snapshots whose answer is known.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/error.h"
#include "snapshot/compare.h"

namespace fascia::snapshot {
namespace {

/// One region of four vertices in one pose, all at rest.
Snapshot four() {
  Snapshot snapshot;
  snapshot.quantum_mm = 0.01;
  snapshot.meshes = {{0, 0, 4}};
  snapshot.regions = {{"lip", {{0, 0}, {0, 1}, {0, 2}, {0, 3}}, 0.1}};
  snapshot.poses = {{"pose", {}}};
  snapshot.states = {{"rest", std::vector<int32_t>(12, 0)}, {"pose", std::vector<int32_t>(12, 0)}};
  return snapshot;
}

TEST(Compare, MeasuresMeanAndLargest) {
  Snapshot now = four();
  now.states[1].quanta[3] = 30;  // vertex 1: 0.3, 0.4 mm
  now.states[1].quanta[4] = -40;
  const Comparison comparison = compare(four(), now);
  ASSERT_EQ(comparison.differences.size(), 2U);
  EXPECT_EQ(comparison.differences[0].largest_mm, 0.0);
  EXPECT_NEAR(comparison.differences[1].largest_mm, 0.5, 1e-12);
  EXPECT_NEAR(comparison.differences[1].mean_mm, 0.25, 1e-12);
  EXPECT_EQ(comparison.differences[1].vertex.vertex, 1U);
  EXPECT_EQ(comparison.failed, 1U);
  EXPECT_EQ(comparison.worst(1)[0].state, 1U);
}

TEST(Compare, AllowsTheToleranceAndNoMore) {
  Snapshot now = four();
  for (size_t i = 0; i < 12; i += 3)
    now.states[1].quanta[i] = 10;  // every vertex 0.1 mm: just allowed
  EXPECT_EQ(compare(four(), now).failed, 0U);
  now.states[1].quanta[0] = 11;
  EXPECT_EQ(compare(four(), now).failed, 1U);
  EXPECT_EQ(compare(four(), now, 0.2).failed, 0U);
  // One vertex alone may be off by four times as much as all may be, and not more.
  Snapshot one = four();
  one.regions[0].vertices.resize(4);
  one.states[1].quanta = std::vector<int32_t>(12, 0);
  one.states[1].quanta[0] = 20;
  EXPECT_EQ(compare(four(), one).failed, 0U);
  one.states[1].quanta[0] = 41;
  EXPECT_EQ(compare(four(), one).failed, 1U);
}

TEST(Compare, RefusesWhatIsNotTheSame) {
  Snapshot other = four();
  other.states[1].name = "other";
  EXPECT_THROW(compare(four(), other), Error);
  other = four();
  other.regions[0].vertices[3].vertex = 2;
  EXPECT_THROW(compare(four(), other), Error);
  other = four();
  other.quantum_mm = 0.02;
  EXPECT_THROW(compare(four(), other), Error);
  other = four();
  other.states.pop_back();
  EXPECT_THROW(compare(four(), other), Error);
}

}  // namespace
}  // namespace fascia::snapshot
