#include <gtest/gtest.h>

#include <cmath>

#include "gltf/read/container.h"
#include "view/face/appearance.h"
#include "view/face/fibre_tubes.h"
#include "view/face/heat_map.h"
#include "view/face/lattice_layers.h"

namespace fascia::view {
namespace {

TEST(HeatMap, StrainOfAStretchIsItsAreaLessOne) {
  DrawSurface flat;
  flat.positions = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
  flat.triangles = {{0, 1, 2}, {0, 2, 3}};
  std::vector<Vec3> wide = flat.positions;
  for (Vec3& p : wide)
    p[0] *= 1.25;
  for (const double strain : areal_strain(flat.positions, wide, flat.triangles))
    EXPECT_NEAR(strain, 0.25, 1e-12);
  const HeatScale scale{"", -1, 1, true};
  EXPECT_GT(heat_colour(scale, 1)[0], heat_colour(scale, 1)[2]);
  EXPECT_GT(heat_colour(scale, -1)[2], heat_colour(scale, -1)[0]);
  EXPECT_EQ(heat_colour(scale, 7), heat_colour(scale, 1));
  EXPECT_TRUE(heat_colour(scale, NAN).allFinite());
}

/// The look of one triangle whose material has `colour` (linear) and no map.
PrimitiveLook look_of_material(const std::string& colour) {
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],)"
      R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":)" +
      colour + R"(}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}]})";
  const std::vector<uint8_t> bytes = gltf::glb_bytes(json, std::vector<uint8_t>(36, 0));
  return Appearance::read(bytes, "triangle.glb").of(0, 0);
}

TEST(Appearance, WhiteAndGreyCountAsUnset) {
  EXPECT_FALSE(look_of_material("[1,1,1,1]").has_material);
  EXPECT_FALSE(look_of_material("[0.6,0.6,0.6,1]").has_material);
  EXPECT_TRUE(look_of_material("[0.6,0.4,0.3,1]").has_material);
}

TEST(Lattice, FatLiesBetweenSkinAndSmas) {
  Lattice lattice;
  lattice.columns = 3;
  for (const double z : {0.01, 0.004, 0.0})
    for (const Vec3& p : {Vec3(0, 0, z), Vec3(0.01, 0, z), Vec3(0, 0.01, z)})
      lattice.nodes.push_back(p);
  lattice.prisms = {{0, 1, 2}};
  const DrawSurface fat = fat_surface(lattice);
  ASSERT_EQ(fat.positions.size(), 3U);
  EXPECT_EQ(fat.triangles, lattice.prisms);
  for (const Vec3& p : fat.positions) {
    EXPECT_LT(p.z(), 0.0095);
    EXPECT_GT(p.z(), 0.0045);
  }
  DrawList list;
  add_lattice(lattice, list);
  size_t lines = 0;
  for (const DrawLines& layer : list.lines)
    lines += layer.lines.size();
  EXPECT_EQ(lines, 9U) << "three edges in each of two layers, three columns";

  lattice.nodes.pop_back();
  EXPECT_TRUE(fat_surface(lattice).triangles.empty());
}

TEST(FibreTubes, AShortFibreHasFleshBetweenItsTendons) {
  FibreTubeOptions options;
  DrawSurface surface;
  add_fibre_tubes({{Vec3(0, 0, 0), Vec3(0.003, 0, 0)}}, options, surface);
  double reddest = 0.0;
  for (const Vec3& c : surface.vertex_colours)
    reddest = std::max(reddest, c[0] - c[2]);
  EXPECT_NEAR(reddest, options.flesh[0] - options.flesh[2], 1e-9);
}

TEST(FibreTubes, CloseAroundTheirFibre) {
  DrawSurface tubes;
  FibreTubeOptions options;
  options.has_tendons = false;
  options.thinnest = options.thickest = 0.001;
  add_fibre_tubes({{Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0.02, 0.002, 0)}}, options, tubes);
  EXPECT_EQ(tubes.positions.size(), 3u * 6u);
  EXPECT_EQ(tubes.triangles.size(), 2u * 2u * 6u);
  EXPECT_NEAR((tubes.positions[0] - Vec3(0, 0, 0)).norm(), 0.001, 1e-12);
}

}  // namespace
}  // namespace fascia::view
