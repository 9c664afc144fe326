#include "view/face/moving_anatomy.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fascia::view {

namespace {

constexpr double near = 0.012, far = 0.030;  // metres: an anchor's whole displacement, none of it

std::vector<Vec3> points_of(const std::vector<rig::Vec3f>& from) {
  std::vector<Vec3> points;
  points.reserve(from.size());
  for (const rig::Vec3f& p : from)
    points.push_back(p.cast<double>());
  return points;
}

double distance_to(const std::vector<rig::Vec3f>& surface, const Vec3& p) {
  float least = std::numeric_limits<float>::max();
  const rig::Vec3f at = p.cast<float>();
  for (const rig::Vec3f& q : surface)
    least = std::min(least, (q - at).squaredNorm());
  return static_cast<double>(least);
}

std::vector<Vec3> smas_layer(const std::vector<Vec3>& nodes, size_t columns) {
  const auto first = nodes.begin() + static_cast<std::ptrdiff_t>(columns);
  return {first, first + static_cast<std::ptrdiff_t>(columns)};
}

}  // namespace

Following::Following(std::vector<Vec3> anchors, std::vector<Vec3> points, size_t nearest)
    : anchors_(std::move(anchors)), points_(std::move(points)), shares_(points_.size()) {
  // One more than are followed: at its distance the weight is zero, so that the field has no steps.
  const size_t kept = std::min(nearest + 1, anchors_.size());
  std::vector<std::pair<double, size_t>> found(anchors_.size());
  for (size_t p = 0; p < points_.size() && kept > 0; ++p) {
    for (size_t a = 0; a < anchors_.size(); ++a)
      found[a] = {(anchors_[a] - points_[p]).squaredNorm(), a};
    const auto end = found.begin() + static_cast<std::ptrdiff_t>(kept);
    std::partial_sort(found.begin(), end, found.end());
    const double reach = std::sqrt(found[kept - 1].first) + 1e-9, least = std::sqrt(found[0].first);
    const double fade = std::clamp((far - least) / (far - near), 0.0, 1.0);
    double sum = 0.0;
    for (size_t k = 0; k < std::min(nearest, kept); ++k) {
      const double distance = std::sqrt(found[k].first) + 1e-7;
      const double falling = std::max(reach - distance, 1e-9) / (reach * distance);
      shares_[p].push_back({found[k].second, falling * falling});
      sum += falling * falling;
    }
    for (Share& share : shares_[p])
      share.weight *= fade / sum;
  }
}

std::vector<Vec3> Following::at(const std::vector<Vec3>& now) const {
  std::vector<Vec3> points = points_;
  if (now.size() != anchors_.size()) return points;
  for (size_t p = 0; p < points.size(); ++p)
    for (const Share& share : shares_[p])
      points[p] += share.weight * (now[share.anchor] - anchors_[share.anchor]);
  return points;
}

MovingAnatomy::MovingAnatomy(const rig::Rig& rig, std::vector<Vec3> skin)
    : rig_(rig), skin_(std::move(skin)) {}

std::vector<Vec3> MovingAnatomy::smas(const Lattice& now) const {
  const auto level = std::find_if(rig_.tissue.levels.begin(), rig_.tissue.levels.end(),
                                  [&](const rig::TissueLevel& one) { return one.columns == now.columns; });
  if (now.empty() || level == rig_.tissue.levels.end() || level->rest.size() != 3 * now.columns)
    return points_of(rig_.smas.surface.positions);
  if (!smas_ || smas_columns_ != now.columns) {
    const size_t neighbours = 5;
    smas_.emplace(smas_layer(points_of(level->rest), now.columns), points_of(rig_.smas.surface.positions),
                  neighbours);
    smas_columns_ = now.columns;
  }
  return smas_->at(smas_layer(now.nodes, now.columns));
}

MovingAnatomy::Bands MovingAnatomy::bind(std::vector<Vec3> bone, std::vector<Vec3> skin) const {
  Bands bands;
  for (const Vec3& p : bone)
    bands.is_on_mandible.push_back(distance_to(rig_.skull.mandible.positions, p) <
                                   distance_to(rig_.skull.cranium.positions, p));
  bands.bone = std::move(bone);
  bands.skin.emplace(skin_, std::move(skin), 3);
  return bands;
}

std::vector<MovingAnatomy::Band> MovingAnatomy::moved(const Bands& bands, const std::vector<Vec3>& skin,
                                                      const Mat4& jaw) {
  const std::vector<Vec3> ends = bands.skin->at(skin);
  std::vector<Band> moved;
  for (size_t i = 0; i < ends.size(); ++i)
    moved.push_back({bands.is_on_mandible[i] ? transform_point(jaw, bands.bone[i]) : bands.bone[i], ends[i]});
  return moved;
}

template <class Ends>
const MovingAnatomy::Bands& MovingAnatomy::bound(std::optional<Bands>& bands,
                                                 const std::vector<Ends>& rest) const {
  if (bands) return *bands;
  std::vector<Vec3> bone, outer;
  for (const Ends& ends : rest) {
    bone.push_back(ends.bone.template cast<double>());
    outer.push_back(ends.skin.template cast<double>());
  }
  bands = bind(std::move(bone), std::move(outer));
  return *bands;
}

std::vector<MovingAnatomy::Band> MovingAnatomy::ligaments(const std::vector<Vec3>& skin,
                                                          const Mat4& jaw) const {
  return moved(bound(ligaments_, rig_.smas.ligaments), skin, jaw);
}

std::vector<MovingAnatomy::Band> MovingAnatomy::landmarks(const std::vector<Vec3>& skin,
                                                          const Mat4& jaw) const {
  return moved(bound(landmarks_, rig_.skull.landmarks), skin, jaw);
}

}  // namespace fascia::view
