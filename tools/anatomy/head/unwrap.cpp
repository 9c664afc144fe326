#include <Eigen/Geometry>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "geometry/error.h"
#include "tools/anatomy/head/head.h"

// Convex-combination maps: the boundary of a disc goes to a convex curve, every inner vertex to a mean of its
// neighbours with mean-value weights, so that nothing overlaps (Tutte 1963; Floater 2003, Mean value
// coordinates).

namespace fascia::head_maker {

namespace {

using Chart = std::map<int, Vec2>;  // vertex to texture coordinate

std::vector<Triangle> triangles_of(const HalfHead& half, const std::vector<int>& faces) {
  std::vector<Triangle> out;
  for (int f : faces) {
    const Quad& q = half.quads[f];
    out.push_back({q[0], q[1], q[2]});
    if (q[2] != q[3]) out.push_back({q[0], q[2], q[3]});
  }
  return out;
}

/// The one boundary loop of a disc, starting at its smallest vertex index that `first` accepts.
std::vector<int> boundary_of(const std::vector<Triangle>& triangles,
                             const std::function<bool(int, int)>& first) {
  std::map<std::pair<int, int>, int> edges;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k)
      edges[{t[k], t[(k + 1) % 3]}] = 1;
  std::map<int, int> next;
  for (const auto& [edge, _] : edges)
    if (!edges.count({edge.second, edge.first})) next[edge.first] = edge.second;
  if (next.empty()) throw Error("head: an island of the texture chart has no boundary");
  int start = next.begin()->first;
  for (const auto& [a, b] : next)
    if (first(a, b)) {
      start = a;
      break;
    }
  std::vector<int> loop = {start};
  for (int v = next.at(start); v != start; v = next.at(v))
    loop.push_back(v);
  if (loop.size() != next.size()) throw Error("head: an island of the texture chart is not a disc");
  return loop;
}

double half_angle_tangent(const Vec3& at, const Vec3& a, const Vec3& b) {
  const Vec3 u = (a - at).normalized(), v = (b - at).normalized();
  return u.cross(v).norm() / std::max(1e-9, 1.0 + u.dot(v));
}

Chart flatten(const HalfHead& half, const std::vector<Triangle>& triangles, const Chart& boundary) {
  std::map<std::pair<int, int>, double> weight;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int at = t[k], a = t[(k + 1) % 3], b = t[(k + 2) % 3];
      const auto& v = half.vertices;
      const double tangent = std::max(1e-4, half_angle_tangent(v[at], v[a], v[b]));
      weight[{at, a}] += tangent / std::max(1e-6, (v[a] - v[at]).norm());
      weight[{at, b}] += tangent / std::max(1e-6, (v[b] - v[at]).norm());
    }
  std::map<int, int> row;
  for (const auto& [edge, _] : weight)
    if (!boundary.count(edge.first)) row.try_emplace(edge.first, static_cast<int>(row.size()));
  const int n = static_cast<int>(row.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
  for (const auto& [edge, w] : weight) {
    const auto r = row.find(edge.first);
    if (r == row.end()) continue;
    entries.emplace_back(r->second, r->second, w);
    const auto fixed = boundary.find(edge.second);
    if (fixed != boundary.end())
      right.row(r->second) += w * fixed->second.transpose();
    else
      entries.emplace_back(r->second, row.at(edge.second), -w);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) throw Error("head: the texture chart cannot be solved");
  const Eigen::MatrixXd solution = solver.solve(right);
  Chart out = boundary;
  for (const auto& [vertex, r] : row)
    out[vertex] = solution.row(r);
  return out;
}

/// Shares of the way along a loop part, 0 at its first vertex, 1 at its last.
std::vector<double> shares(const std::vector<double>& steps) {
  std::vector<double> out = {0.0};
  for (double step : steps)
    out.push_back(out.back() + step);
  for (double& s : out)
    s /= out.back();
  return out;
}

struct Disc {
  Vec2 centre;
  double radius;
};

/// An island on a disc; a half island, cut by the midline, on its right half.
Chart island(const HalfHead& half, const std::vector<int>& faces, const Disc& disc) {
  const auto triangles = triangles_of(half, faces);
  // A half island starts where its boundary leaves the midline.
  const auto loop = boundary_of(triangles, [&](int a, int b) { return half.midline[a] && !half.midline[b]; });
  const bool cut = half.midline[loop.front()];
  const int n = static_cast<int>(loop.size());
  Chart boundary;
  if (!cut) {
    for (int k = 0; k < n; ++k) {
      const double turn = 2.0 * std::numbers::pi * k / n;
      boundary[loop[k]] = disc.centre + disc.radius * Vec2(std::cos(turn), std::sin(turn));
    }
    return flatten(half, triangles, boundary);
  }
  int end = 1;
  while (!half.midline[loop[end]])
    ++end;
  const bool upward = half.vertices[loop[end]].y() > half.vertices[loop[0]].y();
  for (int k = 0; k <= end; ++k) {
    const double turn = std::numbers::pi * (static_cast<double>(k) / end - 0.5) * (upward ? 1.0 : -1.0);
    boundary[loop[k]] = disc.centre + disc.radius * Vec2(std::max(0.0, std::cos(turn)), std::sin(turn));
  }
  boundary[loop[0]].x() = boundary[loop[end]].x() = disc.centre.x();
  for (int k = end + 1; k < n; ++k) {
    const double t = static_cast<double>(k - end) / (n - end);
    boundary[loop[k]] = (1 - t) * boundary[loop[end]] + t * boundary[loop[0]];
  }
  return flatten(half, triangles, boundary);
}

/// The face: its midline up the straight side of a half ellipse, its oval along the arc. It is flattened with
/// its cavities in it, so that it is a disc; the way through the mouth counts for little.
Chart face(const HalfHead& half, const std::vector<int>& faces, const std::vector<char>& in_mouth) {
  const auto triangles = triangles_of(half, faces);
  const auto loop = boundary_of(triangles, [&](int a, int b) { return half.midline[a] && !half.midline[b]; });
  int end = 1;
  while (!half.midline[loop[end]])
    ++end;
  const int n = static_cast<int>(loop.size());
  const auto step = [&](int k) {
    const int a = loop[k % n], b = loop[(k + 1) % n];
    return (half.vertices[a] - half.vertices[b]).norm() * (in_mouth[a] && in_mouth[b] ? 0.01 : 1.0);
  };
  std::vector<double> oval, middle;
  for (int k = 0; k < end; ++k)
    oval.push_back(step(k));
  for (int k = end; k < n; ++k)
    middle.push_back(step(k));
  const auto around = shares(oval), along = shares(middle);
  const bool from_below = half.vertices[loop[0]].y() < half.vertices[loop[end]].y();
  const double low = 0.01, high = 0.75, width = 0.29, centre = 0.5 * (low + high), tall = 0.5 * (high - low);
  Chart boundary;
  for (int k = 0; k <= end; ++k) {
    const double turn = std::numbers::pi * (around[k] - 0.5) * (from_below ? 1.0 : -1.0);
    boundary[loop[k]] = Vec2(0.5 + width * std::cos(turn), centre + tall * std::sin(turn));
  }
  boundary[loop[0]].x() = boundary[loop[end]].x() = 0.5;
  for (int k = end + 1; k < n; ++k) {
    const double t = along[k - end];
    boundary[loop[k]] = (1 - t) * boundary[loop[end]] + t * boundary[loop[0]];
  }
  return flatten(half, triangles, boundary);
}

/// Scalp and neck of one side, on an ellipse beside the face: the hairline at the top.
Chart scalp_and_neck(const HalfHead& half, const std::vector<int>& faces) {
  const auto triangles = triangles_of(half, faces);
  const auto loop = boundary_of(triangles, [&](int a, int b) {
    return !half.midline[a] && half.midline[b] && half.vertices[a].y() > 50.0;
  });
  std::vector<double> steps;
  for (std::size_t k = 0; k < loop.size(); ++k)
    steps.push_back((half.vertices[loop[k]] - half.vertices[loop[(k + 1) % loop.size()]]).norm());
  const auto around = shares(steps);
  Chart boundary;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const double turn = std::numbers::pi * (0.5 + 2.0 * around[k]);
    boundary[loop[k]] = Vec2(0.895 + 0.095 * std::cos(turn), 0.38 + 0.37 * std::sin(turn));
  }
  return flatten(half, triangles, boundary);
}

}  // namespace

std::vector<std::array<Vec2, 4>> unwrap(const HalfHead& half) {
  const std::map<std::string, Disc> discs = {{"ear_left", {{0.88, 0.88}, 0.11}},
                                             {"conjunctiva_left", {{0.67, 0.88}, 0.075}},
                                             {"nostril_left", {{0.75, 0.965}, 0.03}},
                                             {"mouth_lining", {{0.5, 0.88}, 0.085}}};
  const auto behind = [](const std::string& name) {
    return name == "scalp" || name == "neck" || name == "submental";
  };
  std::map<std::string, std::vector<int>> faces;
  std::vector<int> front, back;
  std::vector<char> in_mouth(half.vertices.size(), 0);
  for (std::size_t f = 0; f < half.quads.size(); ++f) {
    const std::string& name = half.region[f];
    const int index = static_cast<int>(f);
    if (discs.count(name)) faces[name].push_back(index);
    if (behind(name))
      back.push_back(index);
    else if (name != "ear_left")
      front.push_back(index);
    if (name == "mouth_lining")
      for (int v : half.quads[f])
        in_mouth[v] = 1;
  }
  std::map<std::string, Chart> charts;
  for (const auto& [name, disc] : discs)
    charts[name] = island(half, faces.at(name), disc);
  const Chart front_chart = face(half, front, in_mouth), back_chart = scalp_and_neck(half, back);
  std::vector<std::array<Vec2, 4>> out;
  for (std::size_t f = 0; f < half.quads.size(); ++f) {
    const auto own = charts.find(half.region[f]);
    const Chart& chart = own != charts.end()      ? own->second
                         : behind(half.region[f]) ? back_chart
                                                  : front_chart;
    std::array<Vec2, 4> corners;
    for (int k = 0; k < 4; ++k)
      corners[k] = chart.at(half.quads[f][k]);
    out.push_back(corners);
  }
  return out;
}

}  // namespace fascia::head_maker
