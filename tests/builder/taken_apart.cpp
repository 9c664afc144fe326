#include "tests/builder/taken_apart.h"

#include <map>
#include <utility>

namespace fascia::testing {

Vec3 middle_of(const TriangleMesh& mesh, const Triangle& t) {
  return (mesh.vertices[static_cast<size_t>(t[0])] + mesh.vertices[static_cast<size_t>(t[1])] +
          mesh.vertices[static_cast<size_t>(t[2])]) /
         3.0;
}

std::vector<TriangleMesh> taken_apart(const TriangleMesh& mesh,
                                      const std::function<int(const Triangle&)>& label) {
  std::map<int, TriangleMesh> parts;
  std::map<int, std::map<int, int>> maps;
  for (const Triangle& t : mesh.triangles) {
    const int l = label(t);
    Triangle own;
    for (size_t k = 0; k < 3; ++k) {
      const auto [at, is_new] = maps[l].try_emplace(t[k], parts[l].vertex_count());
      if (is_new) parts[l].vertices.push_back(mesh.vertices[static_cast<size_t>(t[k])]);
      own[k] = at->second;
    }
    parts[l].triangles.push_back(own);
  }
  std::vector<TriangleMesh> all;
  for (auto& [l, part] : parts)
    all.push_back(std::move(part));
  return all;
}

TriangleMesh joined(const std::vector<TriangleMesh>& parts) {
  TriangleMesh all;
  for (const TriangleMesh& part : parts) {
    const int base = all.vertex_count();
    all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const Triangle& t : part.triangles)
      all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  return all;
}

void turn_over(Triangle& t) {
  std::swap(t[1], t[2]);
}

void add_backs(TriangleMesh& mesh) {
  const std::vector<Triangle> front = mesh.triangles;
  for (Triangle t : front) {
    turn_over(t);
    mesh.triangles.push_back(t);
  }
}

}  // namespace fascia::testing
