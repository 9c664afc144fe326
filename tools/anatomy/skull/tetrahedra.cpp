#include "tools/anatomy/skull/tetrahedra.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "geometry/connectivity.h"

namespace fascia::skull_maker {
namespace {

/// Nodes of a regular grid over the left half; x starts at -2 cells so that a plane of nodes is x = 0.
struct Grid {
  Vec3 origin = Vec3::Zero();
  double cell = 0;
  std::array<int, 3> count{};
  std::vector<double> values;  ///< not a number where nothing is known

  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(count[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(count[2]) +
           static_cast<std::size_t>(k);
  }
  Vec3 node(std::size_t at) const {
    const auto k = at % static_cast<std::size_t>(count[2]);
    const auto j = at / static_cast<std::size_t>(count[2]) % static_cast<std::size_t>(count[1]);
    const auto i = at / static_cast<std::size_t>(count[2]) / static_cast<std::size_t>(count[1]);
    return origin + cell * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  }
};

Grid sample(const smas::ImplicitFunction& field, const std::vector<Vec3>& points, double reach, double cell) {
  const Bounds box = bounds(points);
  Grid grid;
  grid.cell = cell;
  grid.origin = box.lower - Vec3::Constant(reach + cell);
  grid.origin.x() = -2 * cell;
  for (int a = 0; a < 3; ++a) {
    grid.count[static_cast<std::size_t>(a)] =
        2 + static_cast<int>((box.upper[a] + reach + cell - grid.origin[a]) / cell);
  }
  const std::size_t size = grid.index(grid.count[0] - 1, grid.count[1] - 1, grid.count[2] - 1) + 1;
  std::vector<bool> near(size, false);
  for (const Vec3& point : points) {
    std::array<int, 3> low{};
    std::array<int, 3> high{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = point[static_cast<int>(a)] - grid.origin[static_cast<int>(a)];
      low[a] = std::max(0, static_cast<int>(std::ceil((at - reach) / cell)));
      high[a] = std::min(grid.count[a] - 1, static_cast<int>((at + reach) / cell));
    }
    for (int i = low[0]; i <= high[0]; ++i) {
      for (int j = low[1]; j <= high[1]; ++j) {
        for (int k = low[2]; k <= high[2]; ++k)
          near[grid.index(i, j, k)] = true;
      }
    }
  }
  grid.values.assign(size, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t at = 0; at < size; ++at) {
    if (!near[at]) continue;
    grid.values[at] = field(grid.node(at), nullptr);
    if (std::abs(grid.values[at]) < 1e-6) grid.values[at] = 1e-6;
  }
  return grid;
}

/// Where the surface runs out of the known nodes between sparse points, the nodes of the cubes that it leaves
/// by become known too, a few cells deep: without them it would have pinholes.
void follow_surface(const smas::ImplicitFunction& field, Grid& grid) {
  constexpr int deepest = 4;  // cells
  for (int round = 0; round < deepest; ++round) {
    std::vector<std::size_t> missing;
    for (int i = 0; i + 1 < grid.count[0]; ++i) {
      for (int j = 0; j + 1 < grid.count[1]; ++j) {
        for (int k = 0; k + 1 < grid.count[2]; ++k) {
          bool inside = false;
          bool outside = false;
          std::vector<std::size_t> unknown;
          for (int corner = 0; corner < 8; ++corner) {
            const std::size_t at = grid.index(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
            const double value = grid.values[at];
            if (!std::isfinite(value)) unknown.push_back(at);
            inside = inside || value < 0;
            outside = outside || value > 0;
          }
          if (inside && outside) missing.insert(missing.end(), unknown.begin(), unknown.end());
        }
      }
    }
    if (missing.empty()) return;
    for (const std::size_t at : missing) {
      grid.values[at] = field(grid.node(at), nullptr);
      if (std::abs(grid.values[at]) < 1e-6) grid.values[at] = 1e-6;
    }
  }
}

struct Marcher {
  const Grid& grid;
  TriangleMesh mesh;
  std::map<std::pair<std::size_t, std::size_t>, int> cuts;

  int cut(std::size_t a, std::size_t b) {
    if (a > b) std::swap(a, b);
    const auto [found, fresh] = cuts.try_emplace({a, b}, mesh.vertex_count());
    if (fresh) {
      const double t = std::clamp(grid.values[a] / (grid.values[a] - grid.values[b]), 0.02, 0.98);
      mesh.vertices.push_back((1 - t) * grid.node(a) + t * grid.node(b));
    }
    return found->second;
  }

  /// A triangle whose normal leads from `inside` to `outside`.
  void add(Triangle t, const Vec3& outwards) {
    const auto at = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
    if ((at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).dot(outwards) < 0) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }

  void tetrahedron(const std::array<std::size_t, 4>& corners) {
    std::vector<std::size_t> in;
    std::vector<std::size_t> out;
    for (const std::size_t c : corners) {
      if (!std::isfinite(grid.values[c])) return;
      (grid.values[c] < 0 ? in : out).push_back(c);
    }
    if (in.empty() || out.empty()) return;
    Vec3 outwards = Vec3::Zero();
    for (const std::size_t c : out)
      outwards += grid.node(c) / static_cast<double>(out.size());
    for (const std::size_t c : in)
      outwards -= grid.node(c) / static_cast<double>(in.size());
    if (in.size() == 2) {
      const int a = cut(in[0], out[0]);
      const int b = cut(in[0], out[1]);
      const int c = cut(in[1], out[1]);
      const int d = cut(in[1], out[0]);
      add({a, b, c}, outwards);
      add({a, c, d}, outwards);
    } else if (in.size() == 1) {
      add({cut(in[0], out[0]), cut(in[0], out[1]), cut(in[0], out[2])}, outwards);
    } else {
      add({cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0])}, outwards);
    }
  }

  /// Kuhn's six tetrahedra of a cube: one for each order in which the axes are walked.
  void cube(int i, int j, int k) {
    static constexpr std::array<std::array<int, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (const auto& order : orders) {
      std::array<int, 3> at{i, j, k};
      std::array<std::size_t, 4> corners{grid.index(i, j, k), 0, 0, 0};
      for (std::size_t step = 0; step < 3; ++step) {
        ++at[static_cast<std::size_t>(order[step])];
        corners[step + 1] = grid.index(at[0], at[1], at[2]);
      }
      tetrahedron(corners);
    }
  }
};

}  // namespace

TriangleMesh march_tetrahedra(const smas::ImplicitFunction& field, const std::vector<Vec3>& points,
                              double reach, double cell) {
  Grid grid = sample(field, points, reach, cell);
  follow_surface(field, grid);
  Marcher marcher{grid, {}, {}};
  for (int i = 0; i + 1 < grid.count[0]; ++i) {
    for (int j = 0; j + 1 < grid.count[1]; ++j) {
      for (int k = 0; k + 1 < grid.count[2]; ++k)
        marcher.cube(i, j, k);
    }
  }
  const std::vector<int> part = components(marcher.mesh);
  int highest = 0;
  double height = -1e300;
  for (int t = 0; t < marcher.mesh.triangle_count(); ++t) {
    const auto at = static_cast<std::size_t>(t);
    const double y = marcher.mesh.vertices[static_cast<std::size_t>(marcher.mesh.triangles[at][0])].y();
    if (y > height) {
      height = y;
      highest = part[at];
    }
  }
  std::vector<bool> keep;
  for (const int p : part)
    keep.push_back(p == highest);
  std::vector<int> map;
  return submesh(marcher.mesh, keep, &map);
}

}  // namespace fascia::skull_maker
