#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <sstream>

#include "formats/detail.h"
#include "geometry/text.h"
#include "gltf/read/text.h"

namespace fascia::formats::detail {

namespace {

/// The beginning of the file as text: byte order mark and blanks passed over, in lower case.
std::string beginning(const std::vector<uint8_t>& bytes) {
  size_t at = bytes.size() > 2 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF ? 3 : 0;
  while (at < bytes.size() && std::isspace(bytes[at]))
    ++at;
  std::string text;
  for (; at < bytes.size() && text.size() < 4096; ++at)
    text.push_back(static_cast<char>(std::tolower(bytes[at])));
  return text;
}

size_t promised_size(const std::vector<uint8_t>& bytes) {
  uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, &bytes[80], 4);
  return 84 + 50 * static_cast<size_t>(count);
}

/// Binary files may begin with "solid" too, so that their length decides first, then whether text follows the
/// word.
bool is_binary(const std::vector<uint8_t>& bytes) {
  if (bytes.size() < 84) return false;
  if (bytes.size() == promised_size(bytes)) return true;
  const std::string text = beginning(bytes);
  const bool is_text = text.rfind("solid", 0) == 0 && text.find('\0') == std::string::npos;
  return !is_text || (text.find("facet") == std::string::npos && text.find("endsolid") == std::string::npos);
}

void read_binary(const Scene& scene, TriangleMesh& soup) {
  uint32_t count;
  std::memcpy(&count, &scene.bytes[80], 4);
  if (scene.bytes.size() < promised_size(scene.bytes))
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
    word = lower_case(word);
    if (word != "vertex") continue;
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      words >> word;
      const char* begin = word.c_str() + (word[0] == '+' ? 1 : 0);
      const auto parsed = std::from_chars(begin, word.c_str() + word.size(), p[k]);
      if (!words || parsed.ec != std::errc() || *parsed.ptr != 0)
        fail(scene, "it has a broken STL vertex line: vertex " + std::to_string(soup.vertices.size()));
    }
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
  mesh.name = gltf::as_utf8(scene.path.stem().string());
  mesh.positions = std::move(soup.vertices);
  mesh.triangles = std::move(soup.triangles);
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace fascia::formats::detail
