#include "builder/landmarks/searched_surface.h"

#include <algorithm>
#include <cmath>

#include "builder/landmarks/spheres.h"

namespace fascia::landmarks {

namespace {
constexpr int sample_count = 8000, patch_count = 5000;
constexpr double wider = 1.9;  // from the vault of a head to all of it
}  // namespace

SearchedSurface::SearchedSurface(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  query_.emplace(mesh_);
  Samples even = sample_evenly(mesh_, sample_count);
  is_inside_out_ = landmarks::is_inside_out(even, *query_);
  if (is_inside_out_) {
    for (Triangle& t : mesh_.triangles)
      std::swap(t[1], t[2]);
    query_.emplace(mesh_);
    for (Vec3& n : even.normals)
      n = -n;
  }
  open_ = open_samples(even, *query_);
  extent_ = bounds(even.points).size().norm();
  all_ = fit_ball(open_.points);
}

const Neighbours& SearchedSurface::about(const Ball& ball) {
  for (const Patch& patch : patches_)
    if ((patch.ball.centre - ball.centre).norm() < 0.3 * ball.radius &&
        std::abs(std::log(patch.ball.radius / ball.radius)) < 0.3)
      return patch.samples;
  const Ball whole{ball.centre, wider * ball.radius};
  patches_.push_back({ball, Neighbours(open_samples(sample_evenly(mesh_, patch_count, whole), *query_))});
  return patches_.back().samples;
}

}  // namespace fascia::landmarks
