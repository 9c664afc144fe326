#include "builder/landmarks/eye_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "builder/landmarks/round_parts.h"
#include "builder/spatial/mirror_plane.h"

namespace fascia::landmarks {

namespace {

/// Where the surface about both eyes is open to, in the plane between them; nothing where that is to
/// opposite sides, as of the ends of a dumb-bell.
std::optional<Vec3> gaze_of(const Neighbours& samples, const std::array<Ball, 2>& eyes, const Vec3& across) {
  constexpr double about = 1.3, least = 0.35;  // of the radius; of a unit vector
  Vec3 gaze = Vec3::Zero();
  std::vector<size_t> near;
  for (const Ball& eye : eyes) {
    samples.within(eye.centre, about * eye.radius, near);
    Vec3 mean = Vec3::Zero();
    for (size_t i : near)
      mean += samples.samples().normals[i] / static_cast<double>(near.size());
    if (near.size() < 4) return std::nullopt;
    gaze += 0.5 * mean;
  }
  gaze -= gaze.dot(across) * across;
  if (gaze.norm() < least) return std::nullopt;
  return gaze.normalized();
}

/// Whether what is about the eyes is its own mirror image about the plane between them.
bool is_mirrored(const spatial::SurfaceQuery& surface, const Neighbours& samples, const EyePair& eyes) {
  constexpr double about = 1.5, reach = 0.2, alike = 0.08;  // of the distance of the eyes
  std::vector<size_t> near;
  samples.within(eyes.middle, about * eyes.apart, near);
  std::sort(near.begin(), near.end());
  std::vector<Vec3> places;
  const size_t stride = std::max<size_t>(1, near.size() / 400);
  for (size_t k = 0; k < near.size(); k += stride)
    places.push_back(samples.samples().points[near[k]]);
  const spatial::MirrorPlane plane{eyes.middle, (eyes.left - eyes.right).normalized()};
  const spatial::MirrorFit fit = spatial::fit_mirror_plane(surface, places, plane, reach * eyes.apart);
  return fit.covers(places.size()) && fit.most_apart() < alike * eyes.apart;
}

/// How far a ridge in the middle, as a nose or a muzzle, stands out of its flanks and before the eyes, on
/// the side of the eyes that `up` points away from.
double nose_below(const spatial::SurfaceQuery& surface, const EyePair& eyes, const Vec3& up) {
  constexpr double from = 3.0, aside = 0.7, behind = -1.0, most_behind = 0.3;
  const Vec3 across = (eyes.left - eyes.right).normalized();
  const auto depth = [&](double x, double y) {
    const Vec3 origin = eyes.middle + eyes.apart * (x * across + y * up + from * eyes.forward);
    const auto hit = surface.first_hit(origin, -eyes.forward, (from - behind) * eyes.apart);
    return hit ? from - hit->distance / eyes.apart : behind;
  };
  double most = 0.0;
  for (double y = -0.2; y > -1.8; y -= 0.1) {
    const double middle = depth(0.0, y), flanks = 0.5 * (depth(-aside, y) + depth(aside, y));
    most = std::max(most, std::min(middle - flanks, middle + most_behind));
  }
  return most;
}

/// The pairs among `eyes` that may be the two of one head, with the way this faces.
std::vector<EyePair> pairs_of(const std::vector<Ball>& eyes, bool are_balls, SearchedSurface& surface) {
  constexpr double alike = 0.15, nearest = 1.8, farthest = 9.0;  // of the radius
  constexpr double least_nose = 0.2, least_more = 0.1;           // of the distance of the eyes
  constexpr size_t many = 24;  // pearls of a necklace and buttons are many; eyes are few
  std::vector<EyePair> pairs;
  if (eyes.size() > many) return pairs;
  for (size_t i = 0; i < eyes.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const Ball &a = eyes[i], &b = eyes[j];
      const double apart = (a.centre - b.centre).norm(), radius = 0.5 * (a.radius + b.radius);
      if (std::abs(a.radius - b.radius) > alike * radius || apart < nearest * radius ||
          apart > farthest * radius)
        continue;
      const Vec3 across = (a.centre - b.centre) / apart, middle = 0.5 * (a.centre + b.centre);
      const Neighbours& samples = surface.about({middle, apart});
      const auto gaze = gaze_of(samples, {a, b}, across);
      if (!gaze) continue;
      EyePair pair{b.centre, a.centre, middle, gaze->cross(across), *gaze, apart, are_balls, false};
      if (!is_mirrored(surface.query(), samples, pair)) continue;
      double below = nose_below(surface.query(), pair, pair.up),
             above = nose_below(surface.query(), pair, -pair.up);
      if (above > below) {
        std::swap(pair.left, pair.right);
        std::swap(above, below);
        pair.up = -pair.up;
      }
      pair.has_nose = below > least_nose && below > above + least_more;
      pairs.push_back(pair);
    }
  return pairs;
}

}  // namespace

std::vector<EyePair> eye_pairs(SearchedSurface& surface) {
  std::vector<EyePair> pairs = pairs_of(round_parts(surface.mesh()), true, surface);
  const bool has_face = std::any_of(pairs.begin(), pairs.end(), [](const EyePair& p) { return p.has_nose; });
  if (has_face) return pairs;
  for (const EyePair& sockets : pairs_of(round_holes(surface.mesh()), false, surface))
    if (sockets.has_nose) pairs.push_back(sockets);
  return pairs;
}

bool has_its_eyes(const GenericFace& face, const Placement& placement, const EyePair& pair) {
  const double most = 0.5 * pair.apart;
  return (placement(face.eye_left.centre) - pair.left).norm() < most &&
         (placement(face.eye_right.centre) - pair.right).norm() < most;
}

std::vector<Guess> guess_by_eye_pair(const GenericFace& face, const EyePair& pair) {
  // Balls lie behind their openings.
  const Vec3 set_off(0, 0, pair.are_balls ? 0.0 : face.eye_left.radius);
  const Vec3 left = face.eye_left.centre + set_off, right = face.eye_right.centre + set_off;
  Mat3 turn;
  turn.col(0) = (pair.left - pair.right).normalized();
  turn.col(1) = pair.up;
  turn.col(2) = pair.forward;
  std::vector<Guess> all;
  for (const double nod : {0.0, -0.3, 0.3}) {
    Guess guess;
    guess.placement.scale = pair.apart / (left - right).norm();
    guess.placement.rotation = turn * Eigen::AngleAxisd(nod, Vec3::UnitX()).toRotationMatrix();
    guess.placement.shift =
        pair.middle - guess.placement.scale * (guess.placement.rotation * (0.5 * (left + right)));
    guess.held = {{left, pair.left}, {right, pair.right}};
    all.push_back(std::move(guess));
  }
  return all;
}

}  // namespace fascia::landmarks
