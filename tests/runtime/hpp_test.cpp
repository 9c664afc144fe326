#include "fascia/fascia.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "tests/rig/tiny_rig.h"

namespace {

using namespace fascia::api;

constexpr std::uint32_t side = 17, count = side * side;        // of the tiny rig's mesh
constexpr std::uint32_t smile_left = 0, jaw = 2, eye_yaw = 4;  // its channels

const std::vector<std::uint8_t>& bytes() {
  static const std::vector<std::uint8_t> made = fascia::test::tiny_rig_file();
  return made;
}

TEST(Hpp, HandlesAreOwnedAndMovable) {
  fascia::api::Asset asset = fascia::api::Asset::load(bytes());
  fascia::api::Face face(asset);
  asset = fascia::api::Asset::load(bytes());  // the face keeps its own
  face.set("arkit:mouthSmileLeft", 0.5F);
  EXPECT_EQ(face.get("arkit:mouthSmileLeft"), 0.5F);
  face.values()[1] = 0.25F;
  face.pose();
  EXPECT_FLOAT_EQ(face.effective_values()[0], 0.45F);
  const auto positions = face.positions(0);
  ASSERT_EQ(positions.size(), 289U);
  const fascia::api::Vector3 posed = positions[150];
  const std::vector<std::uint8_t> state = face.save();
  fascia::api::Face moved = std::move(face);
  EXPECT_EQ(moved.positions(0).data(), positions.data());
  moved.clear();
  moved.pose();
  EXPECT_NE(moved.positions(0)[150], posed);
  moved.restore(state);
  EXPECT_EQ(moved.positions(0)[150], posed);
  EXPECT_TRUE(moved.step(1.0F / 60.0F));
  EXPECT_EQ(moved.normals(0).size(), 289U);
  EXPECT_TRUE(moved.tangents(0).empty());
}

TEST(Hpp, ThrowsWhatTheCInterfaceReturns) {
  const fascia::api::Asset asset = fascia::api::Asset::load(bytes());
  fascia::api::Face face(asset);
  try {
    face.set("noSuchThing", 1.0F);
    FAIL();
  } catch (const fascia::api::Error& error) {
    EXPECT_EQ(error.result(), FASCIA_ERROR_NAME);
    EXPECT_NE(std::string(error.what()).find("noSuchThing"), std::string::npos);
  }
  EXPECT_THROW(fascia::api::Asset::load(std::span(bytes()).first(100)), fascia::api::Error);
  EXPECT_THROW(face.positions(7), fascia::api::Error);
  const float mask[2] = {1, 1};
  EXPECT_THROW(face.set_layer(1, FASCIA_COMBINE_ADD, 1.0F, mask), fascia::api::Error);
  face.set_layer(1, FASCIA_COMBINE_MAX);
  EXPECT_EQ(face.layer_values(1).size(), asset.channels().count);
  EXPECT_TRUE(face.layer_values(2).empty());
}

TEST(Hpp, AnAssetGivesWhatItHas) {
  const Asset asset = Asset::load(std::as_bytes(std::span(bytes())));
  EXPECT_EQ(asset.info().mesh_count, 1U);
  EXPECT_EQ(asset.mesh(0).vertex_count, count);
  EXPECT_EQ(asset.find_channel("JAW_OPEN"), static_cast<std::int32_t>(jaw));
  EXPECT_EQ(asset.find_channel("noSuchThing"), -1);
  const Asset::Member found = asset.find_member("arkit:jawOpen");
  EXPECT_STREQ(asset.set(found.set).name, "arkit");
  EXPECT_STREQ(asset.set(found.set).members[found.member], "jawOpen");
  EXPECT_THROW(asset.find_member("jaw_open"), Error);
  EXPECT_TRUE(asset.texcoords(0).empty());
  EXPECT_THROW(asset.texcoords(1), Error);
  EXPECT_EQ(asset.level(0).node_count, 3 * count);
  EXPECT_EQ(asset.lattice(0).node_count, 3 * count);
  EXPECT_EQ(asset.fibres(0).fibre_count, asset.level(0).fibre_count);
  EXPECT_EQ(asset.surface("smas").struct_size, sizeof(fascia_surface));
  EXPECT_THROW(asset.surface("nose"), Error);
}

TEST(Hpp, CurvesAreMatchedAndApplied) {
  const std::string csv = "time,jawOpen,nothing,headYaw\n0,0.6,0,0.2\n1,0.6,0,0.2\n";
  const std::vector<std::uint8_t> text(csv.begin(), csv.end());
  const Curves curves = Curves::load(text);
  const Asset asset = Asset::load(bytes());
  const fascia_curves_info info = curves.info();
  const std::vector<std::uint8_t> matched = curves.match(asset);
  ASSERT_EQ(matched.size(), info.count);
  for (std::uint32_t i = 0; i < info.count; ++i)
    EXPECT_EQ(matched[i] != 0, std::string_view(info.names[i]) == "jawOpen") << info.names[i];
  EXPECT_NE(curves.head(0.5)[1], 0.0F);
  Face face(asset);
  face.apply(curves, 0.5, 0.5F);
  face.pose();
  EXPECT_FLOAT_EQ(face.effective_values()[jaw], 0.3F);
  EXPECT_NE(face.jaw()[13], 0.0F);  // down
  EXPECT_THROW(face.apply(curves, 0.5, 1.0F, 1), Error);
}

TEST(Hpp, LayersAreSetClearedAndRemoved) {
  const Asset asset = Asset::load(bytes());
  Face face(asset);
  const auto effective = [&](std::uint32_t channel) {
    face.step(0.01F);
    return face.effective_values()[channel];
  };
  face.set_layer(1, FASCIA_COMBINE_MAX);
  face.layer_set(1, "jaw_open", 0.4F);
  EXPECT_FLOAT_EQ(effective(jaw), 0.4F);
  const Asset::Member smile = asset.find_member("arkit:mouthSmileLeft");
  face.layer_set_member(1, smile.set, smile.member, 0.5F);
  EXPECT_FLOAT_EQ(effective(smile_left), 0.45F);
  face.layer_clear(1);
  EXPECT_EQ(effective(jaw), 0.0F);
  face.layer_values(1)[jaw] = 0.3F;
  EXPECT_FLOAT_EQ(effective(jaw), 0.3F);
  face.layer_remove(1);
  EXPECT_EQ(effective(jaw), 0.0F);
  EXPECT_THROW(face.layer_remove(1), Error);
  EXPECT_THROW(face.layer_clear(1), Error);
  face.set_member(smile.set, smile.member, 0.5F);
  EXPECT_FLOAT_EQ(effective(smile_left), 0.45F);
}

TEST(Hpp, GazeAndBlend) {
  Face face(Asset::load(bytes()));
  face.look_at({0.13F, 1.63F, 0.57F});  // a tenth to the left of the left eye, half a metre before it
  face.pose();
  EXPECT_NEAR(face.effective_values()[eye_yaw], std::atan2(0.1F, 0.5F), 1e-5F);
  face.look_nowhere();
  face.pose();
  EXPECT_EQ(face.effective_values()[eye_yaw], 0.0F);
  face.values()[jaw] = 0.4F;
  face.blend(0.5F, 0.0F);
  face.pose();
  EXPECT_FLOAT_EQ(face.effective_values()[jaw], 0.2F);
}

float largest_motion(std::span<const Vector3> a, std::span<const Vector3> b) {
  float most = 0.0F;
  for (std::size_t v = 0; v < a.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max(most, std::abs(a[v][k] - b[v][k]));
  return most;
}

TEST(Hpp, TheHeadsMotionTouchesAndAcceleration) {
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  Face face(Asset::load(bytes()), options);
  const auto positions = face.positions(0);
  const std::vector<Vector3> rest(positions.begin(), positions.end());
  Matrix4 place{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  for (int frame = 0; frame < 4; ++frame) {
    place[12] = 0.02F * static_cast<float>(frame * frame);
    face.move_head(place);
    EXPECT_TRUE(face.step(1.0F / 60.0F));
  }
  EXPECT_GT(largest_motion(positions, rest), 1e-5F);
  face.reset();
  EXPECT_LT(largest_motion(positions, rest), 1e-6F);
  face.touch(0, 150, {0.0F, 0.0F, 0.2F});
  face.pose();
  EXPECT_GT(positions[150][2], rest[150][2] + 1e-5F);
  face.clear_touches();
  face.pose();
  EXPECT_LT(largest_motion(positions, rest), 1e-5F);
  face.set_acceleration({0.0F, -9.81F, 0.0F});
  face.pose();
  EXPECT_LT(positions[150][1], rest[150][1] - 1e-6F);
  face.set_acceleration({});
  face.pose();
  EXPECT_LT(largest_motion(positions, rest), 1e-5F);
  EXPECT_EQ(face.level(), 0);
  face.set_level(-1, 0.1F);
  EXPECT_EQ(face.level(), 0);
  EXPECT_THROW(face.set_level(7), Error);
}

TEST(Hpp, WritesToTheHostsMemory) {
  Face face(Asset::load(bytes()));
  face.values()[smile_left] = 0.8F;
  face.pose();
  std::vector<Vector3> written(count);
  face.write_positions(0, written);
  EXPECT_EQ(written[150], face.positions(0)[150]);
  face.write_normals(0, written);
  EXPECT_EQ(written[150], face.normals(0)[150]);
  std::vector<Vector4> wide(count, Vector4{9, 9, 9, 9});
  face.write_tangents(0, wide);  // the mesh has none
  EXPECT_EQ(wide[150], (Vector4{9, 9, 9, 9}));
  face.write_positions(0, wide.data(), sizeof(Vector4), count);
  EXPECT_EQ(wide[150][0], face.positions(0)[150][0]);
  EXPECT_EQ(wide[150][3], 9.0F);
  EXPECT_THROW(face.write_positions(0, wide.data(), static_cast<size_t>(-12), count), Error)
      << "a negative stride";
  face.write_normals(0, wide.data(), sizeof(Vector4), count);
  EXPECT_EQ(wide[150][0], face.normals(0)[150][0]);
  face.write_tangents(0, wide.data(), sizeof(Vector4), count);
  EXPECT_THROW(face.write_positions(0, std::span(written).first(5)), Error);
  const auto compression = face.compression(0);
  ASSERT_EQ(compression.size(), count);
  EXPECT_TRUE(std::any_of(compression.begin(), compression.end(),
                          [](const Vector3& strain) { return strain != Vector3{}; }));
  EXPECT_EQ(face.compression(0).data(), compression.data());
}

TEST(Hpp, ForcesEnergiesAndDerivatives) {
  const Asset asset = Asset::load(bytes());
  Face face(asset);
  face.set("arkit:mouthSmileLeft", 0.5F);
  face.pose();
  EXPECT_LT(face.energies().total, 0.0);
  ASSERT_EQ(face.nodes().size(), 3 * count);
  ASSERT_EQ(face.fibre_points().size(), asset.fibres(0).point_count);
  EXPECT_EQ(face.node_forces().size(), 3 * count);
  const std::vector<float> tensions = face.fibre_forces();
  ASSERT_EQ(tensions.size(), asset.fibres(0).fibre_count);
  EXPECT_GT(*std::max_element(tensions.begin(), tensions.end()), 0.0F);
  std::vector<Vector3> slopes(count);
  slopes[side / 2 * side + side / 2 + 2] = {1.0F, 1.0F, 0.0F};  // the corner of the mouth
  const std::span<const Vector3> lists[] = {slopes};
  const std::vector<float> by_channel = face.gradient(lists);
  ASSERT_EQ(by_channel.size(), asset.channels().count);
  EXPECT_NE(by_channel[smile_left], 0.0F);
  const Asset::Member smile = asset.find_member("arkit:mouthSmileLeft");
  const std::vector<float> by_member = face.member_gradient(smile.set, by_channel);
  ASSERT_EQ(by_member.size(), asset.set(smile.set).member_count);
  EXPECT_NEAR(by_member[smile.member], 0.9F * by_channel[smile_left],
              1e-3F * std::abs(by_channel[smile_left]));
  const std::span<const Vector3> none[] = {{}}, few[] = {std::span(slopes).first(5)};
  EXPECT_EQ(face.gradient(none), std::vector<float>(by_channel.size(), 0.0F));
  EXPECT_THROW(face.gradient(few), Error);
  EXPECT_THROW(face.gradient({}), Error);
  EXPECT_THROW(face.member_gradient(smile.set, std::span(by_channel).first(1)), Error);
}

TEST(Hpp, ManyFacesStepAsEachAlone) {
  const Asset asset = Asset::load(bytes());
  Face alone(asset), first(asset), second(asset);
  for (Face* const face : {&alone, &first, &second})
    face->values()[smile_left] = 0.8F;
  fascia_face* const faces[] = {first.handle(), second.handle()};
  EXPECT_TRUE(alone.step(1.0F / 60.0F));
  EXPECT_TRUE(faces_step(faces, 1.0F / 60.0F));
  EXPECT_EQ(first.positions(0)[150], alone.positions(0)[150]);
  EXPECT_EQ(second.positions(0)[150], alone.positions(0)[150]);
  EXPECT_THROW(faces_step(faces, 2.0F), Error);
}

TEST(Hpp, FailuresAreLogged) {
  std::vector<std::pair<fascia_result, std::string>> told;
  set_log([&](fascia_result result, std::string_view message) {
    told.emplace_back(result, message);
    throw std::runtime_error("lost");
  });
  EXPECT_THROW(Asset::load(std::span(bytes()).first(100)), Error);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].first, FASCIA_ERROR_FORMAT);
  EXPECT_EQ(told[0].second, fascia_last_message());
  set_log({});
  EXPECT_THROW(Asset::load(std::span(bytes()).first(100)), Error);
  EXPECT_EQ(told.size(), 1U);
}

TEST(Hpp, TheHostsAllocatorIsUsed) {
  static int made;
  fascia_allocator allocator = sized<fascia_allocator>();
  allocator.allocate = [](std::size_t size, std::size_t alignment, void*) {
    ++made;
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  };
  allocator.release = [](void* block, void*) { std::free(block); };
  try {
    set_allocator(&allocator);
  } catch (const Error& error) {
    ASSERT_EQ(error.result(), FASCIA_ERROR_MODULE) << error.what();  // a build without this feature
    GTEST_SKIP() << error.what();
  }
  {
    const Asset asset = Asset::load(bytes());
    EXPECT_GT(made, 100);
    EXPECT_THROW(set_allocator(nullptr), Error);
  }
  set_allocator(nullptr);
}

TEST(Hpp, AFitFollowsPoints) {
  fascia::rig::Rig whole = fascia::test::tiny_rig();
  for (const char* name : {"jaw_forward", "jaw_lateral"})
    whole.actuation.channels.push_back({name, "jaw", 0.0F, 1.0F, 0.0F, -1, "1"});
  const std::vector<std::uint8_t> file = fascia::rig::write(fascia::test::tiny_head(), whole);
  const Asset asset = Asset::load(file);
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  Face face(asset, options);
  std::vector<fascia_fit_place> places;
  std::vector<float> points;
  for (const std::uint32_t v : {40U, 60U, 144U, 200U, 230U, 250U}) {
    places.push_back({0, {v, v, v}, {1.0F, 0.0F, 0.0F}});
    const Vector3 point = face.positions(0)[v];
    points.insert(points.end(), point.begin(), point.end());
  }
  Fit fit(asset, places);
  EXPECT_EQ(fit.info().point_count, 6U);
  EXPECT_EQ(fit.info().dimensions, 3U);
  fit.set_neutral(points);
  const std::vector<float> weights(6, 1.0F);
  const fascia_fit_result found = fit.push(points, weights);
  EXPECT_EQ(found.seen, 6U);
  EXPECT_LT(found.residual, 1e-4F);
  fit.reset();
  EXPECT_EQ(fit.push(points).seen, 6U);
  EXPECT_THROW(fit.push(std::span(points).first(3)), Error);
  EXPECT_THROW(fit.set_neutral(points, std::span(weights).first(3)), Error);
  const char* const names[] = {"pronasale", nullptr};
  EXPECT_THROW(Fit(asset, names), Error);     // the rig has too few landmarks
  EXPECT_THROW(Fit(asset, "ibug68"), Error);  // likewise
}

}  // namespace
