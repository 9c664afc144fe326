#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "builder/landmarks/placement.h"
#include "geometry/alignment.h"

namespace fascia::landmarks {

namespace {

constexpr double nose_radius = 0.025;  // metres of the generic head

/// A place that stands out of its surroundings, and which way.
struct Protrusion {
  Vec3 tip, direction;
  double height = 0.0;  ///< above the middle of what is around, as a share of the radius looked at; 0 for
                        ///< hollows and rims
};

Protrusion protrusion_at(const Neighbours& samples, const Vec3& tip, double radius) {
  static thread_local std::vector<size_t> near;
  samples.within(tip, radius, near);
  Protrusion found{tip, Vec3::UnitZ(), 0.0};
  if (near.size() < 8) return found;
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
  for (size_t i : near) {
    middle += samples.samples().points[i] / static_cast<double>(near.size());
    normal += samples.samples().normals[i];
  }
  const Vec3 out = tip - middle;
  if (!(out.norm() > 0.0) || !(normal.norm() > 0.0)) return found;
  found.direction = out.normalized();
  // On the rim of an open mesh what is around lies aside of the place, not below it.
  if (found.direction.dot(normal.normalized()) > 0.8) found.height = out.norm() / radius;
  return found;
}

/// As few of `samples`, evenly taken, as leave some eighty within `radius` of one: more do not move their
/// middle and are looked through for every place that might be a nose.
Neighbours thinned(const Neighbours& samples, double radius) {
  const size_t enough = 80, places = 50;
  const Samples& all = samples.samples();
  const size_t apart = std::max<size_t>(1, all.size() / places);
  size_t looked = 0, met = 0;
  std::vector<size_t> near;
  for (size_t i = 0; i < all.size(); i += apart, ++looked) {
    samples.within(all.points[i], radius, near);
    met += near.size();
  }
  const size_t stride = met / std::max<size_t>(1, enough * looked);
  if (stride < 2) return samples;
  Samples few;
  for (size_t i = 0; i < all.size(); i += stride)
    few.add(all.points[i], all.normals[i]);
  return Neighbours(std::move(few));
}

/// What stands out most, no two close together.
std::vector<Protrusion> protrusions(const Neighbours& samples, double radius, size_t count) {
  std::vector<Protrusion> all;
  const Neighbours around = thinned(samples, radius);
  for (size_t i = 0; i < samples.samples().size(); ++i) {
    const Protrusion p = protrusion_at(around, samples.samples().points[i], radius);
    if (p.height > 0.0) all.push_back(p);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Protrusion& a, const Protrusion& b) { return a.height > b.height; });
  std::vector<Protrusion> chosen;
  for (const Protrusion& p : all) {
    if (chosen.size() == count) break;
    if (std::none_of(chosen.begin(), chosen.end(),
                     [&](const Protrusion& c) { return (c.tip - p.tip).norm() < 0.7 * radius; }))
      chosen.push_back(p);
  }
  return chosen;
}

}  // namespace

double distance_from(const GenericFace& face, const std::vector<size_t>& points, const Neighbours& samples,
                     const Placement& placement) {
  const double most = 0.012;
  double sum = 0.0;
  for (size_t i : points) {
    const auto near = samples.nearest_within(placement(face.points.points[i]), most * placement.scale);
    const bool faces_so =
        near && samples.samples().normals[near->first].dot(placement.rotation * face.points.normals[i]) > 0.3;
    sum += faces_so ? std::sqrt(near->second) / placement.scale : most;
  }
  return sum / static_cast<double>(points.size());
}

std::vector<size_t> some_face_points(const GenericFace& face, size_t stride) {
  std::vector<size_t> some;
  size_t passed = 0;
  for (size_t i = 0; i < face.points.size(); ++i)
    if (face.is_face[i] && passed++ % stride == 0) some.push_back(i);
  return some;
}

namespace {

/// The best guesses about what stands out of `samples` most, for one size of head.
std::vector<Guess> guesses_of_size(const GenericFace& face, const Neighbours& samples, const Protrusion& nose,
                                   double scale) {
  const std::vector<size_t> few = some_face_points(face, 5);
  std::vector<Guess> all;
  for (const Protrusion& tip : protrusions(samples, nose_radius * scale, 6)) {
    const Mat3 onto = least_rotation(nose.direction, tip.direction).toRotationMatrix();
    std::vector<Guess> here;
    const int turns = 24;
    for (int turn = 0; turn < turns; ++turn)
      for (double nod : {0.0, -0.3, 0.3}) {
        Guess guess;
        guess.placement.scale = scale;
        guess.placement.rotation =
            Eigen::AngleAxisd(2.0 * EIGEN_PI * turn / turns, tip.direction).toRotationMatrix() * onto *
            Eigen::AngleAxisd(nod, Vec3::UnitX()).toRotationMatrix();
        guess.placement.shift = tip.tip - scale * (guess.placement.rotation * face.nose_tip);
        guess.cost = distance_from(face, few, samples, guess.placement);
        here.push_back(guess);
      }
    const size_t kept = 3;
    std::partial_sort(here.begin(), here.begin() + kept, here.end(),
                      [](const Guess& a, const Guess& b) { return a.cost < b.cost; });
    all.insert(all.end(), here.begin(), here.begin() + kept);
  }
  return all;
}

}  // namespace

std::vector<Guess> guess_by_nose(const GenericFace& face, const Neighbours& samples, int count,
                                 const ForEach& for_each) {
  const double extent = bounds(samples.samples().points).size().norm();
  const Protrusion nose = protrusion_at(Neighbours(face.points), face.nose_tip, nose_radius);
  // A face alone measures some 0.22 m from corner to corner, a head without its vault or with its neck up to
  // twice that.
  constexpr std::array sizes{0.17, 0.20, 0.24, 0.28, 0.33, 0.39, 0.46};
  std::array<std::vector<Guess>, sizes.size()> of_size;
  run_each(for_each, sizes.size(),
           [&](size_t k) { of_size[k] = guesses_of_size(face, samples, nose, extent / sizes[k]); });
  std::vector<Guess> all;
  for (const std::vector<Guess>& some : of_size)
    all.insert(all.end(), some.begin(), some.end());
  std::stable_sort(all.begin(), all.end(), [](const Guess& a, const Guess& b) { return a.cost < b.cost; });
  if (static_cast<int>(all.size()) > count) all.resize(static_cast<size_t>(count));
  return all;
}

}  // namespace fascia::landmarks
