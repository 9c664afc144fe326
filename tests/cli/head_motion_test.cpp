// The turn of the head as motion of a file's nodes.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "cli/take/head_motion.h"

namespace fascia::cli {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// A second in which the head turns to a yaw of half a radian, to the subject's left.
class HeadMotion : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::temp_directory_path() / ("fascia_head_" + std::to_string(getpid()) + ".csv");
    std::ofstream(file_) << "time,jawOpen,HeadYaw\n0,0,0\n1,0,0.5\n";
    curves_ = std::make_unique<Curves>(file_);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::vector<NodeMotion> moved(Json& gltf, const Eigen::Matrix3d& to_rig = Eigen::Matrix3d::Identity()) {
    return head_motion(gltf, Take{*curves_, 30.0}, {0}, to_rig, pivot);
  }
  static Quaterniond last_rotation(const NodeMotion& motion) {
    const float* q = &motion.rotations[motion.rotations.size() - 4];
    return {static_cast<double>(q[3]), static_cast<double>(q[0]), static_cast<double>(q[1]),
            static_cast<double>(q[2])};
  }
  static Vector3d last_translation(const NodeMotion& motion) {
    const float* t = &motion.translations[motion.translations.size() - 3];
    return {static_cast<double>(t[0]), static_cast<double>(t[1]), static_cast<double>(t[2])};
  }
  static void expect_turn(const Quaterniond& turn, const Vector3d& axis, double angle) {
    const Quaterniond expected(Eigen::AngleAxisd(angle, axis));
    EXPECT_LT(turn.angularDistance(expected), 1e-5) << turn.coeffs().transpose();
  }

  const Vector3d pivot{0.0, 1.6, 0.02};
  std::filesystem::path file_;
  std::unique_ptr<Curves> curves_;
};

TEST_F(HeadMotion, ARootTurnsAboutThePivot) {
  Json gltf =
      Json::parse(R"({"nodes":[{"children":[1],"translation":[0.1,0.2,0.3]},{"mesh":0},{"mesh":1}]})");
  const std::vector<NodeMotion> motions = moved(gltf);
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].node, 0U);
  EXPECT_EQ(motions[0].keys.front(), 0U);
  EXPECT_EQ(motions[0].keys.back(), 30U);
  const Quaterniond turn = last_rotation(motions[0]);
  expect_turn(turn, Vector3d::UnitY(), 0.5);
  // What is at the pivot stays there: the root has it at `pivot` less its own translation.
  const Vector3d there = turn * (pivot - Vector3d(0.1, 0.2, 0.3)) + last_translation(motions[0]);
  EXPECT_LT((there - pivot).norm(), 1e-5);
  EXPECT_EQ(motions[0].rotations[3], 1.0F);  // it begins straight ahead
}

TEST_F(HeadMotion, AMatrixIsWrittenAsWhatAnimationMayMove) {
  // A quarter turn about Z with a scale of 2, by columns.
  Json gltf = Json::parse(R"({"nodes":[{"mesh":0,"matrix":[0,2,0,0, -2,0,0,0, 0,0,2,0, 5,6,7,1]}]})");
  const std::vector<NodeMotion> motions = moved(gltf);
  const Json& node = gltf["nodes"][0];
  EXPECT_FALSE(node.contains("matrix"));
  EXPECT_EQ(node["scale"], Json({2.0, 2.0, 2.0}));
  EXPECT_EQ(node["translation"], Json({5.0, 6.0, 7.0}));
  EXPECT_NEAR(node["rotation"][2].get<double>(), std::sqrt(0.5), 1e-12);
  const Quaterniond rest(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()));
  expect_turn(last_rotation(motions[0]) * rest.conjugate(), Vector3d::UnitY(), 0.5);
}

TEST_F(HeadMotion, AxesOfAFileThatIsUprightInZAreKept) {
  // The file's Z is the rig's Y, its Y the rig's -Z.
  Eigen::Matrix3d to_rig;
  to_rig << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Json gltf = Json::parse(R"({"nodes":[{"mesh":0}]})");
  expect_turn(last_rotation(moved(gltf, to_rig)[0]), Vector3d::UnitZ(), 0.5);
}

TEST_F(HeadMotion, TheHeadsJointTurnsInItsParentsFrame) {
  // The neck lies on its side: a turn about the world's Y is one about another axis in it.
  Json gltf = Json::parse(R"({
    "nodes": [{"mesh": 0, "skin": 0}, {"name": "Neck", "children": [2], "rotation": [0.5, 0.5, 0.5, 0.5]},
              {"name": "mixamorig:Head", "rotation": [0, 0, 0.6, 0.8]}],
    "skins": [{"joints": [1, 2]}]})");
  const std::vector<NodeMotion> motions = moved(gltf);
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].node, 2U);
  EXPECT_TRUE(motions[0].translations.empty());
  const Quaterniond neck(0.5, 0.5, 0.5, 0.5), rest(0.8, 0, 0, 0.6);
  expect_turn(neck * last_rotation(motions[0]) * (neck * rest).conjugate(), Vector3d::UnitY(), 0.5);
}

}  // namespace
}  // namespace fascia::cli
