#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/landmarks/placement.h"
#include "builder/landmarks/round_parts.h"
#include "geometry/alignment.h"

namespace fascia::landmarks {

namespace {

/// Places that carry the line `from`, `to` onto the line `from_here`, `to_here`, turned about it all round;
/// the best of them.
std::vector<Guess> about_line(const GenericFace& face, const Vec3& from, const Vec3& to,
                              const Vec3& from_here, const Vec3& to_here, const Neighbours& samples,
                              size_t count) {
  const Vec3 along = to - from, here = to_here - from_here;
  std::vector<Guess> all;
  if (!(along.norm() > 0.0) || !(here.norm() > 0.0)) return all;
  const std::vector<size_t> few = some_face_points(face, 5);
  const Mat3 onto = least_rotation(along, here).toRotationMatrix();
  const int turns = 36;
  for (int turn = 0; turn < turns; ++turn) {
    Guess guess;
    guess.placement.scale = here.norm() / along.norm();
    guess.placement.rotation =
        Eigen::AngleAxisd(2.0 * EIGEN_PI * turn / turns, here.normalized()).toRotationMatrix() * onto;
    guess.placement.shift = 0.5 * (from_here + to_here) -
                            guess.placement.scale * (guess.placement.rotation * (0.5 * (from + to)));
    guess.cost = distance_from(face, few, samples, guess.placement);
    all.push_back(guess);
  }
  std::stable_sort(all.begin(), all.end(), [](const Guess& a, const Guess& b) { return a.cost < b.cost; });
  if (all.size() > count) all.resize(count);
  return all;
}

}  // namespace

std::vector<Guess> guess_by_eyes(const GenericFace& face, const TriangleMesh& mesh, const Neighbours& samples,
                                 int count) {
  std::vector<Guess> all;
  const std::vector<Ball> balls = round_parts(mesh);
  // Pearls of a necklace and buttons are many; eyes are few.
  if (balls.size() > 24) return all;
  for (size_t i = 0; i < balls.size(); ++i)
    for (size_t j = 0; j < balls.size(); ++j) {
      const Ball &left = balls[i], &right = balls[j];
      const double apart = (left.centre - right.centre).norm(), radius = 0.5 * (left.radius + right.radius);
      const bool is_pair = i != j && std::abs(left.radius - right.radius) < 0.15 * radius &&
                           apart > 1.8 * radius && apart < 9.0 * radius;
      if (!is_pair) continue;
      for (Guess& guess : about_line(face, face.eye_right.centre, face.eye_left.centre, right.centre,
                                     left.centre, samples, 3)) {
        guess.held = {{face.eye_left.centre, left.centre}, {face.eye_right.centre, right.centre}};
        all.push_back(std::move(guess));
      }
    }
  std::stable_sort(all.begin(), all.end(), [](const Guess& a, const Guess& b) { return a.cost < b.cost; });
  if (static_cast<int>(all.size()) > count) all.resize(static_cast<size_t>(count));
  return all;
}

std::vector<Guess> guess_by_anchors(const GenericFace& face, const std::vector<Anchor>& anchors,
                                    const Neighbours& samples, int count) {
  if (anchors.size() < 2) return {};
  std::vector<Vec3> from, to;
  for (const Anchor& anchor : anchors) {
    from.push_back(anchor.generic);
    to.push_back(anchor.target);
  }
  const Vec3 spread = principal_axes(scatter(from)).values.cwiseMax(0.0).cwiseSqrt();
  // Points that are nearly in a line leave the turn about it to the face.
  if (anchors.size() > 2 && spread[1] > 0.15 * spread[2]) {
    const Mat4 map = similarity(from, to);
    Guess guess;
    guess.placement.scale = map.topLeftCorner<3, 1>().norm();
    guess.placement.rotation = map.topLeftCorner<3, 3>() / guess.placement.scale;
    guess.placement.shift = map.topRightCorner<3, 1>();
    if (guess.placement.scale > 0.0) return {guess};
  }
  size_t first = 0, last = 1;
  for (size_t i = 0; i < anchors.size(); ++i)
    for (size_t j = i + 1; j < anchors.size(); ++j)
      if ((anchors[i].generic - anchors[j].generic).norm() >
          (anchors[first].generic - anchors[last].generic).norm()) {
        first = i;
        last = j;
      }
  return about_line(face, anchors[first].generic, anchors[last].generic, anchors[first].target,
                    anchors[last].target, samples, static_cast<size_t>(count));
}

}  // namespace fascia::landmarks
