#pragma once

#include <meshoptimizer.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "formats/scene.h"

namespace fascia::testing {

/// Leaves about `triangles` of the mesh's triangles, by edge collapses; vertices stay, some unused.
inline void simplify(formats::SceneMesh& mesh, size_t triangles) {
  std::vector<float> positions;
  std::vector<unsigned> indices;
  for (const Vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis)
      positions.push_back(static_cast<float>(p[axis]));
  for (const Triangle& t : mesh.triangles)
    for (int v : t)
      indices.push_back(static_cast<unsigned>(v));
  indices.resize(meshopt_simplify(indices.data(), indices.data(), indices.size(), positions.data(),
                                  mesh.positions.size(), 12, 3 * triangles, 1.0f));
  mesh.triangles.clear();
  for (size_t i = 0; i + 2 < indices.size(); i += 3)
    mesh.triangles.push_back(
        {static_cast<int>(indices[i]), static_cast<int>(indices[i + 1]), static_cast<int>(indices[i + 2])});
}

/// Cuts every triangle into four at the middles of its edges.
inline void subdivide(formats::SceneMesh& mesh) {
  std::map<std::pair<int, int>, int> middles;
  std::vector<Triangle> finer;
  const auto middle = [&](int a, int b) {
    const auto [at, is_new] =
        middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(mesh.positions.size()));
    if (is_new) {
      const Vec3 between =
          0.5 * (mesh.positions[static_cast<size_t>(a)] + mesh.positions[static_cast<size_t>(b)]);
      mesh.positions.push_back(between);
    }
    return at->second;
  };
  for (const Triangle& t : mesh.triangles) {
    const int x = middle(t[0], t[1]), y = middle(t[1], t[2]), z = middle(t[2], t[0]);
    finer.insert(finer.end(), {{t[0], x, z}, {t[1], y, x}, {t[2], z, y}, {x, y, z}});
  }
  mesh.triangles = std::move(finer);
}

}  // namespace fascia::testing
