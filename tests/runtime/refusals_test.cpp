// A host whose memory is refused now and then: every call says so, does no harm and keeps nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fascia/fit.h"
#include "fascia/gpu.h"
#include "fascia/research.h"
#include "gltf/read/container.h"
#include "tests/runtime/hosts_memory.h"
#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

class Refusals : public testing::Test {
 protected:
  void SetUp() override {
    const fascia_allocator allocator = {sizeof allocator, 0, allocate, release, &host};
    const fascia_result set = fascia_set_allocator(&allocator);
    if (set == FASCIA_ERROR_MODULE) GTEST_SKIP() << fascia_last_message();
    ASSERT_EQ(set, FASCIA_OK) << fascia_last_message();
    is_set = true;
  }
  void TearDown() override {
    if (!is_set) return;
    EXPECT_EQ(fascia_set_allocator(nullptr), FASCIA_OK) << fascia_last_message();
  }

  /// Runs `call` once for every allocation it makes, which is refused, alone or with all that follow: it
  /// returns FASCIA_ERROR_MEMORY and leaves behind what there was. Of those after the first `dense` about
  /// `samples` are.
  template <class Call>
  void expect_errors(const char* what, const Call& call, int64_t dense = 300, int64_t samples = 200) {
    const int64_t before = host.live, made = host.made;
    ASSERT_EQ(call(), FASCIA_OK) << what << ": " << fascia_last_message();
    ASSERT_EQ(host.live, before) << what;
    const int64_t all = host.made - made, stride = std::max<int64_t>(1, all / samples);
    ASSERT_GT(all, 0) << what;
    for (const bool alone : {true, false})
      for (int64_t nth = 0; nth < all; nth += nth < dense ? 1 : stride) {
        host.refuse_after(nth, alone);
        const fascia_result result = call();
        host.refuse_no_more();
        ASSERT_EQ(result, FASCIA_ERROR_MEMORY)
            << what << ": allocation " << nth << " of " << all << (alone ? "" : " and all that follow");
        ASSERT_EQ(host.live, before) << what << ": allocation " << nth << " of " << all
                                     << (alone ? "" : " and all that follow");
      }
    EXPECT_EQ(call(), FASCIA_OK) << what;
    EXPECT_EQ(host.live, before) << what;
  }

  Host host;
  bool is_set = false;
};

TEST_F(Refusals, LoadingARigAndMakingAFace) {
  const std::vector<uint8_t> bytes = tiny_rig_file();
  { const Loaded kept(bytes); }
  expect_errors("asset and face", [&] {
    fascia_asset* asset = nullptr;
    fascia_face* face = nullptr;
    fascia_result result = fascia_asset_load(bytes.data(), bytes.size(), &asset);
    if (result == FASCIA_OK) result = fascia_face_create(asset, nullptr, &face);
    fascia_face_release(face);
    fascia_asset_release(asset);
    return result;
  });
}

/// Names of other programs: the table is kept for good, but only once it is whole.
TEST_F(Refusals, TheTableOfNames) {
  const Loaded rig;
  const Face face(rig.asset);
  const int64_t before = host.live;
  for (int64_t nth = 0; nth < 100000; nth += nth < 300 ? 1 : 97) {
    host.refuse_after(nth, nth % 2 == 0);
    const fascia_result result = fascia_face_set(face.face, "mouthSmile_L", 0.1F);
    const bool was_refused = host.until_out < 0;
    host.refuse_no_more();
    ASSERT_EQ(result, was_refused ? FASCIA_ERROR_MEMORY : FASCIA_OK) << nth << ": " << fascia_last_message();
    if (!was_refused) break;
  }
  EXPECT_EQ(fascia_face_set(face.face, "mouthSmile_L", 0.1F), FASCIA_OK) << fascia_last_message();
  EXPECT_LE(before, host.live);
}

TEST_F(Refusals, Curves) {
  const Loaded rig;
  const Face face(rig.asset);
  fascia_face_set(face.face, "mouthSmile_L", 0.1F);  // the table of names
  std::string clip = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":2},"targets":[{"POSITION":2}]}],
               "extras":{"targetNames":["jawOpen"]}}],
    "buffers":[{"byteLength":28}],
    "bufferViews":[{"buffer":0,"byteLength":8},{"buffer":0,"byteOffset":8,"byteLength":8},
                   {"buffer":0,"byteOffset":16,"byteLength":12}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":2,"type":"SCALAR"},
                 {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR"},
                 {"bufferView":2,"componentType":5126,"count":1,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],
    "animations":[{"samplers":[{"input":0,"output":1}],
                   "channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]}]})";
  std::vector<uint8_t> numbers(28, 0);
  const float keys[4] = {0.0F, 1.0F, 0.0F, 0.7F};
  std::memcpy(numbers.data(), keys, sizeof keys);
  const std::vector<uint8_t> glb = fascia::gltf::glb_bytes(clip, numbers);
  const std::vector<std::pair<const char*, std::string>> files = {
      {"CSV", "time,zygomaticus_major_left,mouthSmile_L\n0,0,0\n1,0.8,1\n"},
      {"JSON", R"({"fps":30,"channels":{"jaw_open":[0,0.5,1],"mouthSmile_L":[0,0.1,0.2]}})"},
      {"keyed JSON", R"({"jaw_open":{"times":[0,1],"values":[0,1],"interpolation":"step"}})"},
      {"captured JSON", R"({"exportFps":25,"facsNames":["jawOpen"],"weightMat":[[0],[0.5],[1]]})"},
      {"glTF", {glb.begin(), glb.end()}}};
  for (const auto& [what, bytes] : files)
    expect_errors(what, [&, &bytes = bytes] {
      fascia_curves* curves = nullptr;
      uint32_t known = 0;
      uint8_t matched[8] = {};
      fascia_result result = fascia_curves_load(bytes.data(), bytes.size(), &curves);
      if (result == FASCIA_OK) result = fascia_curves_match(curves, rig.asset, &known, matched);
      // Once refused the other call is made as ever: what it keeps is whole or not there.
      const fascia_result applied =
          curves != nullptr ? fascia_curves_apply(curves, 0.5, 1.0F, face.face) : FASCIA_OK;
      if (result == FASCIA_OK) result = applied;
      fascia_curves_release(curves);
      return result;
    });
}

TEST_F(Refusals, Fits) {
  fascia::rig::Rig whole = tiny_rig();
  for (const char* name : {"jaw_forward", "jaw_lateral"})
    whole.actuation.channels.push_back({name, "jaw", 0.0F, 1.0F, 0.0F, -1, "1"});
  const Loaded rig(fascia::rig::write(tiny_head(), whole));
  { const Face face(rig.asset); }  // the asset's models
  std::vector<fascia_fit_place> places;
  std::vector<float> points;
  for (const uint32_t v : {40U, 60U, 144U, 200U, 230U, 250U}) {
    places.push_back({0, {v, v, v}, {1.0F, 0.0F, 0.0F}});
    for (const float number :
         {0.01F * static_cast<float>(v % side), 0.01F * static_cast<float>(v / side), 0.02F})
      points.push_back(number);
  }
  fascia_fit_landmarks landmarks{};
  landmarks.struct_size = sizeof landmarks;
  landmarks.count = static_cast<uint32_t>(places.size());
  landmarks.places = places.data();
  const auto fitted = [&] {
    fascia_fit* fit = nullptr;
    fascia_fit_result found{};
    found.struct_size = sizeof found;
    fascia_result result = fascia_fit_create(rig.asset, &landmarks, nullptr, &fit);
    if (result == FASCIA_OK) result = fascia_fit_set_neutral(fit, points.data(), nullptr);
    if (result == FASCIA_OK) result = fascia_fit_push(fit, points.data(), nullptr, &found);
    if (result == FASCIA_OK) result = fascia_fit_reset(fit);
    fascia_fit_release(fit);
    return result;
  };
  ASSERT_EQ(fitted(), FASCIA_OK) << fascia_last_message();
  expect_errors("fit", fitted, 40, 60);
  // A detector's mark-up: the rig has too few of its landmarks, which is told only with memory to tell it.
  fascia_fit_landmarks set{};
  set.struct_size = sizeof set;
  set.set = "ibug68";
  const int64_t before = host.live;
  for (int64_t nth = 0; nth < 5000; ++nth) {
    fascia_fit* fit = nullptr;
    host.refuse_after(nth, nth % 2 == 0);
    const fascia_result result = fascia_fit_create(rig.asset, &set, nullptr, &fit);
    const bool was_refused = host.until_out < 0;
    host.refuse_no_more();
    ASSERT_EQ(result, was_refused ? FASCIA_ERROR_MEMORY : FASCIA_ERROR_ARGUMENT)
        << nth << ": " << fascia_last_message();
    ASSERT_EQ(host.live, before) << nth;
    if (!was_refused) break;
  }
}

/// Everything a face is asked for the first time; one refused leaves the others, and the face stays sound.
TEST_F(Refusals, WhatAFaceIsAsked) {
  const Loaded rig;
  const int64_t before = host.live;
  int64_t all = 0;
  const auto ask = [&](int64_t refused, bool alone) {
    const Face own(rig.asset);
    fascia_face* const face = own.face;
    fascia_vectors vectors{};
    vectors.struct_size = sizeof vectors;
    fascia_energies energies{};
    energies.struct_size = sizeof energies;
    fascia_skinning skinning{};
    skinning.struct_size = sizeof skinning;
    const fascia_layer layer = {sizeof layer, FASCIA_COMBINE_MAX, 0.5F, 0, nullptr};
    const float force[3] = {0.0F, 0.0F, 0.1F};
    std::vector<float> numbers(12 * static_cast<size_t>(side * side));
    const std::vector<float> slopes(numbers.size(), 0.1F);
    const float* const slopes_by_mesh[] = {slopes.data()};
    std::vector<uint8_t> state;
    size_t size = 0;
    int refusals = 0;
    const auto count = [&](fascia_result result) { refusals += result == FASCIA_ERROR_MEMORY; };
    const int64_t made = host.made;
    if (refused >= 0) host.refuse_after(refused, alone);
    count(fascia_face_set(face, "zygomaticus_major_left", 0.6F));
    count(fascia_face_set_layer(face, 1, &layer));
    count(fascia_face_layer_set(face, 1, "jaw_open", 0.4F));
    count(fascia_face_layer_set_member(face, 1, 0, 1, 0.2F));
    count(fascia_face_touch(face, 0, 100, force));
    count(fascia_face_pose(face));
    count(fascia_face_energies(face, &energies));
    count(fascia_face_node_forces(face, numbers.data(), numbers.size()));
    count(fascia_face_fibre_forces(face, numbers.data(), numbers.size()));
    count(fascia_face_gradient(face, slopes_by_mesh, numbers.data()));
    count(fascia_face_member_gradient(face, 0, numbers.data(), numbers.data() + 100));
    count(fascia_face_positions(face, 0, &vectors));
    count(fascia_face_normals(face, 0, &vectors));
    count(fascia_face_tangents(face, 0, &vectors));
    count(fascia_face_compression(face, 0, &vectors));
    count(fascia_face_fibre_points(face, &vectors));
    count(fascia_face_nodes(face, &vectors));
    count(fascia_face_skinning(face, 0, &skinning));
    count(fascia_face_write_node_texture(face, 0, numbers.data(), numbers.size() / 4));
    count(fascia_faces_step(&face, 1, 1.0F / 60.0F, nullptr));
    count(fascia_face_set_level(face, 0, 0.1F));
    count(fascia_face_save(face, nullptr, 0, &size));
    count(fascia_face_layer_remove(face, 1));
    host.refuse_no_more();
    all = host.made - made;
    EXPECT_GE(refusals, refused >= 0 ? 1 : 0) << refused << " of " << all;
    EXPECT_EQ(fascia_face_pose(face), FASCIA_OK) << fascia_last_message();
    EXPECT_EQ(fascia_face_step(face, 1.0F / 60.0F), FASCIA_OK) << fascia_last_message();
    for (const float number : own.positions())
      EXPECT_TRUE(std::isfinite(number)) << refused;
  };
  ask(-1, false);  // models that the asset keeps
  ask(-1, false);
  const int64_t asked = all, stride = std::max<int64_t>(1, asked / 50), kept = host.live;
  ASSERT_GT(asked, 20);
  for (const bool alone : {true, false})
    for (int64_t nth = 0; nth < asked; nth += stride) {
      ask(nth, alone);
      ASSERT_EQ(host.live, kept) << nth << " of " << asked;
    }
  EXPECT_GE(kept, before);
}

}  // namespace
