#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <string>
#include <vector>

#include "fascia/api.h"
#include "tests/runtime/hosts_memory.h"
#include "tests/runtime/loaded.h"

// Every allocation of the process goes through here.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {
std::atomic<int> allocations{0};
}

extern "C" {
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++allocations;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++allocations;
  *block = __libc_memalign(alignment, size);
  return *block != nullptr ? 0 : 12;
}
}

namespace {

using namespace fascia::test;

TEST(Memory, AFrameDoesNotAllocate) {
  const Loaded rig;
  const Face face(rig.asset), second(rig.asset);
  const fascia_layer layer = {sizeof layer, FASCIA_COMBINE_SATURATE, 0.5F, 0, nullptr};
  ASSERT_EQ(fascia_face_set_layer(face.face, 1, &layer), FASCIA_OK);
  const std::string csv = "time,zygomaticus_major_left,jawOpen\n0,0,0\n1,0.8,1\n";
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(csv.data(), csv.size(), &curves), FASCIA_OK);
  size_t size = 0;
  fascia_face_save(face.face, nullptr, 0, &size);
  std::vector<uint8_t> state(size);
  std::vector<float> written(4 * static_cast<std::size_t>(side * side)), texture(4 * 3 * written.size());
  fascia_vectors vectors = {};
  vectors.struct_size = sizeof vectors;
  int bad = 0;
  const auto frame = [&](int number) {
    fascia_face* const faces[2] = {face.face, second.face};
    const auto time = static_cast<float>(number) / 60.0F;
    float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, scale = 0;
    place[12] = 0.01F * time;
    const float point[3] = {time, 1.6F, 1.0F};
    fascia_face_values(face.face)[1] = time;
    bad += fascia_face_set(face.face, "ARKit:mouthSmileLeft", time) != FASCIA_OK;
    bad += fascia_face_layer_set(face.face, 1, "zygomaticus_major_left", time) != FASCIA_OK;
    bad += fascia_face_set_member(face.face, 0, 2, 0.3F) != FASCIA_OK;
    bad += fascia_face_layer_set_member(face.face, 1, 0, 2, 0.3F) != FASCIA_OK;
    bad += fascia_curves_apply(curves, static_cast<double>(time), 1.0F, face.face) != FASCIA_OK;
    bad += fascia_curves_apply_to_layer(curves, static_cast<double>(time), 1.0F, face.face, 1) != FASCIA_OK;
    bad += fascia_face_look_at(face.face, point, 1.0F) != FASCIA_OK;
    bad += fascia_face_blend(face.face, 0.5F, 1.0F) != FASCIA_OK;
    bad += fascia_face_move_head(face.face, place, 1.0F) != FASCIA_OK;
    bad += fascia_faces_step(faces, 2, 1.0F / 60.0F, nullptr) != FASCIA_OK;
    bad += fascia_face_positions(face.face, 0, &vectors) != FASCIA_OK;
    bad += fascia_face_normals(face.face, 0, &vectors) != FASCIA_OK;
    bad += fascia_face_tangents(face.face, 0, &vectors) != FASCIA_OK;
    bad += fascia_face_compression(face.face, 0, &vectors) != FASCIA_OK;
    bad += fascia_face_write_normals(face.face, 0, written.data(), 12, side * side) != FASCIA_OK;
    bad += fascia_face_write_deltas(face.face, 0, FASCIA_DELTA_SNORM16, written.data(), 8, side * side,
                                    &scale) != FASCIA_OK;
    bad += fascia_face_write_node_texture(face.face, 0, texture.data(), 3 * side * side) != FASCIA_OK;
    bad += fascia_face_save(face.face, state.data(), state.size(), &size) != FASCIA_OK;
    bad += fascia_face_restore(face.face, state.data(), state.size()) != FASCIA_OK;
  };
  frame(0);
  frame(1);
  const int before = allocations;
  for (int i = 2; i < 60; ++i)
    frame(i);
  const int during = allocations - before;
  EXPECT_EQ(during, 0);
  EXPECT_EQ(bad, 0);
  fascia_curves_release(curves);
}

/// The counter of the test before sees what the library allocates.
TEST(Memory, TheCounterSeesTheLibrarysAllocations) {
  const Loaded rig;
  int before = allocations;
  const Face face(rig.asset);
  EXPECT_GT(allocations, before) << "of making a face";
  fascia_vectors vectors = {};
  vectors.struct_size = sizeof vectors;
  before = allocations;
  ASSERT_EQ(fascia_face_normals(face.face, 0, &vectors), FASCIA_OK);
  EXPECT_GT(allocations, before) << "of the first normals";
}

TEST(Memory, ComesFromTheHost) {
  Host host;
  const fascia_allocator allocator = {sizeof allocator, 0, allocate, release, &host};
  const std::vector<uint8_t> bytes = tiny_rig_file();
  {  // the table of names, which is kept for good
    const Loaded rig(bytes);
    const Face face(rig.asset);
    fascia_face_set(face.face, "mouthSmile_L", 0.1F);
    EXPECT_EQ(fascia_set_allocator(&allocator), FASCIA_ERROR_ARGUMENT);
  }
  const fascia_result set = fascia_set_allocator(&allocator);
  if (set == FASCIA_ERROR_MODULE) GTEST_SKIP() << fascia_last_message();
  ASSERT_EQ(set, FASCIA_OK) << fascia_last_message();
  {
    const int before = allocations;
    fascia_asset* asset = nullptr;
    fascia_face* face = nullptr;
    const bool is_made = fascia_asset_load(bytes.data(), bytes.size(), &asset) == FASCIA_OK &&
                         fascia_face_create(asset, nullptr, &face) == FASCIA_OK &&
                         fascia_face_pose(face) == FASCIA_OK;
    EXPECT_EQ(allocations, before);
    EXPECT_TRUE(is_made);
    EXPECT_GT(host.live, 100);
    fascia_face* other = nullptr;
    fascia_face_options options = fascia_default_face_options();
    options.solver = FASCIA_SOLVER_BULLET;
    EXPECT_EQ(fascia_face_create(asset, &options, &other), FASCIA_ERROR_MODULE);
    host.is_out = true;
    EXPECT_EQ(fascia_face_create(asset, nullptr, &other), FASCIA_ERROR_MEMORY);
    host.is_out = false;
    fascia_face_release(face);
    fascia_asset_release(asset);
  }
  EXPECT_EQ(host.live, 0);
  EXPECT_EQ(fascia_set_allocator(nullptr), FASCIA_OK);
  const fascia_allocator lacking = {sizeof lacking, 0, allocate, nullptr, nullptr};
  EXPECT_EQ(fascia_set_allocator(&lacking), FASCIA_ERROR_ARGUMENT);
}

/// Uses the library with an allocator of the host's and ends.
[[noreturn]] void use_and_end(const std::vector<uint8_t>& bytes) {
  static Host host;
  const fascia_allocator allocator = {sizeof allocator, 0, allocate, release, &host};
  if (fascia_set_allocator(&allocator) == FASCIA_ERROR_MODULE) std::exit(0);
  fascia_asset* asset = nullptr;
  fascia_face* face = nullptr;
  if (fascia_asset_load(bytes.data(), bytes.size(), &asset) != FASCIA_OK) std::exit(2);
  if (fascia_face_create(asset, nullptr, &face) != FASCIA_OK) std::exit(3);
  fascia_face_set(face, "mouthSmile_L", 0.1F);
  fascia_face_release(face);
  fascia_asset_release(asset);
  std::exit(0);
}

/// What the library made before the host's allocator was set is not the host's when the program ends.
TEST(Memory, AProgramMayEndWithItsAllocatorSet) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const std::vector<uint8_t> bytes = tiny_rig_file();
  EXPECT_EXIT(use_and_end(bytes), testing::ExitedWithCode(0), "");
}

TEST(FunctionTable, ContainsEveryFunction) {
  const fascia_api* api = nullptr;
  ASSERT_EQ(fascia_get_api(FASCIA_VERSION_MAJOR << 16 | FASCIA_VERSION_MINOR << 8, &api), FASCIA_OK);
  EXPECT_EQ(api->struct_size, sizeof(fascia_api));
  EXPECT_EQ(api->library_version, fascia_version());
  const auto* const members = reinterpret_cast<void* const*>(reinterpret_cast<const char*>(api) + 8);
  for (std::size_t i = 0; i < (sizeof(fascia_api) - 8) / sizeof(void*); ++i)
    EXPECT_NE(members[i], nullptr) << i;
  EXPECT_EQ(api->version(), fascia_version());
  const std::vector<uint8_t> bytes = tiny_rig_file();
  fascia_asset* asset = nullptr;
  ASSERT_EQ(api->asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK);
  api->asset_release(asset);
  EXPECT_EQ(fascia_get_api((FASCIA_VERSION_MAJOR + 1) << 16, &api), FASCIA_ERROR_VERSION);
  EXPECT_EQ(fascia_get_api((FASCIA_VERSION_MAJOR << 16) | (FASCIA_VERSION_MINOR + 1) << 8, &api),
            FASCIA_ERROR_VERSION);
}

}  // namespace
