#include "view/smooth_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace fascia::view {

std::vector<int> seams_of(const std::vector<Vec3>& positions) {
  std::vector<int> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](int a, int b) {
    const Vec3 &p = positions[static_cast<size_t>(a)], &q = positions[static_cast<size_t>(b)];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::stable_sort(order.begin(), order.end(), before);
  for (size_t i = 0; i < order.size(); ++i) {
    const size_t v = static_cast<size_t>(order[i]);
    const bool is_same = i > 0 && !before(order[i - 1], order[i]) && positions[v].allFinite();
    first[v] = is_same ? first[static_cast<size_t>(order[i - 1])] : order[i];
  }
  return first;
}

std::vector<Vec3> smooth_normals(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                 const std::vector<int>& seams) {
  std::vector<Vec3> normals(positions.size(), Vec3::Zero());
  const auto at = [&](int v) -> const Vec3& { return positions[static_cast<size_t>(v)]; };
  for (const Triangle& t : triangles) {
    const Vec3 edges[3] = {(at(t[1]) - at(t[0])).normalized(), (at(t[2]) - at(t[1])).normalized(),
                           (at(t[0]) - at(t[2])).normalized()};
    const Vec3 normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
    for (size_t k = 0; k < 3; ++k) {
      const double angle = std::acos(std::clamp(-edges[k].dot(edges[(k + 2) % 3]), -1.0, 1.0));
      normals[static_cast<size_t>(seams[static_cast<size_t>(t[k])])] += angle * normal;
    }
  }
  for (size_t v = 0; v < normals.size(); ++v)
    if (static_cast<size_t>(seams[v]) == v) normals[v].normalize();
  for (size_t v = 0; v < normals.size(); ++v)
    normals[v] = normals[static_cast<size_t>(seams[v])];
  return normals;
}

}  // namespace fascia::view
