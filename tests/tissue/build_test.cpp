#include "builder/tissue/build.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "anatomy/anatomy.h"
#include "builder/tissue/region.h"
#include "formats/scene.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "sim/reference_solver.h"
#include "tests/paths/paths.h"

namespace fascia::tissue {
namespace {

/// A measured head with stand-in bones: its own outer skin, 9 mm deeper, parted at the mouth.
const TissueInputs& measured_head() {
  static const TissueInputs inputs = [] {
    TissueInputs in;
    in.mechanics = anatomy::load_generic().mechanics;
    const std::filesystem::path path = test::measured_data() / "data/ict/neutral.glb";
    if (!std::filesystem::exists(path)) return in;
    const formats::Scene scene = formats::read(path);
    for (const formats::SceneMesh& mesh : scene.meshes) {
      std::string part = "other";
      if (mesh.name == "head") part = "skin";
      if (mesh.name == "eye_left" || mesh.name == "eye_right" || mesh.name == "lashes") part = mesh.name;
      if (mesh.name == "gums_tongue" || mesh.name == "teeth") part = "gums_upper";
      in.parts.push_back({part, mesh.positions, mesh.triangles});
      if (part == "skin") in.skin = weld({mesh.positions, mesh.triangles}, 1e-6, nullptr);
    }
    auto& l = in.landmarks;  // read off the mean head, metres
    const auto pair = [&](const std::string& name, double x, double y, double z) {
      l[name + "_left"] = Vec3(x, y, z);
      l[name + "_right"] = Vec3(-x, y, z);
    };
    pair("tragion", .076, .030, .024);
    pair("exocanthion", .0446, .0343, .0860);
    pair("endocanthion", .0184, .0325, .0920);
    pair("cheilion", .0253, -.0352, .1019);
    l["glabella"] = Vec3(0, .058, .108);
    l["subnasale"] = Vec3(0, -.012, .1157);
    l["pronasale"] = Vec3(0, .004, .1307);
    l["sellion"] = Vec3(0, .0374, .1073);
    l["gnathion"] = Vec3(0, -.0757, .1043);
    const std::vector<Vec3> normals = vertex_normals(in.skin);
    TriangleMesh shrunk = in.skin;
    for (size_t v = 0; v < normals.size(); ++v)
      shrunk.vertices[v] -= 0.009 * normals[v];
    std::vector<bool> upper(shrunk.triangles.size()), lower(upper);
    for (size_t t = 0; t < upper.size(); ++t) {
      const Vec3 p = position(in.skin, {static_cast<int>(t), Vec3::Constant(1.0 / 3.0)});
      const bool bony = (p - Vec3(0, -.035, .09)).norm() > .02;
      lower[t] = bony && p.y() < -.036 && p.y() > -.09 && p.z() > .02;
      upper[t] = bony && p.y() > -.034;
    }
    in.cranium = submesh(shrunk, upper, nullptr);
    in.mandible = submesh(shrunk, lower, nullptr);
    in.jaw.origin = rig::Vec3f(0, .012F, .022F);
    in.eye_left.centre = rig::Vec3f(.0309F, .0361F, .0815F);
    in.eye_right.centre = rig::Vec3f(-.0309F, .0361F, .0815F);
    in.eye_left.radius = in.eye_right.radius = .015F;
    for (const char* name : {"lid_upper_left", "lid_upper_right", "buccal_pressure_left"}) {
      rig::Channel channel;
      channel.name = name;
      in.channels.push_back(channel);
    }
    return in;
  }();
  return inputs;
}

struct Built : ::testing::Test {
  static const TissueResult& low() {
    static const TissueResult result = [] {
      TissueOptions options;
      options.levels = {{"low", 700}};
      options.contact = false;  // the stand-in bones are open shells, which have no inside
      return build(measured_head(), options);
    }();
    return result;
  }
  void SetUp() override {
    if (measured_head().skin.empty()) GTEST_SKIP() << "the measured head is not beside the project";
  }
};

const rig::Binding& skin_binding(const TissueResult& result) {
  for (const rig::Binding& binding : result.tissue.bindings[0])
    if (binding.part == "skin") return binding;
  throw Error("no skin binding");
}

TEST_F(Built, TheLatticeIsSoundAndOfTheSizeAskedFor) {
  const auto& figures = low().figures[0];
  EXPECT_NEAR(figures.nodes / 3, 700, 140);
  EXPECT_EQ(figures.turned_prisms, 0);
  EXPECT_EQ(sim::lattice_fault(sim::lattice_of(low().tissue.levels[0])), nullptr);
}

TEST_F(Built, WeightsAreAPartitionOfUnityInsideAndNothingFarAway) {
  const rig::Binding& binding = skin_binding(low());
  const auto& part = measured_head().parts[0];
  ASSERT_EQ(binding.vertex_count, part.vertices.size());
  size_t full = 0;
  for (size_t v = 0; v < part.vertices.size(); ++v) {
    float sum = binding.jaw_weights[v];
    for (size_t k = 0; k < binding.influences; ++k) {
      EXPECT_GE(binding.weights[v * binding.influences + k], 0.0F);
      sum += binding.weights[v * binding.influences + k];
    }
    EXPECT_LT(sum, 1.0001F);
    full += sum > 0.999F ? 1 : 0;
    const bool far = part.vertices[v].z() < 0.0 || part.vertices[v].y() < -0.14;
    EXPECT_TRUE(!far || sum == 0.0F) << v;
  }
  EXPECT_GT(full, part.vertices.size() / 4);
}

TEST_F(Built, LipsArePartedAndTheJawTakesTheLowerOne) {
  const rig::TissueLevel& level = low().tissue.levels[0];
  const sim::FaceModel model(sim::lattice_of(level), sim::jaw_of(measured_head().jaw));
  ASSERT_TRUE(model.valid()) << model.fault();
  sim::ReferenceSolver face(model, 3);
  std::vector<sim::Vec3f> x(level.rest.size());
  EXPECT_EQ(face.static_pose({}, {}, x).iterations, 0);
  for (size_t i = 0; i < x.size(); ++i)
    EXPECT_EQ(x[i], level.rest[i]);
  const sim::MinimiseResult open = face.static_pose({{}, {1.0F, 0, 0}, sim::Vec3::Zero()}, {}, x);
  EXPECT_LT(open.move, 1e-4) << "metres still wanted after " << open.iterations << " iterations";
  const rig::Binding& binding = skin_binding(low());
  const auto& part = measured_head().parts[0];
  const auto motion = [&](const Vec3& where) {
    size_t best = 0;
    for (size_t v = 0; v < part.vertices.size(); ++v)
      if ((part.vertices[v] - where).norm() < (part.vertices[best] - where).norm()) best = v;
    Vec3 sum = Vec3::Zero();
    for (size_t k = 0; k < binding.influences; ++k) {
      const uint32_t node = binding.nodes[best * binding.influences + k];
      sum += static_cast<double>(binding.weights[best * binding.influences + k]) *
             (x[node] - level.rest[node]).cast<double>();
    }
    return sum;
  };
  const Vec3 upper = motion(Vec3(0, -.0265, .1182)), lower = motion(Vec3(0, -.042, .1155));
  EXPECT_GT((upper - lower).norm(), 0.020);
  EXPECT_LT(upper.norm(), 0.006);
  EXPECT_LT(std::abs(lower.x()), 0.001);
}

TEST_F(Built, LidsCloseTheFissure) {
  const rig::TissueLevel& level = low().tissue.levels[0];
  const sim::FaceModel model(sim::lattice_of(level), sim::jaw_of(measured_head().jaw));
  sim::ReferenceSolver face(model, 3);
  std::vector<sim::Vec3f> x(level.rest.size());
  const float left[] = {1.0F, 0.0F, 0.0F};
  EXPECT_TRUE(face.static_pose({left, {}, sim::Vec3::Zero()}, {}, x).converged);
  float drop = 0.0F, other = 0.0F;
  for (size_t i = 0; i < level.columns; ++i) {
    const float down = level.rest[i].y() - x[i].y();
    if (level.rest[i].x() > 0.0F) drop = std::max(drop, down);
    if (level.rest[i].x() < -0.012F) other = std::max(other, down);  // beyond the nose
  }
  EXPECT_GT(drop, 0.006F);
  EXPECT_LT(other, 0.1F * drop);
}

TEST_F(Built, TheUpperLidTravelsTheSameOnBothSidesAndAtEveryLevel) {
  TissueOptions options;
  options.levels = {{"coarse", 500}, {"low", 700}};
  options.contact = false;
  const TissueResult result = build(measured_head(), options);
  std::vector<double> travel;
  for (const rig::TissueLevel& level : result.tissue.levels)
    for (const uint32_t side : {0U, 1U}) {
      double most = 0.0;
      for (size_t k = 0; k < level.carrier_node.size(); ++k)
        if (level.carrier_channel[k] == side)
          most = std::max(most, static_cast<double>(level.carrier_angle[k]));
      travel.push_back(most);
    }
  for (const double angle : travel) {
    EXPECT_GT(angle, 0.4);
    EXPECT_NEAR(angle, travel[0], 0.1 * travel[0]);
  }
}

TEST_F(Built, NostrilsAreNotOfTheMouth) {
  const FaceRegion region = find_region(measured_head(), {});
  for (const Opening opening : {Opening::mouth, Opening::nostril}) {
    const auto& distance = region.opening_distance[static_cast<size_t>(opening)];
    int edge = 0;
    for (size_t v = 0; v < distance.size(); ++v) {
      if (distance[v] > 0.0) continue;
      ++edge;
      EXPECT_EQ(region.mesh.vertices[v].y() > -0.015, opening == Opening::nostril);
    }
    EXPECT_GT(edge, 20);
  }
}

TEST_F(Built, AMissingLandmarkIsNamed) {
  TissueInputs inputs = measured_head();
  inputs.landmarks.erase("glabella");
  try {
    build(inputs);
    FAIL() << "built without a landmark it needs";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("glabella"), std::string::npos);
  }
}

}  // namespace
}  // namespace fascia::tissue
