#include "bench/geodesics/head_surface.h"

#include <meshoptimizer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <random>

#include "anatomy/anatomy.h"
#include "builder/smas/smas.h"
#include "geometry/connectivity.h"

namespace fascia::bench {

namespace {

/// The largest part whose triangles hang together by their edges.
TriangleMesh largest_piece(const TriangleMesh& mesh) {
  const std::vector<int> piece = geodesics::make_surface(mesh).piece;
  const int count = *std::max_element(piece.begin(), piece.end()) + 1;
  std::vector<int> size(count);
  for (int p : piece)
    ++size[p];
  const int largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<bool> keep(piece.size());
  for (size_t t = 0; t < piece.size(); ++t)
    keep[t] = piece[t] == largest;
  return submesh(mesh, keep, nullptr);
}

TriangleMesh midpoint_subdivided(const TriangleMesh& mesh) {
  TriangleMesh finer{mesh.vertices, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [entry, added] = middles.try_emplace(std::minmax(a, b), finer.vertex_count());
    if (added) finer.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
    return entry->second;
  };
  for (const Triangle& t : mesh.triangles) {
    const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    finer.triangles.insert(finer.triangles.end(),
                           {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
  }
  return finer;
}

/// Moves every vertex half way to the mean of its neighbours, so that subdivision rounds what it divides.
void smooth(TriangleMesh& mesh) {
  std::vector<Vec3> sum(mesh.vertices.size(), Vec3::Zero());
  std::vector<int> count(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (int e = 0; e < 3; ++e)
      for (int other : {t[(e + 1) % 3], t[(e + 2) % 3]}) {
        sum[t[e]] += mesh.vertices[other];
        ++count[t[e]];
      }
  for (size_t v = 0; v < sum.size(); ++v)
    if (count[v] > 0) mesh.vertices[v] = 0.5 * mesh.vertices[v] + 0.5 * sum[v] / count[v];
}

TriangleMesh simplified(const TriangleMesh& mesh, int triangles) {
  std::vector<float> positions;
  for (const Vec3& p : mesh.vertices)
    for (int i = 0; i < 3; ++i)
      positions.push_back(static_cast<float>(p[i]));
  std::vector<unsigned int> indices, result(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (int corner : t)
      indices.push_back(static_cast<unsigned int>(corner));
  const size_t kept =
      meshopt_simplify(result.data(), indices.data(), indices.size(), positions.data(), mesh.vertices.size(),
                       3 * sizeof(float), 3 * static_cast<size_t>(triangles), 1.f);
  TriangleMesh coarse{mesh.vertices, {}};
  for (size_t i = 0; i < kept; i += 3)
    coarse.triangles.push_back(
        {static_cast<int>(result[i]), static_cast<int>(result[i + 1]), static_cast<int>(result[i + 2])});
  return submesh(coarse, std::vector<bool>(coarse.triangles.size(), true), nullptr);
}

/// `mesh` with about `triangles` triangles of uneven shape, as scans have them.
TriangleMesh resampled(TriangleMesh mesh, int triangles) {
  while (mesh.triangle_count() < 2 * triangles) {
    mesh = midpoint_subdivided(mesh);
    smooth(mesh);
  }
  return largest_piece(simplified(mesh, triangles));
}

}  // namespace

TriangleMesh skin_surface(int triangles) {
  const auto anatomy = anatomy::load_generic();
  return resampled(largest_piece(weld(anatomy.head_object("skin")->mesh, 1e-6, nullptr)), triangles);
}

TriangleMesh smas_surface(int triangles) {
  const auto anatomy = anatomy::load_generic();
  const TriangleMesh skin = weld(anatomy.head_object("skin")->mesh, 1e-6, nullptr);
  smas::Inputs inputs = smas::inputs_from(anatomy);
  inputs.skin = &skin;
  inputs.cranium = &anatomy.skull_object("cranium")->mesh;
  inputs.mandible = &anatomy.skull_object("mandible")->mesh;
  for (const auto& landmark : anatomy.landmarks)
    if (landmark.skin) inputs.landmarks[landmark.name] = *landmark.skin;
  return resampled(largest_piece(smas::build(inputs).mesh), triangles);
}

std::vector<PointPair> muscle_pairs(const TriangleMesh& mesh, int count) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> any(0, mesh.triangle_count() - 1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto face_point = [&] {
    while (true) {
      const int t = any(random);
      const Triangle& c = mesh.triangles[t];
      const Vec3 normal =
          (mesh.vertices[c[1]] - mesh.vertices[c[0]]).cross(mesh.vertices[c[2]] - mesh.vertices[c[0]]);
      double u = unit(random), v = unit(random);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const SurfacePoint point{t, Vec3(1.0 - u - v, u, v)};
      const Vec3 place = position(mesh, point);
      // Before the ears, between chin and hairline, on the outside.
      if (normal.normalized()[2] > 0.2 && place[2] > 0.02 && std::abs(place[1]) < 0.08) return point;
    }
  };
  std::vector<PointPair> pairs;
  while (static_cast<int>(pairs.size()) < count) {
    const PointPair pair{face_point(), face_point()};
    const double apart = (position(mesh, pair.from) - position(mesh, pair.to)).norm();
    if (apart > 0.04 && apart < 0.06) pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace fascia::bench
