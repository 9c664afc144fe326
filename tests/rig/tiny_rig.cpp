#include "tests/rig/tiny_rig.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace fascia::test {
namespace {

using rig::Rig;
using rig::Vec3f;

constexpr uint32_t side = 17, columns = side * side;
constexpr float height = 1.6F;  // metres from the ground to the patch's middle

/// Point of the patch `depth` metres under the skin, around the origin.
Vec3f patch_point(uint32_t column, float depth) {
  const float u = static_cast<float>(column % side) / (side - 1) - 0.5F;
  const float v = static_cast<float>(column / side) / (side - 1) - 0.5F;
  const float shrink = 1.0F - depth / 0.09F;
  const float x = 0.12F * u, y = 0.16F * v;
  const float z = 0.09F * std::sqrt(1.0F - x * x / 0.01F - y * y / 0.0169F);
  return shrink * Vec3f(x, y, z);
}

std::vector<rig::Triangle> patch_triangles() {
  std::vector<rig::Triangle> triangles;
  for (uint32_t row = 0; row + 1 < side; ++row)
    for (uint32_t i = row * side; i + 1 < row * side + side; ++i) {
      triangles.push_back({i, i + 1, i + side + 1});
      triangles.push_back({i, i + side + 1, i + side});
    }
  return triangles;
}

std::vector<Vec3f> layer_points(float depth) {
  std::vector<Vec3f> points;
  for (uint32_t i = 0; i < columns; ++i)
    points.push_back(patch_point(i, depth) + Vec3f(0, height, 0));
  return points;
}

bool on_rim(uint32_t column) {
  const uint32_t x = column % side, y = column / side;
  return x == 0 || y == 0 || x == side - 1 || y == side - 1;
}

bool on_jaw(uint32_t column) {
  return column / side < side / 2 - 1;
}

rig::Skull tiny_skull() {
  rig::Skull skull;
  skull.cranium = {layer_points(0.012F), patch_triangles()};
  skull.mandible = {{{-0.03F, 1.53F, 0.05F}, {0.03F, 1.53F, 0.05F}, {0, 1.53F, 0.07F}}, {{0, 1, 2}}};
  skull.landmarks = {{"nasion", {0, 1.64F, 0.09F}, {0, 1.64F, 0.085F}, 0.005F, 1.0F},
                     {"pogonion", {0, 1.55F, 0.08F}, {0, 1.55F, 0.07F}, 0.01F, 0.9F}};
  skull.jaw.origin = {0, 1.61F, 0.0F};
  skull.eye_left = {{0.03F, 1.63F, 0.07F}, 0.012F, {0, 0, 1}};
  return skull;
}

rig::Smas tiny_smas() {
  rig::Smas smas;
  smas.surface = {layer_points(0.004F), patch_triangles()};
  smas.depth_to_skin.assign(columns, 0.004F);
  smas.depth_to_bone.assign(columns, 0.008F);
  smas.skin_attachment.assign(columns, 0.5F);
  smas.bone_attachment.assign(columns, 0.1F);
  smas.ligaments = {{"zygomatic_left", {0.04F, 1.6F, 0.06F}, {0.042F, 1.6F, 0.07F}, 100.0F}};
  return smas;
}

/// One strap of three fibres running up and out along the columns.
rig::Muscle strap(const std::string& name, int direction) {
  rig::Muscle muscle;
  muscle.name = name;
  muscle.group = name;
  muscle.kind = "strap";
  muscle.strength = 1.5F;
  muscle.peak_shortening = 0.25F;
  muscle.fibre_offsets = {0};
  const auto triangles = patch_triangles();
  for (int fibre = -1; fibre <= 1; ++fibre) {
    for (int step = 0; step <= 5; ++step) {
      const int x = side / 2 + direction * (2 + step), y = side / 2 + fibre + step;
      const auto column = static_cast<uint32_t>(y * static_cast<int>(side) + x);
      uint32_t triangle = 0;
      while (triangles[triangle][0] != column)
        ++triangle;
      muscle.points.push_back(patch_point(column, 0.004F) + Vec3f(0, height, 0));
      muscle.triangles.push_back(triangle);
      muscle.barycentrics.push_back(Vec3f::UnitX());
      muscle.offsets.push_back(0);
    }
    muscle.fibre_offsets.push_back(static_cast<uint32_t>(muscle.points.size()));
  }
  muscle.origin_region = {muscle.points[5], muscle.points[11], muscle.points[17]};
  muscle.insertion_region = {muscle.points[0], muscle.points[6], muscle.points[12], muscle.points[7]};
  return muscle;
}

void add_springs(rig::TissueLevel& level) {
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const auto& triangle : level.triangles)
    for (int e = 0; e < 3; ++e) {
      const uint32_t a = triangle[e], b = triangle[(e + 1) % 3];
      edges.insert({std::min(a, b), std::max(a, b)});
    }
  const auto add = [&](uint32_t a, uint32_t b, float stiffness, bool one_sided) {
    level.spring_nodes.push_back({a, b});
    level.spring_stiffness.push_back(stiffness);
    level.spring_limit_strain.push_back(one_sided ? std::numeric_limits<float>::infinity() : 0.3F);
    level.spring_second_stiffness.push_back(5 * stiffness);
    level.spring_one_sided.push_back(one_sided);
  };
  for (const auto& [a, b] : edges)
    for (uint32_t layer = 0; layer < 2; ++layer)
      add(layer * columns + a, layer * columns + b, 60.0F, false);
  for (uint32_t i = 0; i < columns; ++i) {
    add(i, columns + i, 40.0F, false);
    add(columns + i, 2 * columns + i, 8.0F, true);
  }
}

void add_fibres(rig::TissueLevel& level, const std::vector<rig::Muscle>& muscles) {
  level.fibre_offsets = {0};
  for (uint32_t m = 0; m < muscles.size(); ++m)
    for (std::size_t f = 0; f + 1 < muscles[m].fibre_offsets.size(); ++f) {
      const uint32_t first = muscles[m].fibre_offsets[f], last = muscles[m].fibre_offsets[f + 1];
      for (uint32_t p = first; p < last; ++p) {
        const auto& triangle = level.triangles[muscles[m].triangles[p]];
        level.fibre_nodes.push_back({columns + triangle[0], columns + triangle[1], columns + triangle[2]});
        level.fibre_weights.push_back(muscles[m].barycentrics[p]);
        level.fibre_rest.push_back(muscles[m].points[p]);
        level.fibre_anchor.push_back(p + 1 == last ? rig::FibreEnd::cranium : rig::FibreEnd::smas);
        level.fibre_taper.push_back(1.0F);
      }
      level.fibre_muscle.push_back(m);
      level.fibre_channel.push_back(m);
      level.fibre_shortest.push_back(0.6F);
      level.fibre_strength.push_back(muscles[m].strength / 3);
      level.fibre_offsets.push_back(static_cast<uint32_t>(level.fibre_nodes.size()));
    }
}

rig::TissueLevel tiny_level(const std::vector<rig::Muscle>& muscles) {
  rig::TissueLevel level;
  level.name = "low";
  level.columns = columns;
  for (const float depth : {0.0F, 0.004F, 0.012F})
    for (const Vec3f& point : layer_points(depth))
      level.rest.push_back(point);
  for (uint32_t node = 0; node < 3 * columns; ++node) {
    const uint32_t column = node % columns;
    rig::NodeKind kind = rig::NodeKind::free;
    if (on_rim(column))
      kind = rig::NodeKind::fixed;
    else if (node >= 2 * columns)
      kind = on_jaw(column) ? rig::NodeKind::fixed_mandible : rig::NodeKind::fixed_cranium;
    level.kinds.push_back(kind);
    level.masses.push_back(2e-4F);
    level.jaw_weights.push_back(on_jaw(column) ? 1.0F : 0.0F);
  }
  level.triangles = patch_triangles();
  const std::size_t prisms = level.triangles.size();
  add_springs(level);
  level.skin_membrane.assign(prisms, 40.0F);
  level.smas_membrane.assign(prisms, 30.0F);
  level.skin_bending.assign(columns, 1e-5F);
  level.smas_bending.assign(columns, 1e-5F);
  for (uint32_t i = 0; i < columns; ++i)
    if (!on_rim(i)) {
      level.tether_nodes.push_back(columns + i);
      level.tether_normals.push_back(patch_point(i, 0).normalized());
      level.tether_normal_stiffness.push_back(4.0F);
      level.tether_tangential_stiffness.push_back(1.0F);
    }
  level.volume_stiffness.assign(prisms, 1e3F);
  level.inner_volume_stiffness.assign(prisms, 1e2F);
  add_fibres(level, muscles);
  level.globe_centre = {{0.03F, 1.63F, 0.07F}};
  level.globe_radius = {0.012F};
  level.globe_contact_node = {2 * columns + 190};
  level.globe_contact_globe = {0};
  level.pressure_channel = {3};
  level.pressure_prism = {100};
  level.pressure = {200.0F};
  return level;
}

rig::Binding tiny_binding() {
  rig::Binding binding;
  binding.part = "skin";
  binding.vertex_count = columns;
  binding.to_rig.setIdentity();
  binding.to_rig.topLeftCorner<3, 3>() *= 0.01F;
  binding.to_rig(1, 3) = height;
  binding.influences = 1;
  for (uint32_t i = 0; i < columns; ++i)
    binding.nodes.push_back(i);
  binding.weights.assign(columns, 1.0F);
  binding.jaw_weights.assign(columns, 0.0F);
  binding.eye.assign(columns, 0);
  return binding;
}

rig::Actuation tiny_actuation() {
  rig::Actuation actuation;
  actuation.channels = {{"zygomaticus_major_left", "muscle", 0, 1, 0, 0, "1"},
                        {"zygomaticus_major_right", "muscle", 0, 1, 0, 1, "1"},
                        {"jaw_open", "jaw", 0, 1, 0, -1, "1"},
                        {"buccal_pressure_left", "pressure", -1, 1, 0, -1, "1"},
                        {"eye_yaw_left", "eye", -0.6F, 0.6F, 0, -1, "rad"}};
  actuation.sets = {{"arkit",
                     {"mouthSmileLeft", "mouthSmileRight", "jawOpen"},
                     {0, 1, 2, 2},
                     {0, 1, 2, 3},
                     {0.9F, 0.9F, 1.0F, 0.1F},
                     {},
                     {}},
                    {"au", {"12"}, {0, 0}, {0, 1}, {0.8F, 0.8F}, {0.25F, 0.5F, 0.75F}, {0.15F, 0.4F, 0.7F}}};
  return actuation;
}

void put(std::vector<uint8_t>& bin, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const uint8_t*>(data);
  bin.insert(bin.end(), bytes, bytes + size);
}

/// The constants that a rig without any has.
rig::TissueMechanics tiny_mechanics() {
  rig::TissueMechanics mechanics;
  mechanics.stiffness_damping = 0.004;
  mechanics.mass_damping = 8.0;
  mechanics.activation_rise = 0.03;
  mechanics.activation_decay = 0.05;
  mechanics.initial_force_slope = 0.45;
  mechanics.globe_stiffness = 200.0;
  mechanics.bone_stiffness = mechanics.facing_stiffness = 150.0;
  mechanics.contact_thickness = 0.0004;
  mechanics.lid_thickness = -0.0003;
  mechanics.friction = 0.3;
  mechanics.sticky_reach = 0.003;
  mechanics.sticky_stiffness = 20.0;
  mechanics.lip_range = {0.006, 0.0025, 0.0015};
  mechanics.lid_range = {0.014, 0.004, 0.004};
  return mechanics;
}

}  // namespace

Rig tiny_rig() {
  Rig rig;
  rig.skull = tiny_skull();
  rig.smas = tiny_smas();
  rig.muscles = {strap("zygomaticus_major_left", 1), strap("zygomaticus_major_right", -1)};
  rig.tissue.levels = {tiny_level(rig.muscles)};
  rig.tissue.bindings = {{tiny_binding()}};
  rig.tissue.mechanics = tiny_mechanics();
  rig.actuation = tiny_actuation();
  rig.input_to_metres.topLeftCorner<3, 3>() *= 0.01F;
  return rig;
}

rig::GltfSource tiny_head() {
  rig::GltfSource source;
  for (uint32_t i = 0; i < columns; ++i) {
    const Vec3f point = 100.0F * patch_point(i, 0);
    put(source.bin, point.data(), 12);
  }
  const std::size_t triangles_at = source.bin.size();
  for (const auto& triangle : patch_triangles())
    for (const uint32_t corner : triangle) {
      const auto index = static_cast<uint16_t>(corner);
      put(source.bin, &index, 2);
    }
  const std::size_t times_at = source.bin.size();
  for (const float number : {0.0F, 1.0F, 0.0F, 0.8F})
    put(source.bin, &number, 4);
  const Vec3f high = 100.0F * patch_point(columns / 2, 0);
  const float least_z = 100.0F * patch_point(0, 0).z(), left = 100.0F * patch_point(0, 0).x(),
              bottom = 100.0F * patch_point(0, 0).y();
  const auto exact = [](float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", static_cast<double>(value));
    return std::string(text);
  };
  source.json =
      R"({"asset":{"version":"2.0","generator":"tiny","extras":{"kept":[1,2.5,"three"]}},)"
      R"("extensionsUsed":["KHR_animation_pointer","KHR_materials_unlit"],"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"name":"head","mesh":0,"translation":[0,160,0],"extras":{"unknown":true}}],)"
      R"("materials":[{"name":"skin","extensions":{"KHR_materials_unlit":{}}}],)"
      R"("meshes":[{"name":"face","extras":{"a":{"b":null}},"primitives":[)"
      R"({"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":289,"type":"VEC3","min":[)" +
      exact(left) + "," + exact(bottom) + "," + exact(least_z) + R"(],"max":[)" + exact(-left) + "," +
      exact(-bottom) + "," + exact(high.z()) +
      R"(]},{"bufferView":1,"componentType":5123,"count":1536,"type":"SCALAR"},)"
      R"({"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},)"
      R"({"bufferView":2,"byteOffset":8,"componentType":5126,"count":2,"type":"SCALAR"}],)"
      R"("animations":[{"name":"smile","samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":)"
      R"({"path":"pointer","extensions":{"KHR_animation_pointer":)"
      R"({"pointer":"/extensions/FASCIA_actuation/channels/0/value"}}}}]}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":)" +
      std::to_string(triangles_at) + R"(,"target":34962},{"buffer":0,"byteOffset":)" +
      std::to_string(triangles_at) + R"(,"byteLength":)" + std::to_string(times_at - triangles_at) +
      R"(,"target":34963},{"buffer":0,"byteOffset":)" + std::to_string(times_at) +
      R"(,"byteLength":16}],"buffers":[{"byteLength":)" + std::to_string(source.bin.size()) + "}]}";
  return source;
}

std::vector<uint8_t> tiny_rig_file() {
  return rig::write(tiny_head(), tiny_rig());
}

}  // namespace fascia::test
