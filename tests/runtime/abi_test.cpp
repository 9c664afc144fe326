#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "fascia/fascia.h"
#include "tests/rig/tiny_rig.h"

namespace {

constexpr uint32_t side = 17;

struct Loaded {
  explicit Loaded(const std::vector<uint8_t>& bytes = fascia::test::tiny_rig_file()) {
    EXPECT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK) << fascia_last_message();
  }
  ~Loaded() { fascia_asset_release(asset); }
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;
  fascia_asset* asset = nullptr;
};

struct Face {
  explicit Face(fascia_asset* asset, fascia_space space = FASCIA_SPACE_METRES) {
    fascia_face_options options = fascia_default_face_options();
    options.space = space;
    EXPECT_EQ(fascia_face_create(asset, &options, &face), FASCIA_OK) << fascia_last_message();
  }
  ~Face() { fascia_face_release(face); }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;

  std::vector<float> positions() const {
    fascia_vectors vectors = {};
    vectors.struct_size = sizeof vectors;
    EXPECT_EQ(fascia_face_positions(face, 0, &vectors), FASCIA_OK) << fascia_last_message();
    return {vectors.data, vectors.data + 3 * vectors.count};
  }
  std::vector<float> normals() const {
    fascia_vectors vectors = {};
    vectors.struct_size = sizeof vectors;
    EXPECT_EQ(fascia_face_normals(face, 0, &vectors), FASCIA_OK) << fascia_last_message();
    return {vectors.data, vectors.data + 3 * vectors.count};
  }
  fascia_face* face = nullptr;
};

double largest_motion(const std::vector<float>& a, const std::vector<float>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(a[i]) - b[i]));
  return most;
}

/// Coordinate `axis` of the vertex where the left strap inserts, 2 columns left of the middle.
float left_corner(const std::vector<float>& positions, int axis, int direction = 1) {
  const int vertex = (side / 2) * static_cast<int>(side) + side / 2 + direction * 2;
  return positions[static_cast<std::size_t>(3 * vertex + axis)];
}

TEST(Asset, SaysWhatIsInTheRig) {
  const Loaded rig;
  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_OK);
  EXPECT_EQ(info.level_count, 1U);
  EXPECT_EQ(info.mesh_count, 1U);
  EXPECT_EQ(info.muscle_count, 2U);
  EXPECT_FLOAT_EQ(info.input_to_metres[0], 0.01F);
  fascia_channels channels = {};
  channels.struct_size = sizeof channels;
  ASSERT_EQ(fascia_asset_get_channels(rig.asset, &channels), FASCIA_OK);
  ASSERT_EQ(channels.count, info.channel_count);
  EXPECT_STREQ(channels.names[2], "jaw_open");
  EXPECT_STREQ(channels.groups[0], "muscle");
  EXPECT_EQ(channels.minimum[3], -1.0F);
  fascia_set_info set = {};
  set.struct_size = sizeof set;
  ASSERT_EQ(fascia_asset_get_set(rig.asset, 0, &set), FASCIA_OK);
  EXPECT_STREQ(set.name, "arkit");
  EXPECT_STREQ(set.members[2], "jawOpen");
  fascia_mesh_info mesh = {};
  mesh.struct_size = sizeof mesh;
  ASSERT_EQ(fascia_asset_get_mesh(rig.asset, 0, &mesh), FASCIA_OK);
  EXPECT_STREQ(mesh.part, "skin");
  EXPECT_STREQ(mesh.name, "face");
  EXPECT_EQ(mesh.vertex_count, side * side);
  EXPECT_EQ(mesh.triangle_count, 2 * (side - 1) * (side - 1));
  fascia_surface surface = {};
  surface.struct_size = sizeof surface;
  ASSERT_EQ(fascia_asset_surface(rig.asset, "cranium", &surface), FASCIA_OK);
  EXPECT_EQ(surface.vertex_count, side * side);
  EXPECT_EQ(fascia_asset_surface(rig.asset, "nose", &surface), FASCIA_ERROR_NAME);
  fascia_fibres fibres = {};
  fibres.struct_size = sizeof fibres;
  ASSERT_EQ(fascia_asset_fibres(rig.asset, 0, &fibres), FASCIA_OK);
  EXPECT_EQ(fibres.fibre_count, 6U);
  EXPECT_EQ(fibres.offsets[6], fibres.point_count);
  EXPECT_STREQ(fibres.muscles[5], "zygomaticus_major_right");
  EXPECT_EQ(fascia_asset_find_channel(rig.asset, "JAW_Open"), 2);
  EXPECT_EQ(fascia_asset_find_channel(rig.asset, "jaw"), -1);
}

TEST(Asset, ASmallerStructureIsFilledAsFarAsItGoes) {
  const Loaded rig;
  fascia_asset_info info;
  std::memset(&info, 0x5A, sizeof info);
  info.struct_size = offsetof(fascia_asset_info, channel_count);
  ASSERT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_OK);
  EXPECT_EQ(info.mesh_count, 1U);
  EXPECT_EQ(info.channel_count, 0x5A5A5A5AU);
  info.struct_size = 0;
  EXPECT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_ERROR_ARGUMENT);
}

TEST(Asset, ResultsTellFaultsApart) {
  fascia_asset* asset = nullptr;
  std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  EXPECT_EQ(fascia_asset_load(nullptr, 0, &asset), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_asset_load(bytes.data(), bytes.size() / 2, &asset), FASCIA_ERROR_FORMAT);
  std::vector<uint8_t> moved = bytes;
  const std::vector<uint8_t> head = fascia::test::tiny_head().bin;
  const auto at = std::search(moved.begin(), moved.end(), head.begin(), head.end());
  ASSERT_NE(at, moved.end());
  *at ^= 1;
  EXPECT_EQ(fascia_asset_load(moved.data(), moved.size(), &asset), FASCIA_ERROR_MISMATCH);
  std::string text(bytes.begin(), bytes.end());
  text.replace(text.find("\"specVersion\":\"1.0\""), 19, "\"specVersion\":\"9.0\"");
  EXPECT_EQ(fascia_asset_load(text.data(), text.size(), &asset), FASCIA_ERROR_VERSION);
  EXPECT_NE(std::string(fascia_last_message()).find("9.0"), std::string::npos);
  EXPECT_EQ(asset, nullptr);
}

/// Result of loading the tiny rig with something changed, and of making a face when that went well.
template <class Change>
fascia_result outcome_with(const Change& change) {
  fascia::rig::Rig rig = fascia::test::tiny_rig();
  change(rig);
  const std::vector<uint8_t> bytes = fascia::rig::write(fascia::test::tiny_head(), rig);
  fascia_asset* asset = nullptr;
  const fascia_result loaded = fascia_asset_load(bytes.data(), bytes.size(), &asset);
  if (loaded != FASCIA_OK) return loaded;
  fascia_face* face = nullptr;
  const fascia_result made = fascia_face_create(asset, nullptr, &face);
  fascia_face_release(face);
  fascia_asset_release(asset);
  return made;
}

TEST(Asset, WhatCannotBeSimulatedIsRefusedWithItsPlace) {
  EXPECT_EQ(outcome_with([](auto&) {}), FASCIA_OK);
  const auto says = [](const char* what) {
    return std::string(fascia_last_message()).find(what) != std::string::npos;
  };
  EXPECT_EQ(outcome_with([](auto& rig) { rig.tissue.levels[0].spring_stiffness[7] = 1e30F; }),
            FASCIA_ERROR_FORMAT);
  EXPECT_TRUE(says("FASCIA_tissue/levels/0") && says("spring")) << fascia_last_message();
  EXPECT_EQ(outcome_with([](auto& rig) {
              for (auto& place : rig.tissue.levels[0].rest)
                place.z() += 2e4F;
            }),
            FASCIA_ERROR_FORMAT);
  EXPECT_TRUE(says("kilometre")) << fascia_last_message();
  EXPECT_EQ(outcome_with([](auto& rig) { rig.skull.jaw.open_angle = 1e20F; }), FASCIA_ERROR_FORMAT);
  EXPECT_TRUE(says("FASCIA_skull/jaw")) << fascia_last_message();
}

TEST(FaceTest, AtRestNothingMovesInAnySpace) {
  const Loaded rig;
  for (const fascia_space space : {FASCIA_SPACE_MESH, FASCIA_SPACE_INPUT, FASCIA_SPACE_METRES}) {
    const Face face(rig.asset, space);
    const std::vector<float> before = face.positions();
    ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
    EXPECT_EQ(before, face.positions());
    for (int i = 0; i < 20; ++i)
      ASSERT_EQ(fascia_face_step(face.face, 1.0F / 60.0F), FASCIA_OK);
    EXPECT_EQ(before, face.positions());
  }
}

TEST(FaceTest, MeshSpaceIsTheFilesOwn) {
  const Loaded rig;
  const Face mesh(rig.asset, FASCIA_SPACE_MESH), input(rig.asset, FASCIA_SPACE_INPUT), metres(rig.asset);
  const std::vector<uint8_t> bin = fascia::test::tiny_head().bin;
  const std::vector<float> positions = mesh.positions();
  EXPECT_EQ(0, std::memcmp(positions.data(), bin.data(), positions.size() * 4));
  // The node stands 160 cm up; the rig is in metres.
  EXPECT_NEAR(input.positions()[1], positions[1] + 160.0F, 1e-3);
  EXPECT_NEAR(metres.positions()[1], 0.01F * positions[1] + 1.6F, 1e-5);
}

TEST(FaceTest, AMusclePullsItsSideUpAndOut) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> rest = face.positions();
  ASSERT_EQ(fascia_face_set(face.face, "Zygomaticus_Major_Left", 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  const std::vector<float> posed = face.positions();
  EXPECT_GT(left_corner(posed, 0) - left_corner(rest, 0), 1e-4F);
  EXPECT_GT(left_corner(posed, 1) - left_corner(rest, 1), 1e-4F);
  const float other = left_corner(posed, 1, -1) - left_corner(rest, 1, -1);
  EXPECT_LT(std::abs(other), 0.4F * (left_corner(posed, 1) - left_corner(rest, 1)));
  // The same motion in the mesh's centimetres.
  const Face centimetres(rig.asset, FASCIA_SPACE_MESH);
  const std::vector<float> cm_rest = centimetres.positions();
  fascia_face_values(centimetres.face)[0] = 1.0F;
  ASSERT_EQ(fascia_face_pose(centimetres.face), FASCIA_OK);
  EXPECT_NEAR(left_corner(centimetres.positions(), 1) - left_corner(cm_rest, 1),
              100.0F * (left_corner(posed, 1) - left_corner(rest, 1)), 2e-3F);
}

TEST(FaceTest, MembersAddUpAndAreClamped) {
  const Loaded rig;
  const Face face(rig.asset);
  ASSERT_EQ(fascia_face_set(face.face, "arkit:MOUTHsmileLeft", 0.5F), FASCIA_OK);
  ASSERT_EQ(fascia_face_set(face.face, "au:12", 0.25F), FASCIA_OK);
  ASSERT_EQ(fascia_face_set(face.face, "mouthSmileRight", 9.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_set(face.face, "zygomaticus_major_left", 0.1F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  const float* effective = fascia_face_effective_values(face.face);
  EXPECT_NEAR(effective[0], 0.1F + 0.9F * 0.5F + 0.8F * 0.25F, 1e-6F);
  EXPECT_EQ(effective[1], 1.0F);
  float value = 0;
  ASSERT_EQ(fascia_face_get(face.face, "au:12", &value), FASCIA_OK);
  EXPECT_EQ(value, 0.25F);
  EXPECT_EQ(fascia_face_set(face.face, "arkit:noseGrow", 1), FASCIA_ERROR_NAME);
  EXPECT_NE(std::string(fascia_last_message()).find("noseGrow"), std::string::npos);
  EXPECT_EQ(fascia_face_set(face.face, "au:12", NAN), FASCIA_ERROR_ARGUMENT);
  ASSERT_EQ(fascia_face_clear(face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_EQ(fascia_face_effective_values(face.face)[0], 0.0F);
}

TEST(FaceTest, TimeArrivesAtThePose) {
  const Loaded rig;
  const Face still(rig.asset), moving(rig.asset);
  const std::vector<float> rest = still.positions();
  fascia_face_values(still.face)[0] = fascia_face_values(moving.face)[0] = 0.7F;
  ASSERT_EQ(fascia_face_pose(still.face), FASCIA_OK);
  for (int i = 0; i < 180; ++i)
    ASSERT_EQ(fascia_face_step(moving.face, 1.0F / 60.0F), FASCIA_OK) << fascia_last_message();
  const double motion = largest_motion(rest, still.positions());
  EXPECT_GT(motion, 3e-4);
  EXPECT_LT(largest_motion(moving.positions(), still.positions()), 0.05 * motion);
  // Back to rest at once.
  fascia_face_clear(moving.face);
  ASSERT_EQ(fascia_face_reset(moving.face), FASCIA_OK);
  EXPECT_EQ(moving.positions(), rest);
  EXPECT_EQ(fascia_face_step(moving.face, -1.0F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_step(moving.face, NAN), FASCIA_ERROR_ARGUMENT);
}

TEST(FaceTest, ValuesThatAreNoNumbersDoNoHarm) {
  const Loaded rig;
  const Face face(rig.asset);
  float* values = fascia_face_values(face.face);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30F}) {
    for (int c = 0; c < 5; ++c)
      values[c] = bad;
    for (int i = 0; i < 5; ++i)
      fascia_face_step(face.face, 1.0F / 30.0F);
    for (const float coordinate : face.positions())
      ASSERT_TRUE(std::isfinite(coordinate));
  }
}

TEST(FaceTest, NormalsAreUnitAndFollow) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> rest = face.normals();
  for (std::size_t v = 0; v < rest.size(); v += 3) {
    EXPECT_NEAR(rest[v] * rest[v] + rest[v + 1] * rest[v + 1] + rest[v + 2] * rest[v + 2], 1.0F, 1e-4F);
    EXPECT_GT(rest[v + 2], 0.2F);  // the patch looks along +Z
  }
  fascia_face_values(face.face)[0] = 1.0F;
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_GT(largest_motion(rest, face.normals()), 1e-3);
  fascia_face_clear(face.face);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_LT(largest_motion(rest, face.normals()), 1e-3);
}

TEST(FaceTest, TheJawTurnsDown) {
  const Loaded rig;
  const Face face(rig.asset);
  float matrix[16] = {};
  ASSERT_EQ(fascia_face_jaw(face.face, matrix), FASCIA_OK);
  EXPECT_EQ(matrix[0], 1.0F);
  EXPECT_EQ(matrix[13], 0.0F);
  const std::vector<float> rest = face.positions();
  ASSERT_EQ(fascia_face_set(face.face, "jaw_open", 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_jaw(face.face, matrix), FASCIA_OK);
  // The chin point (0, 1.53, 0.07) goes down.
  EXPECT_LT(matrix[5] * 1.53F + matrix[9] * 0.07F + matrix[13], 1.52F);
}

TEST(FaceTest, WritesIntoTheHostsMemory) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> positions = face.positions();
  struct Vertex {
    float colour[4];
    float position[3];
  };
  std::vector<Vertex> vertices(side * side);
  ASSERT_EQ(fascia_face_write_positions(face.face, 0, vertices[0].position, sizeof(Vertex), vertices.size()),
            FASCIA_OK);
  EXPECT_EQ(vertices[5].position[1], positions[16]);
  EXPECT_EQ(vertices[5].colour[0], 0.0F);
  EXPECT_EQ(fascia_face_write_positions(face.face, 0, vertices.data(), sizeof(Vertex), 5),
            FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_write_positions(face.face, 1, vertices.data(), sizeof(Vertex), 500),
            FASCIA_ERROR_ARGUMENT);
}

TEST(FaceTest, TheAssetMayGoFirst) {
  auto rig = std::make_unique<Loaded>();
  const Face face(rig->asset);
  rig.reset();
  fascia_face_values(face.face)[0] = 0.5F;
  EXPECT_EQ(fascia_face_pose(face.face), FASCIA_OK);
}

TEST(FaceTest, FacesInParallelDoTheSameAsOneByOne) {
  const Loaded rig;
  const auto run = [&](float value, std::vector<float>& result) {
    const Face face(rig.asset);
    fascia_face_values(face.face)[0] = value;
    for (int i = 0; i < 10; ++i)
      fascia_face_step(face.face, 1.0F / 60.0F);
    result = face.positions();
  };
  std::vector<float> alone[2], together[2];
  run(0.3F, alone[0]);
  run(0.9F, alone[1]);
  std::thread first([&] { run(0.3F, together[0]); }), second([&] { run(0.9F, together[1]); });
  first.join();
  second.join();
  EXPECT_EQ(alone[0], together[0]);
  EXPECT_EQ(alone[1], together[1]);
}

/// The Bullet module is loaded when asked for; where it is not built, asking says so.
/// Tasks of a host with one thread a range, cut as it likes.
struct Threads {
  uint32_t range = 2;
  int begun = 0, finished = 0;
  static void* begin(fascia_task_range run, uint32_t count, uint32_t least, void* context, void* user) {
    auto* self = static_cast<Threads*>(user);
    ++self->begun;
    auto* threads = new std::vector<std::thread>;
    for (uint32_t first = 0; first < count; first += std::max(least, self->range))
      threads->emplace_back(run, first, std::min(count, first + std::max(least, self->range)), context);
    return threads;
  }
  static void finish(void* task, void* user) {
    auto* threads = static_cast<std::vector<std::thread>*>(task);
    for (std::thread& thread : *threads)
      thread.join();
    delete threads;
    ++static_cast<Threads*>(user)->finished;
  }
};

TEST(FaceTest, ACrowdThroughTheHostsTasksIsEachFaceAlone) {
  const Loaded rig;
  constexpr uint32_t count = 7;
  const auto run = [&](int way) {
    std::vector<std::unique_ptr<Face>> faces;
    std::vector<fascia_face*> handles;
    for (uint32_t i = 0; i < count; ++i) {
      faces.push_back(std::make_unique<Face>(rig.asset));
      handles.push_back(faces.back()->face);
      fascia_face_values(handles.back())[0] = 0.1F * static_cast<float>(i);
    }
    Threads host;
    const fascia_tasks tasks{sizeof(fascia_tasks), 0, Threads::begin, Threads::finish, &host};
    for (int frame = 0; frame < 5; ++frame) {
      if (way == 0)
        for (fascia_face* face : handles)
          EXPECT_EQ(fascia_face_step(face, 1.0F / 60.0F), FASCIA_OK);
      else
        EXPECT_EQ(fascia_faces_step(handles.data(), count, 1.0F / 60.0F, way == 1 ? nullptr : &tasks),
                  FASCIA_OK);
    }
    EXPECT_EQ(host.begun, way == 2 ? 5 : 0);
    EXPECT_EQ(host.finished, host.begun);
    std::vector<std::vector<float>> positions;
    for (const auto& face : faces)
      positions.push_back(face->positions());
    return positions;
  };
  const auto alone = run(0);
  EXPECT_NE(alone[1], alone[6]);
  EXPECT_EQ(run(1), alone);
  EXPECT_EQ(run(2), alone);
}

TEST(FaceTest, ACrowdsFaultsAreToldApart) {
  const Loaded rig;
  const Face face(rig.asset);
  fascia_face* twice[2] = {face.face, face.face};
  EXPECT_EQ(fascia_faces_step(twice, 2, 0.1F, nullptr), FASCIA_ERROR_ARGUMENT);
  EXPECT_STREQ(fascia_last_message(), "a face is listed twice");
  fascia_face* with_null[2] = {face.face, nullptr};
  EXPECT_EQ(fascia_faces_step(with_null, 2, 0.1F, nullptr), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_faces_step(twice, 1, -1.0F, nullptr), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_faces_step(nullptr, 1, 0.1F, nullptr), FASCIA_ERROR_ARGUMENT);
  const fascia_tasks none{sizeof(fascia_tasks), 0, nullptr, nullptr, nullptr};
  EXPECT_EQ(fascia_faces_step(twice, 1, 0.1F, &none), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_faces_step(nullptr, 0, 0.1F, nullptr), FASCIA_OK);
}

TEST(FaceTest, APointerOnceTakenKeepsUpWithTheFace) {
  const Loaded rig;
  const Face face(rig.asset);
  fascia_vectors taken{};
  taken.struct_size = sizeof taken;
  ASSERT_EQ(fascia_face_positions(face.face, 0, &taken), FASCIA_OK);
  const std::vector<float> before(taken.data, taken.data + 3 * taken.count);
  fascia_face_values(face.face)[0] = 0.8F;
  fascia_face_pose(face.face);
  EXPECT_NE(std::vector<float>(taken.data, taken.data + 3 * taken.count), before);
  EXPECT_EQ(std::vector<float>(taken.data, taken.data + 3 * taken.count), face.positions());
}

TEST(FaceTest, BulletIsLoadedOnDemand) {
  const Loaded rig;
  fascia_face* face = nullptr;
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  options.solver = FASCIA_SOLVER_BULLET;
  const fascia_result result = fascia_face_create(rig.asset, &options, &face);
  if (result != FASCIA_OK) {
    EXPECT_EQ(result, FASCIA_ERROR_MODULE);
    EXPECT_NE(std::string(fascia_last_message()).find("libfascia_bullet"), std::string::npos);
    GTEST_SKIP() << fascia_last_message();
  }
  fascia_vectors positions = {};
  positions.struct_size = sizeof positions;
  ASSERT_EQ(fascia_face_positions(face, 0, &positions), FASCIA_OK);
  const std::vector<float> rest(positions.data, positions.data + 3 * positions.count);
  fascia_face_values(face)[0] = 0.5F;
  for (int i = 0; i < 10; ++i)
    ASSERT_EQ(fascia_face_step(face, 1.0F / 60.0F), FASCIA_OK) << fascia_last_message();
  EXPECT_GT(largest_motion(rest, {positions.data, positions.data + 3 * positions.count}), 1e-4);
  fascia_face_release(face);
}

TEST(FaceTest, UnknownChoicesAreRefused) {
  const Loaded rig;
  fascia_face* face = nullptr;
  fascia_face_options options = fascia_default_face_options();
  options.level = 4;
  EXPECT_EQ(fascia_face_create(rig.asset, &options, &face), FASCIA_ERROR_ARGUMENT);
  options.level = 0;
  options.space = static_cast<fascia_space>(9);
  EXPECT_EQ(fascia_face_create(rig.asset, &options, &face), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(face, nullptr);
}

TEST(CurvesTest, DriveAFaceAndAddUp) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::string csv = "time,zygomaticus_major_left,jawOpen,HeadYaw\n0,0,0,0\n1,0.8,1,0.2\n";
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(csv.data(), csv.size(), &curves), FASCIA_OK) << fascia_last_message();
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(fascia_curves_get_info(curves, &info), FASCIA_OK);
  EXPECT_EQ(info.count, 3U);
  EXPECT_EQ(info.duration, 1.0);
  uint32_t count = 0;
  uint8_t matched[3] = {};
  ASSERT_EQ(fascia_curves_match(curves, rig.asset, &count, matched), FASCIA_OK);
  EXPECT_EQ(count, 2U);
  EXPECT_EQ(matched[2], 0);
  ASSERT_EQ(fascia_curves_apply(curves, 0.5, 1.0F, face.face), FASCIA_OK);
  ASSERT_EQ(fascia_curves_apply(curves, 1.0, 0.25F, face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  const float* effective = fascia_face_effective_values(face.face);
  EXPECT_NEAR(effective[0], 0.4F + 0.25F * 0.8F, 1e-6F);
  EXPECT_NEAR(effective[2], 0.5F + 0.25F, 1e-6F);
  // Used up by the step.
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_EQ(effective[0], 0.0F);
  fascia_curves_release(curves);
}

TEST(CurvesTest, TheRigsOwnAnimationPlays) {
  const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  const Loaded rig(bytes);
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(bytes.data(), bytes.size(), &curves), FASCIA_OK) << fascia_last_message();
  const Face face(rig.asset);
  ASSERT_EQ(fascia_curves_apply(curves, 0.5, 1.0F, face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_NEAR(fascia_face_effective_values(face.face)[0], 0.4F, 1e-6F);
  fascia_curves_release(curves);
}

TEST(Log, HearsEveryFailure) {
  std::vector<std::string> heard;
  fascia_set_log(
      [](void* user, fascia_result, const char* message) {
        static_cast<std::vector<std::string>*>(user)->push_back(message);
      },
      &heard);
  fascia_asset* asset = nullptr;
  fascia_asset_load("nothing", 7, &asset);
  fascia_set_log(nullptr, nullptr);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0], fascia_last_message());
}

}  // namespace
