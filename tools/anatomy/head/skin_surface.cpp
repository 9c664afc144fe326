#include "tools/anatomy/head/skin_surface.h"

#include <cmath>

namespace fascia::head_maker {

namespace {
constexpr double kCell = 12.0;  // mm; wider than the reach of the widest kernel
}

SkinSurface::SkinSurface(const std::vector<Sample>& samples) : samples_(samples) {
  const Vec3 mirror(-1, 1, 1);
  for (const Sample& sample : samples)
    if (sample.position.x() < 30.0)
      samples_.push_back(
          {sample.position.cwiseProduct(mirror), sample.normal.cwiseProduct(mirror), sample.spacing});
  Bounds box;
  for (const Sample& sample : samples_) {
    box.lower = box.lower.cwiseMin(sample.position);
    box.upper = box.upper.cwiseMax(sample.position);
  }
  lower_ = box.lower - Vec3::Constant(kCell);
  cells_ = ((box.upper - lower_) / kCell).cast<int>() + Eigen::Vector3i::Constant(2);
  bins_.resize(static_cast<std::size_t>(cells_.prod()));
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Eigen::Vector3i c = ((samples_[i].position - lower_) / kCell).cast<int>();
    bins_[(c.x() * cells_.y() + c.y()) * cells_.z() + c.z()].push_back(static_cast<int>(i));
  }
}

template <typename Visit>
void SkinSurface::visit_near(const Vec3& point, const Visit& visit) const {
  const Eigen::Vector3i centre = ((point - lower_) / kCell).array().floor().cast<int>();
  for (int x = centre.x() - 1; x <= centre.x() + 1; ++x)
    for (int y = centre.y() - 1; y <= centre.y() + 1; ++y)
      for (int z = centre.z() - 1; z <= centre.z() + 1; ++z) {
        if (x < 0 || y < 0 || z < 0 || x >= cells_.x() || y >= cells_.y() || z >= cells_.z()) continue;
        for (int i : bins_[(x * cells_.y() + y) * cells_.z() + z])
          visit(samples_[i]);
      }
}

const Sample* SkinSurface::nearest(const Vec3& point, const Vec3& normal) const {
  const Sample* best = nullptr;
  double least = 1e300;
  for (const Sample& sample : samples_) {
    const double against = std::max(0.0, 0.3 - sample.normal.dot(normal));
    const double distance = (sample.position - point).squaredNorm() * (1.0 + 8.0 * against * against);
    if (distance < least) {
      least = distance;
      best = &sample;
    }
  }
  return best;
}

Vec3 SkinSurface::project(const Vec3& point, const Vec3& normal) const {
  Vec3 here = point;
  const Vec3 facing = normal.norm() > 0.0 ? Vec3(normal.normalized()) : Vec3::Zero();
  const Sample* start = nearest(here, facing);
  if ((start->position - here).norm() > 5.0)
    here = start->position +
           0.7 * ((here - start->position) - start->normal * start->normal.dot(here - start->position));
  Vec3 local = start->normal;
  for (int iteration = 0; iteration < 6; ++iteration) {
    double total = 0.0, distance = 0.0;
    Vec3 mean = Vec3::Zero();
    const auto weight = [&](const Sample& sample) {
      const double h = 0.8 * sample.spacing;
      const double agree = std::max(0.0, sample.normal.dot(local));
      return std::exp(-(sample.position - here).squaredNorm() / (h * h)) * agree * agree;
    };
    visit_near(here, [&](const Sample& sample) { mean += weight(sample) * sample.normal; });
    if (mean.norm() < 1e-12) {
      const Sample* near = nearest(here, local);
      here = here - near->normal * near->normal.dot(here - near->position);
      if ((near->position - here).norm() > 8.0) here = near->position;
      continue;
    }
    local = mean.normalized();
    visit_near(here, [&](const Sample& sample) {
      const double w = weight(sample);
      total += w;
      distance += w * 0.5 * (sample.normal + local).dot(here - sample.position);
    });
    if (total < 1e-12) break;
    here -= local * (distance / total);
  }
  return here;
}

}  // namespace fascia::head_maker
