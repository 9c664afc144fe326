#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

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

TEST(FaceTest, CrowdsRejectInvalidArguments) {
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

/// The Bullet module is loaded when asked for; where it is not built, asking says so.
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

}  // namespace
