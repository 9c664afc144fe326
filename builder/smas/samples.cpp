#include "builder/smas/samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/smas/vertex_grid.h"
#include "geometry/connectivity.h"

namespace fascia::smas {

Bones::Bones(const TriangleMesh* cranium, const TriangleMesh* mandible,
             const std::function<bool(const Vec3&)>& region) {
  for (const TriangleMesh* bone : {cranium, mandible}) {
    if (!bone || bone->empty()) continue;
    std::vector<bool> inside(bone->vertices.size()), keep(bone->triangles.size());
    for (size_t v = 0; v < inside.size(); ++v)
      inside[v] = region(bone->vertices[v]);
    bool any = false;
    for (size_t t = 0; t < keep.size(); ++t) {
      const auto& [a, b, c] = bone->triangles[t];
      keep[t] = inside[a] || inside[b] || inside[c];
      any = any || keep[t];
    }
    if (any) queries_.emplace_back(submesh(*bone, keep, nullptr));
  }
}

double Bones::distance(const Vec3& point, double range) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const spatial::SurfaceQuery& bone : queries_) {
    const spatial::ClosestPoint hit = bone.closest(point, range);
    if (hit.found()) nearest = std::min(nearest, hit.signed_distance);
  }
  return nearest;
}

double Bones::along(const Vec3& origin, const Vec3& direction, double range) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const spatial::SurfaceQuery& bone : queries_)
    if (const auto hit = bone.first_hit(origin, direction, range)) nearest = std::min(nearest, hit->distance);
  return nearest;
}

namespace {

// Normals averaged over the ring twice: the SMAS follows the form of the face, not its pores.
std::vector<Vec3> blended_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals = vertex_normals(mesh);
  for (int round = 0; round < 2; ++round) {
    std::vector<Vec3> sum = normals;
    for (const Triangle& t : mesh.triangles)
      for (int e = 0; e < 3; ++e)
        sum[t[e]] += 0.25 * (normals[t[(e + 1) % 3]] + normals[t[(e + 2) % 3]]);
    for (size_t v = 0; v < sum.size(); ++v)
      if (sum[v].norm() > 1e-9) normals[v] = sum[v].normalized();
  }
  return normals;
}

// Evens out the depths over their neighbourhood, as fascia does over the edges and pits of bone, but never
// beyond what the bone allows.
void smooth_depths(double radius, std::vector<DepthSample>* samples) {
  VertexGrid grid(radius);
  for (const DepthSample& sample : *samples)
    grid.add(sample.skin);
  // The weights are the same in every round.
  std::vector<int> near, neighbours;
  std::vector<double> weights, sums;
  std::vector<size_t> ends;
  for (const DepthSample& sample : *samples) {
    grid.near(sample.skin, radius, &near);
    double sum = 0.0;
    for (int j : near) {
      const DepthSample& other = (*samples)[j];
      const double w = std::max(other.normal.dot(sample.normal), 0.0) *
                       (1.0 - (other.skin - sample.skin).squaredNorm() / (radius * radius));
      neighbours.push_back(j), weights.push_back(w);
      sum += w;
    }
    sums.push_back(sum), ends.push_back(neighbours.size());
  }
  std::vector<double> depths(samples->size());
  for (int round = 0; round < 2; ++round) {
    for (size_t i = 0, k = 0; i < samples->size(); ++i) {
      double sum = 0.0;
      for (; k < ends[i]; ++k)
        sum += weights[k] * (*samples)[neighbours[k]].depth;
      depths[i] = std::clamp(sum / sums[i], (*samples)[i].least, (*samples)[i].most);
    }
    for (size_t i = 0; i < samples->size(); ++i)
      (*samples)[i].depth = depths[i];
  }
  for (DepthSample& sample : *samples)
    sample.zero = sample.skin - sample.depth * sample.normal;
}

}  // namespace

std::vector<DepthSample> depth_samples(const FacialSkin& face, const Bones& bones, const LayerDepth& layers,
                                       double scale, double spacing) {
  const std::vector<Vec3> normals = blended_normals(face.mesh);
  const double far = 0.045 * scale;  // farther bone is not under this skin
  VertexGrid grid(spacing);
  std::vector<int> near;
  std::vector<DepthSample> samples;
  const auto add = [&](const Vec3& at, const Vec3& normal) {
    grid.near(at, spacing, &near);
    for (int i : near)
      if (samples[i].normal.dot(normal) > 0.3) return;
    DepthSample sample;
    sample.skin = at;
    sample.normal = normal;
    // The ray may slip past an edge of the bone that is nearer than what it meets: then that counts.
    const double ray = bones.along(at, -normal, far);
    const double closest = bones.distance(at, std::isfinite(ray) ? ray : far);
    const double to_bone = std::isfinite(ray) ? std::min(ray, 1.25 * std::max(closest, 0.0)) : ray;
    sample.depth = layers.depth(at, to_bone);
    // Beside an edge of the bone the free depth must not reach into it.
    const double room = std::isfinite(to_bone) ? to_bone : std::max(closest, 0.0);
    sample.most = layers.limits().end * room;
    sample.least = std::isfinite(to_bone) ? layers.limits().begin * to_bone : 0.0;
    sample.depth = std::min(sample.depth, sample.most);
    samples.push_back(sample);
    grid.add(at);
  };
  for (size_t v = 0; v < face.mesh.vertices.size(); ++v)
    if (normals[v].norm() > 0.5) add(face.mesh.vertices[v], normals[v]);
  // Faces much larger than the spacing get points inside as well.
  for (const Triangle& t : face.mesh.triangles) {
    const Vec3 &a = face.mesh.vertices[t[0]], &b = face.mesh.vertices[t[1]], &c = face.mesh.vertices[t[2]];
    const double longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
    const int parts = std::min(static_cast<int>(longest / (1.5 * spacing)) + 1, 24);
    for (int i = 0; parts > 1 && i <= parts; ++i)
      for (int j = 0; j <= parts - i; ++j) {
        const double u = double(i) / parts, v = double(j) / parts;
        const Vec3 normal = u * normals[t[0]] + v * normals[t[1]] + (1 - u - v) * normals[t[2]];
        if (normal.norm() > 0.2) add(u * a + v * b + (1 - u - v) * c, normal.normalized());
      }
  }
  smooth_depths(3.0 * spacing, &samples);
  return samples;
}

}  // namespace fascia::smas
