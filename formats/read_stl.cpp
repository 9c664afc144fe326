#include <cstring>
#include <sstream>

#include "formats/detail.h"
#include "geometry/connectivity.h"

namespace fascia::formats::detail {

namespace {

bool is_binary(const std::vector<uint8_t>& bytes) {
  if (bytes.size() < 84) return false;
  uint32_t count;
  std::memcpy(&count, &bytes[80], 4);
  return bytes.size() == 84 + 50 * static_cast<size_t>(count) || std::memcmp(bytes.data(), "solid", 5) != 0;
}

void read_binary(const Scene& scene, TriangleMesh& soup) {
  uint32_t count;
  std::memcpy(&count, &scene.bytes[80], 4);
  if (scene.bytes.size() < 84 + 50 * static_cast<size_t>(count))
    fail(scene, "its STL header promises " + std::to_string(count) +
                    " triangles, the file ends before: it is truncated");
  for (uint32_t t = 0; t < count; ++t) {
    float corner[9];
    std::memcpy(corner, &scene.bytes[84 + 50 * static_cast<size_t>(t) + 12], sizeof corner);
    for (int k = 0; k < 3; ++k)
      soup.vertices.emplace_back(corner[3 * k], corner[3 * k + 1], corner[3 * k + 2]);
  }
}

void read_ascii(const Scene& scene, TriangleMesh& soup) {
  std::istringstream words(std::string(scene.bytes.begin(), scene.bytes.end()));
  for (std::string word; words >> word;) {
    if (word != "vertex") continue;
    Vec3 p;
    if (!(words >> p[0] >> p[1] >> p[2])) fail(scene, "it has a broken STL vertex line");
    soup.vertices.push_back(p);
  }
  if (soup.vertices.empty()) fail(scene, "it is not an STL file: there is no 'vertex' in it");
  if (soup.vertices.size() % 3 != 0) fail(scene, "its last STL facet is not whole: the file is truncated");
}

}  // namespace

void read_stl(Scene& scene) {
  TriangleMesh soup;
  if (is_binary(scene.bytes))
    read_binary(scene, soup);
  else
    read_ascii(scene, soup);
  for (int v = 0; v + 2 < soup.vertex_count(); v += 3)
    soup.triangles.push_back({v, v + 1, v + 2});
  SceneMesh mesh;
  mesh.name = scene.path.stem().string();
  mesh.positions = std::move(soup.vertices);
  mesh.triangles = std::move(soup.triangles);
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace fascia::formats::detail
