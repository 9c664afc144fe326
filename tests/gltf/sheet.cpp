#include "tests/gltf/sheet.h"

#include "gltf/edit/edit.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"

namespace fascia::gltf::test {

namespace {

constexpr int side = 5, vertices = side * side;

std::vector<float> repeated(std::initializer_list<float> element) {
  std::vector<float> all;
  for (int v = 0; v < vertices; ++v)
    all.insert(all.end(), element);
  return all;
}

std::vector<uint32_t> corners_of(int primitive, int primitives) {
  std::vector<uint32_t> corners;
  int quad = 0;
  for (uint32_t y = 0; y + 1 < side; ++y)
    for (uint32_t x = 0; x + 1 < side; ++x, ++quad) {
      if (quad % primitives != primitive) continue;
      const uint32_t a = y * side + x, b = a + 1, c = b + side, d = a + side;
      corners.insert(corners.end(), {a, b, c, a, c, d});
    }
  return corners;
}

void add_targets(Edit& edit, Json& mesh, const SheetOptions& options) {
  const std::size_t lift = edit.add_floats(repeated({0, 0, 1}), 3, true),
                    slide = edit.add_floats(repeated({1, 0, 0}), 3, true);
  for (Json& primitive : mesh["primitives"])
    primitive["targets"] = Json::array({{{"POSITION", lift}}, {{"POSITION", slide}}});
  mesh["weights"] = options.weights;
  mesh["extras"] = {{"targetNames", {"lift", "jawOpen"}}};
  if (!options.clip) return;
  const std::vector<float> times = {0, 1, 2}, values = {0.8F, 0, 0.5F, 0.25F, 0, 1};
  edit.json["animations"] = Json::array(
      {{{"name", "idle"},
        {"samplers", Json::array({{{"input", edit.add_floats(times, 1, true)},
                                   {"output", edit.add_floats(values, 1, false)}}})},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}}});
}

}  // namespace

Document sheet(const SheetOptions& options) {
  Edit edit({R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}]})", {}});
  std::vector<float> places;
  for (int v = 0; v < vertices; ++v)
    places.insert(places.end(), {static_cast<float>(v % side), static_cast<float>(v / side), 0.0F});
  Json attributes = {{"POSITION", edit.add_floats(places, 3, true, vertex_target)}};
  if (options.normals) attributes["NORMAL"] = edit.add_floats(repeated({0, 0, 1}), 3, false, vertex_target);
  if (options.tangents)
    attributes["TANGENT"] = edit.add_floats(repeated({1, 0, 0, 1}), 4, false, vertex_target);
  Json mesh = {{"name", "sheet"}, {"primitives", Json::array()}};
  for (int p = 0; p < options.primitives; ++p)
    mesh["primitives"].push_back({{"attributes", attributes},
                                  {"indices", edit.data().add_indices(corners_of(p, options.primitives))}});
  if (!options.weights.empty()) add_targets(edit, mesh, options);
  edit.json["meshes"] = Json::array({mesh});
  return glb_document(edit.bytes(), "sheet");
}

std::vector<PrimitiveMotion> bump(float height, int primitives) {
  std::vector<PrimitiveMotion> motions;
  for (int p = 0; p < primitives; ++p) {
    std::vector<Vec3f> moves(vertices, Vec3f::Zero());
    moves[12] = Vec3f(0, 0, height);
    motions.push_back({0, static_cast<uint32_t>(p), moves});
  }
  return motions;
}

std::vector<float> floats(const Document& document, const Json& accessor) {
  const tinygltf::Model model = load_model(glb_bytes(document.json, document.bin), "test");
  return decode_floats(model, accessor.get<int>(), "test");
}

}  // namespace fascia::gltf::test
