// JSON as deep as it may be, and far deeper, on a host's thread with a small stack.
#include <gtest/gtest.h>

#include <pthread.h>

#include <functional>
#include <string>

#include "gltf/read/container.h"
#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

/// Runs `work` on a thread with a stack of 512 kB.
void on_small_stack(std::function<void()> work) {
  pthread_attr_t attributes;
  ASSERT_EQ(pthread_attr_init(&attributes), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, 512 * 1024), 0);
  const auto run = [](void* what) -> void* {
    (*static_cast<std::function<void()>*>(what))();
    return nullptr;
  };
  pthread_t thread;
  ASSERT_EQ(pthread_create(&thread, &attributes, run, &work), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
}

std::string nested_lists(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

fascia_result load_curves(const void* bytes, std::size_t size) {
  fascia_curves* curves = nullptr;
  const fascia_result result = fascia_curves_load(bytes, size, &curves);
  fascia_curves_release(curves);
  return result;
}

/// Curves whose JSON is `depth` levels deep in each of the places that are copied.
void expect_curves(std::size_t depth, fascia_result expected) {
  const std::string deep = nested_lists(depth);
  for (const std::string& text :
       {R"({"fps":)" + deep + R"(,"channels":{"jaw_open":[0,1]}})",
        R"({"jaw_open":{"times":[0,1],"values":[0,1],"interpolation":)" + deep + "}}",
        R"({"channels":{"jaw_open":)" + deep + "}}", R"({"weightMat":)" + deep + R"(,"facsNames":[]})", deep})
    EXPECT_EQ(load_curves(text.data(), text.size()), expected) << text.substr(0, 60) << ": " << depth;
}

TEST(SmallStack, DeepJsonOfCurvesIsAnError) {
  on_small_stack([] {
    expect_curves(190, FASCIA_ERROR_FORMAT);
    expect_curves(100'000, FASCIA_ERROR_FORMAT);
  });
}

TEST(SmallStack, DeepJsonOfGltfIsReadOrAnError) {
  on_small_stack([] {
    for (const std::size_t depth : {190, 100'000}) {
      const std::string json =
          R"({"asset":{"version":"2.0"},"extras":)" + nested_lists(depth) + R"(,"animations":[]})";
      const std::vector<uint8_t> glb = fascia::gltf::glb_bytes(json, {});
      EXPECT_EQ(load_curves(glb.data(), glb.size()), FASCIA_ERROR_FORMAT) << depth;
      fascia_asset* asset = nullptr;
      EXPECT_NE(fascia_asset_load(glb.data(), glb.size(), &asset), FASCIA_OK) << depth;
    }
  });
}

}  // namespace
