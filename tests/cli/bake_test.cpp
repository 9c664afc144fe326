// What `bake` writes, in each of its formats, against the pose of the same shape.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "builder/rigging/embedded_head.h"
#include "formats/scene.h"
#include "gltf/read/accessors.h"
#include "gltf/read/model.h"
#include "tests/cli/tool.h"

namespace fascia::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Bake : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new fs::path(fs::temp_directory_path() / ("fascia_bake_test_" + std::to_string(getpid())));
    fs::create_directories(*folder);
    rigging::write_embedded_head(at("head.obj"), at("landmarks.json"));
    run("build " + at("head.obj") + " --landmarks " + at("landmarks.json") + " --detail low -o " +
        at("rig.glb"));
  }
  static void TearDownTestSuite() {
    fs::remove_all(*folder);
    delete folder;
  }
  static std::string at(const std::string& name) { return (*folder / name).string(); }
  static Outcome run(const std::string& arguments) {
    Outcome outcome = run_tool(*folder, arguments);
    EXPECT_EQ(outcome.code, 0) << arguments << "\n" << outcome.err;
    return outcome;
  }
  static tinygltf::Model model(const std::string& name) {
    return gltf::load_model(formats::read_bytes(at(name)), name);
  }
  static std::vector<float> positions(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    return gltf::decode_floats(model, primitive.attributes.at("POSITION"), "test");
  }
  /// Of mesh `m`, the number of the target called `name`; -1 without one.
  static int target(const tinygltf::Model& model, size_t m, const std::string& name) {
    const tinygltf::Value& names = model.meshes[m].extras.Get("targetNames");
    for (int t = 0; t < static_cast<int>(names.ArrayLen()); ++t)
      if (names.Get(t).Get<std::string>() == name) return t;
    return -1;
  }
  /// The vertices of an OBJ in their order.
  static std::vector<float> vertices(const std::string& name) {
    std::vector<float> numbers;
    std::istringstream lines(text_of(at(name)));
    for (std::string line; std::getline(lines, line);) {
      float x = 0, y = 0, z = 0;
      if (std::sscanf(line.c_str(), "v %f %f %f", &x, &y, &z) == 3) numbers.insert(numbers.end(), {x, y, z});
    }
    return numbers;
  }
  /// The largest difference between what the targets `names` of `baked`, all at 1, make of its meshes and
  /// the meshes of `posed`; in the file's unit.
  static float difference(const tinygltf::Model& baked, const std::vector<std::string>& names,
                          const tinygltf::Model& posed) {
    float most = 0.0F;
    EXPECT_EQ(baked.meshes.size(), posed.meshes.size());
    for (size_t m = 0; m < baked.meshes.size(); ++m)
      for (size_t p = 0; p < baked.meshes[m].primitives.size(); ++p) {
        const tinygltf::Primitive& primitive = baked.meshes[m].primitives[p];
        std::vector<float> made = positions(baked, primitive);
        for (const std::string& name : names) {
          const int t = target(baked, m, name);
          if (t < 0) continue;
          const std::vector<float> moved =
              gltf::decode_floats(baked, primitive.targets[static_cast<size_t>(t)].at("POSITION"), "test");
          for (size_t i = 0; i < made.size(); ++i)
            made[i] += moved[i];
        }
        const std::vector<float> wanted = positions(posed, posed.meshes[m].primitives[p]);
        EXPECT_EQ(made.size(), wanted.size());
        for (size_t i = 0; i < std::min(made.size(), wanted.size()); ++i)
          most = std::max(most, std::abs(made[i] - wanted[i]));
      }
    return most;
  }

  static fs::path* folder;
};

fs::path* Bake::folder = nullptr;

TEST_F(Bake, TargetsAreThePoses) {
  run("bake " + at("rig.glb") + " --shapes arkit,visemes --correctives -o " + at("shapes.glb"));
  const tinygltf::Model baked = model("shapes.glb");
  EXPECT_TRUE(baked.extensions.find("FASCIA_tissue") == baked.extensions.end());
  const auto pose = [](const std::string& sets) {
    run("pose " + at("rig.glb") + " " + sets + " -o " + at("pose.glb"));
    return model("pose.glb");
  };
  constexpr float rounding = 2e-5F;  // of coordinates beyond 100
  EXPECT_LT(difference(baked, {"jawOpen"}, pose("--set arkit:jawOpen=1")), rounding);
  EXPECT_LT(difference(baked, {"viseme_PP"}, pose("--set viseme:PP=1")), rounding);
  // A corrective is what the sum of two shapes lacks of the two together; without it they are millimetres
  // off.
  const tinygltf::Model both = pose("--set arkit:jawOpen=1 --set arkit:mouthFunnel=1");
  EXPECT_LT(difference(baked, {"jawOpen", "mouthFunnel", "jawOpen_mouthFunnel"}, both), rounding);
  EXPECT_GT(difference(baked, {"jawOpen", "mouthFunnel"}, both), 0.05F);
}

TEST_F(Bake, ASequenceIsAnObjAShapeLikeThePosesOwn) {
  run("bake " + at("rig.glb") + " --shapes visemes --format obj-sequence -o " + at("sequence"));
  for (const char* name : {"PP", "aa"}) {
    run("pose " + at("rig.glb") + " --set viseme:" + name + "=1 -o " + at("pose.obj"));
    EXPECT_EQ(text_of(at("sequence/viseme_" + std::string(name) + ".obj")), text_of(at("pose.obj"))) << name;
  }
  EXPECT_EQ(vertices("sequence/rest.obj"), vertices("head.obj"));
}

TEST_F(Bake, ACacheHasTheShapesInTheirOrderBehindTheRest) {
  const json report =
      json::parse(run("bake " + at("rig.glb") + " --shapes visemes --json -o " + at("shapes.pc2")).out);
  const std::vector<std::string> names = report["shapes"];
  for (const bool is_rest : {true, false}) {
    run("pose " + at("rig.glb") + (is_rest ? "" : " --set viseme:" + names[3].substr(7) + "=1") + " -o " +
        at("pose.obj"));
    const std::vector<float> all = vertices("pose.obj");
    // Every object's points are a run of the OBJ's vertices, those that no face uses left out.
    for (const json& file : report["files"]) {
      const std::string bytes = text_of(file.get<std::string>());
      uint32_t points = 0, frames = 0;
      std::memcpy(&points, bytes.data() + 16, 4);
      std::memcpy(&frames, bytes.data() + 28, 4);
      ASSERT_EQ(frames, names.size() + 1);
      std::vector<float> frame(3 * points);
      std::memcpy(frame.data(), bytes.data() + 32 + (is_rest ? 0 : 4) * 12 * points, 12 * points);
      size_t at_vertex = 0;
      for (size_t v = 0; v < points; ++v, ++at_vertex) {
        const auto is_there = [&] {
          for (size_t axis = 0; axis < 3; ++axis)
            if (std::abs(frame[3 * v + axis] - all[3 * at_vertex + axis]) > 2e-5F) return false;
          return true;
        };
        while (3 * at_vertex < all.size() && !is_there())
          ++at_vertex;
        ASSERT_LT(3 * at_vertex, all.size()) << file << ", point " << v << ", at rest " << is_rest;
      }
    }
  }
}

TEST_F(Bake, ReplacedShapesTakeTheRoomOfTheOldOnes) {
  run("bake " + at("rig.glb") + " -o " + at("first.glb"));
  run("build " + at("first.glb") + " --detail low -o " + at("again.glb"));
  run("bake " + at("again.glb") + " --replace -o " + at("replaced.glb"));
  run("bake " + at("again.glb") + " -o " + at("added.glb"));
  const tinygltf::Model first = model("first.glb"), replaced = model("replaced.glb");
  for (size_t m = 0; m < first.meshes.size(); ++m)
    EXPECT_EQ(first.meshes[m].primitives[0].targets.size(), replaced.meshes[m].primitives[0].targets.size());
  run("pose " + at("again.glb") + " --set arkit:mouthPucker=1 -o " + at("pose.glb"));
  EXPECT_LT(difference(replaced, {"mouthPucker"}, model("pose.glb")), 2e-5F);
  EXPECT_LT(fs::file_size(at("replaced.glb")), 1.1 * static_cast<double>(fs::file_size(at("first.glb"))));
  EXPECT_GT(fs::file_size(at("added.glb")), 1.5 * static_cast<double>(fs::file_size(at("first.glb"))));
}

}  // namespace
}  // namespace fascia::cli
