#include "app/model/picking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::app {

namespace {

Vec3 point_at(const std::vector<float>& flat, size_t vertex) {
  return Eigen::Map<const Eigen::Vector3f>(flat.data() + 3 * vertex).cast<double>();
}

bool takes_part(const FacePart& part) {
  return part.part == "skin" || part.part == "face" || part.part == "mouth_interior";
}

/// Möller and Trumbore 1997. Distance along the ray and the weights of the second and third corner.
std::optional<Vec3> meet(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = ray.direction.cross(ac);
  const double determinant = ab.dot(p);
  if (std::abs(determinant) < 1e-16) return std::nullopt;
  const Vec3 t = ray.origin - a;
  const double u = t.dot(p) / determinant;
  if (u < 0.0 || u > 1.0) return std::nullopt;
  const Vec3 q = t.cross(ab);
  const double v = ray.direction.dot(q) / determinant;
  if (v < 0.0 || u + v > 1.0) return std::nullopt;
  const double distance = ac.dot(q) / determinant;
  if (distance <= 0.0) return std::nullopt;
  return Vec3(distance, u, v);
}

}  // namespace

std::optional<SkinHit> pick_skin(const FaceAsset& asset, const FaceFrame& frame, const Ray& ray) {
  std::optional<SkinHit> best;
  for (uint32_t m = 0; m < asset.parts.size(); ++m) {
    const FacePart& part = asset.parts[m];
    if (!takes_part(part)) continue;
    for (size_t t = 0; t < part.triangles.size(); ++t) {
      const Triangle& corners = part.triangles[t];
      Vec3 p[3];
      for (size_t k = 0; k < 3; ++k)
        p[k] = point_at(frame.positions[m], static_cast<size_t>(corners[k]));
      const auto met = meet(ray, p[0], p[1], p[2]);
      if (!met || (best && best->distance <= (*met)[0])) continue;
      const Vec3 weights(1.0 - (*met)[1] - (*met)[2], (*met)[1], (*met)[2]);
      SkinHit hit;
      hit.part = m;
      hit.triangle = static_cast<int>(t);
      hit.distance = (*met)[0];
      hit.position = ray.origin + hit.distance * ray.direction;
      hit.normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
      if (hit.normal.dot(ray.direction) > 0.0) hit.normal = -hit.normal;
      int nearest = 0;
      weights.maxCoeff(&nearest);
      hit.vertex = static_cast<uint32_t>(corners[static_cast<size_t>(nearest)]);
      for (size_t k = 0; k < 3; ++k)
        hit.rest += weights[static_cast<int>(k)] * point_at(part.rest, static_cast<size_t>(corners[k]));
      best = hit;
    }
  }
  return best;
}

SkinHit nearest_skin(const FaceAsset& asset, const FaceFrame& frame, const Vec3& point) {
  SkinHit best;
  double least = 1e300;
  for (uint32_t m = 0; m < asset.parts.size(); ++m) {
    if (!takes_part(asset.parts[m])) continue;
    for (uint32_t v = 0; v < asset.parts[m].vertex_count; ++v) {
      const Vec3 rest = point_at(asset.parts[m].rest, v);
      const double distance = (rest - point).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      best.part = m;
      best.vertex = v;
      best.rest = rest;
    }
  }
  if (best.part < frame.positions.size() && least < 1e300) {
    best.position = point_at(frame.positions[best.part], best.vertex);
    best.normal = point_at(frame.normals[best.part], best.vertex);
  }
  best.distance = std::sqrt(least);
  return best;
}

std::optional<size_t> pick_fibre(const FaceAsset& asset, const FaceFrame& frame, const Vec3& point,
                                 double reach, const std::vector<bool>& is_hidden) {
  std::optional<size_t> best;
  double least = reach;
  for (size_t f = 0; f + 1 < asset.fibre_offsets.size(); ++f) {
    const size_t channel = asset.fibre_channels[f];
    if (channel < is_hidden.size() && is_hidden[channel]) continue;
    for (size_t k = asset.fibre_offsets[f]; k + 1 < asset.fibre_offsets[f + 1]; ++k) {
      const Vec3 a = point_at(frame.fibre_points, k), along = point_at(frame.fibre_points, k + 1) - a;
      const double share =
          std::clamp((point - a).dot(along) / std::max(along.squaredNorm(), 1e-16), 0.0, 1.0);
      const double distance = (a + share * along - point).norm();
      if (distance >= least) continue;
      least = distance;
      best = f;
    }
  }
  return best;
}

std::vector<std::pair<uint32_t, double>> soft_selection(const FaceFrame& frame, uint32_t part,
                                                        uint32_t vertex, double radius, size_t most) {
  std::vector<std::pair<uint32_t, double>> chosen;
  if (part >= frame.positions.size()) return chosen;
  const std::vector<float>& flat = frame.positions[part];
  const Vec3 centre = point_at(flat, vertex);
  for (uint32_t v = 0; v < flat.size() / 3; ++v) {
    const double distance = (point_at(flat, v) - centre).norm() / radius;
    if (distance < 1.0) chosen.emplace_back(v, (1.0 - distance * distance) * (1.0 - distance * distance));
  }
  std::sort(chosen.begin(), chosen.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  if (chosen.size() > most) chosen.resize(most);
  return chosen;
}

}  // namespace fascia::app
