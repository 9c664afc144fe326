#include "tests/builder/pieces_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "gltf/read/container.h"

namespace fascia::testing {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
void put(std::vector<uint8_t>& bytes, T value) {
  uint8_t raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.insert(bytes.end(), raw, raw + sizeof(T));
}

}  // namespace

std::vector<uint8_t> glb_of(const std::vector<Piece>& pieces) {
  Json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::vector<uint8_t> bin;
  const auto add = [&](size_t begin, const Json& accessor) {
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bin.size() - begin}});
    Json full = accessor;
    full["bufferView"] = root["bufferViews"].size() - 1;
    root["accessors"].push_back(full);
    return root["accessors"].size() - 1;
  };
  for (const Piece& piece : pieces) {
    const size_t begin = bin.size();
    Bounds box;
    for (const Vec3& p : piece.mesh.vertices)
      for (int k = 0; k < 3; ++k) {
        put(bin, static_cast<float>(p[k]));
        if (!std::isfinite(p[k])) continue;
        box.lower[k] = std::min(box.lower[k], p[k]);
        box.upper[k] = std::max(box.upper[k], p[k]);
      }
    const auto vector = [](const Vec3& p) { return Json{p[0], p[1], p[2]}; };
    const size_t positions = add(begin, {{"componentType", 5126},
                                         {"count", piece.mesh.vertices.size()},
                                         {"type", "VEC3"},
                                         {"min", vector(box.lower)},
                                         {"max", vector(box.upper)}});
    Json primitive = {{"attributes", {{"POSITION", positions}}}};
    if (!piece.mesh.triangles.empty()) {
      const size_t first = bin.size();
      for (const Triangle& t : piece.mesh.triangles)
        for (const int v : t)
          put(bin, static_cast<uint32_t>(v));
      primitive["indices"] = add(
          first, {{"componentType", 5125}, {"count", 3 * piece.mesh.triangles.size()}, {"type", "SCALAR"}});
    } else {
      primitive["indices"] = add(bin.size(), {{"componentType", 5125}, {"count", 0}, {"type", "SCALAR"}});
    }
    root["meshes"].push_back({{"name", piece.name}, {"primitives", {primitive}}});
    root["nodes"].push_back(
        {{"name", piece.name}, {"mesh", root["meshes"].size() - 1}, {"scale", vector(piece.scale)}});
    root["scenes"][0]["nodes"].push_back(root["nodes"].size() - 1);
  }
  root["buffers"].push_back({{"byteLength", bin.size()}});
  return gltf::glb_bytes(root.dump(), bin);
}

}  // namespace fascia::testing
