#pragma once

#include <optional>
#include <vector>

#include "app/engine/face_session.h"
#include "app/model/orbit.h"

namespace fascia::app {

/// Where a ray meets the face as it stands.
struct SkinHit {
  uint32_t part = 0;  ///< of FaceAsset::parts
  int triangle = -1;
  uint32_t vertex = 0;                                   ///< the triangle's nearest
  Vec3 position = Vec3::Zero(), normal = Vec3::UnitZ();  ///< metres; unit, toward the ray's origin
  double distance = 0.0;
  Vec3 rest = Vec3::Zero();  ///< the same point of the surface at rest
};

/// The first hit of `ray` on any part that takes part: the eyes and transparent cards do not.
std::optional<SkinHit> pick_skin(const FaceAsset& asset, const FaceFrame& frame, const Ray& ray);

/// The vertex of the skin at rest that is nearest to `point`.
SkinHit nearest_skin(const FaceAsset& asset, const FaceFrame& frame, const Vec3& point);

/// Index of the fibre that passes nearest to `point` as the face stands, when one is within `reach` metres.
/// Fibres of channels whose `is_hidden` is set are passed over; that list may be empty.
std::optional<size_t> pick_fibre(const FaceAsset& asset, const FaceFrame& frame, const Vec3& point,
                                 double reach, const std::vector<bool>& is_hidden);

/// Vertices of the part within `radius` of `vertex` as the face stands, with a share that falls from 1 to 0;
/// the nearest `most` of them.
std::vector<std::pair<uint32_t, double>> soft_selection(const FaceFrame& frame, uint32_t part,
                                                        uint32_t vertex, double radius, size_t most);

}  // namespace fascia::app
