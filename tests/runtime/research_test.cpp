#include "fascia/research.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/runtime/skinned_rig.h"

namespace {

using namespace fascia::test;

struct Reference {
  explicit Reference(fascia_asset* asset) {
    fascia_face_options options = fascia_default_face_options();
    options.solver = FASCIA_SOLVER_REFERENCE;
    options.space = FASCIA_SPACE_MESH;  // centimetres: a change of units in the chain
    EXPECT_EQ(fascia_face_create(asset, &options, &face), FASCIA_OK) << fascia_last_message();
  }
  ~Reference() { fascia_face_release(face); }
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;
  std::vector<float> positions() const {
    fascia_vectors vectors = {};
    vectors.struct_size = sizeof vectors;
    EXPECT_EQ(fascia_face_positions(face, 0, &vectors), FASCIA_OK);
    return {vectors.data, vectors.data + 3 * vectors.count};
  }
  fascia_face* face = nullptr;
};

TEST(Research, TheLatticeAndItsNodes) {
  const Loaded rig;
  const Face face(rig.asset);
  fascia_lattice lattice = {};
  lattice.struct_size = sizeof lattice;
  ASSERT_EQ(fascia_asset_lattice(rig.asset, 0, &lattice), FASCIA_OK);
  EXPECT_EQ(lattice.column_count, side * side);
  EXPECT_EQ(lattice.node_count, 3 * side * side);
  fascia_vectors nodes = {};
  nodes.struct_size = sizeof nodes;
  ASSERT_EQ(fascia_face_nodes(face.face, &nodes), FASCIA_OK);
  ASSERT_EQ(nodes.count, lattice.node_count);
  for (uint32_t i = 0; i < 3 * nodes.count; ++i)
    ASSERT_EQ(nodes.data[i], lattice.rest[i]);
  // Skin vertices of this rig are its skin nodes.
  fascia_face_values(face.face)[0] = 1.0F;
  fascia_face_pose(face.face);
  ASSERT_EQ(fascia_face_nodes(face.face, &nodes), FASCIA_OK);
  const std::vector<float> positions = face.positions();
  for (std::size_t i = 0; i < positions.size(); ++i)
    ASSERT_NEAR(nodes.data[i], positions[i], 1e-6F);
  EXPECT_EQ(fascia_asset_lattice(rig.asset, 1, &lattice), FASCIA_ERROR_ARGUMENT);
}

TEST(Research, EnergiesAndForces) {
  const Loaded rig;
  const Reference face(rig.asset);
  fascia_energies energies = {};
  energies.struct_size = sizeof energies;
  ASSERT_EQ(fascia_face_energies(face.face, &energies), FASCIA_OK);
  EXPECT_NEAR(energies.total, 0.0, 1e-20);
  std::vector<float> tensions(6, -1.0F), forces(3 * 3 * static_cast<std::size_t>(side * side));
  ASSERT_EQ(fascia_face_fibre_forces(face.face, tensions.data(), 6), FASCIA_OK);
  EXPECT_EQ(tensions, std::vector<float>(6, 0.0F));
  fascia_face_values(face.face)[0] = 0.5F;
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_energies(face.face, &energies), FASCIA_OK);
  EXPECT_GT(energies.springs + energies.membranes, 0.0);
  EXPECT_LT(energies.total, 0.0);  // the muscle has given more than the tissue took up
  EXPECT_NEAR(energies.total,
              energies.springs + energies.membranes + energies.bending + energies.volume + energies.tethers +
                  energies.fibres + energies.others,
              1e-12);
  ASSERT_EQ(fascia_face_fibre_forces(face.face, tensions.data(), 6), FASCIA_OK);
  float largest_tension = 0.0F;
  for (int f = 0; f < 3; ++f) {
    EXPECT_GT(tensions[static_cast<std::size_t>(f)], 0.0F);
    EXPECT_EQ(tensions[static_cast<std::size_t>(f) + 3], 0.0F);  // the other side
    largest_tension = std::max(largest_tension, tensions[static_cast<std::size_t>(f)]);
  }
  ASSERT_EQ(fascia_face_node_forces(face.face, forces.data(), forces.size() / 3), FASCIA_OK);
  for (const float force : forces)
    EXPECT_NEAR(force, 0.0F, 0.02F * largest_tension);
  EXPECT_EQ(fascia_face_fibre_forces(face.face, tensions.data(), 5), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_node_forces(face.face, forces.data(), 5), FASCIA_ERROR_ARGUMENT);
}

TEST(Research, TheGradientIsThatOfFiniteDifferences) {
  const Loaded rig(rig_with_bones());
  const Reference face(rig.asset);
  const float at[5] = {0.4F, 0.2F, 0.35F, 0.3F, 0.2F};
  // Of what each channel moves, something: both corners of the mouth, the jaw's vertices, the cheek, the
  // eye's.
  std::vector<float> slopes(3 * static_cast<std::size_t>(side * side), 0.0F);
  const auto pull = [&](uint32_t vertex, float x, float y, float z) {
    slopes[3 * std::size_t{vertex}] = x;
    slopes[3 * std::size_t{vertex} + 1] = y;
    slopes[3 * std::size_t{vertex} + 2] = z;
  };
  const uint32_t middle = side / 2 * side + side / 2;
  pull(middle + 2, 1.0F, 2.0F, 0.5F);
  pull(middle + 3, 0.5F, 1.0F, 0.2F);
  pull(middle - 2, -1.5F, 1.0F, 0.3F);
  pull(5, 0.1F, 1.0F, 0.4F);
  pull(25, 0.1F, 0.7F, -0.4F);
  pull(260, 0.5F, 0.1F, 1.0F);
  const std::vector<float> rest = face.positions();
  fascia_face_values(face.face)[3] = 1.0F;
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  const std::vector<float> puffed = face.positions();
  std::size_t most = 0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (std::abs(puffed[i] - rest[i]) > std::abs(puffed[most] - rest[most])) most = i;
  slopes[most] += 3.0F;
  const auto loss = [&](int channel, float by) {
    std::copy(at, at + 5, fascia_face_values(face.face));
    fascia_face_values(face.face)[channel] += by;
    EXPECT_EQ(fascia_face_pose(face.face), FASCIA_OK);
    const std::vector<float> positions = face.positions();
    double sum = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i)
      sum += static_cast<double>(slopes[i]) * static_cast<double>(positions[i]);
    return sum;
  };
  loss(0, 0.0F);
  const float* lists[1] = {slopes.data()};
  float gradient[5] = {};
  ASSERT_EQ(fascia_face_gradient(face.face, lists, gradient), FASCIA_OK) << fascia_last_message();
  // A pose ends within its tolerance, some thousandths of a centimetre of the loss, so differences are taken
  // wide.
  for (int channel = 0; channel < 5; ++channel) {
    const double difference = (loss(channel, 0.1F) - loss(channel, -0.1F)) / 0.2;
    EXPECT_GT(std::abs(difference), 0.1) << channel;
    EXPECT_NEAR(static_cast<double>(gradient[channel]), difference, 0.05 * std::abs(difference) + 0.012)
        << channel;
  }
  slopes[5] = NAN;
  EXPECT_EQ(fascia_face_gradient(face.face, lists, gradient), FASCIA_ERROR_ARGUMENT);
  const float* none[1] = {nullptr};
  ASSERT_EQ(fascia_face_gradient(face.face, none, gradient), FASCIA_OK);
  EXPECT_EQ(gradient[0], 0.0F);
}

TEST(Research, TheGradientByMembersFollowsTheirResponse) {
  const Loaded rig;
  const Face face(rig.asset);
  const float by_channel[6] = {1.0F, -2.0F, 0.5F, 3.0F, 0.7F, 0.0F};
  uint32_t set = 0, member = 0;
  for (const char* name : {"au:12", "arkit:jawOpen"}) {
    ASSERT_EQ(fascia_asset_find_member(rig.asset, name, &set, &member), FASCIA_OK);
    for (const float weight : {0.1F, 0.25F, 0.4F, 0.9F}) {
      const auto loss = [&](float at) {
        EXPECT_EQ(fascia_face_set(face.face, name, at), FASCIA_OK);
        EXPECT_EQ(fascia_face_pose(face.face), FASCIA_OK);
        float sum = 0.0F;
        for (int channel = 0; channel < 5; ++channel)
          sum += by_channel[channel] * fascia_face_effective_values(face.face)[channel];
        return sum;
      };
      const float difference = (loss(weight + 0.01F) - loss(weight - 0.01F)) / 0.02F;
      loss(weight);
      float by_member[3] = {};
      ASSERT_EQ(fascia_face_member_gradient(face.face, set, by_channel, by_member), FASCIA_OK);
      EXPECT_NEAR(by_member[member], difference, 0.02F) << name << " at " << weight;
    }
    fascia_face_clear(face.face);
  }
  float by_member[3] = {};
  EXPECT_EQ(fascia_face_member_gradient(face.face, 9, by_channel, by_member), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_member_gradient(face.face, 0, nullptr, by_member), FASCIA_ERROR_ARGUMENT);
}

}  // namespace
