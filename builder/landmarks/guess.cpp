#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "builder/landmarks/placement.h"
#include "geometry/alignment.h"

namespace fascia::landmarks {

namespace {

/// Distance of the outermost surface along directions from a centre, as a share of a radius: 12 x 12 cells on
/// each face of a cube; negative where nothing is met.
class RadialMap {
 public:
  RadialMap(const spatial::SurfaceQuery& surface, const Ball& ball) : extent_(6 * side_ * side_, -1.0) {
    const double reach = 1.7 * ball.radius;
    for (int cell = 0; cell < static_cast<int>(extent_.size()); ++cell) {
      const Vec3 d = direction(cell);
      if (const auto hit = surface.first_hit(ball.centre + reach * d, -d, 0.9 * reach))
        extent_[static_cast<size_t>(cell)] = (reach - hit->distance) / ball.radius;
    }
  }

  double operator()(const Vec3& d) const {
    Eigen::Index axis;
    const double depth = d.cwiseAbs().maxCoeff(&axis);
    const auto step = [&](double v) {
      return std::clamp(static_cast<int>(0.5 * side_ * (v / depth + 1.0)), 0, side_ - 1);
    };
    const int face = static_cast<int>(axis) * 2 + (d[axis] > 0 ? 1 : 0);
    return extent_[static_cast<size_t>((face * side_ + step(d[(axis + 1) % 3])) * side_ +
                                       step(d[(axis + 2) % 3]))];
  }

 private:
  static constexpr int side_ = 12;
  static Vec3 direction(int cell) {
    const int face = cell / (side_ * side_), row = cell / side_ % side_, column = cell % side_;
    const Eigen::Index axis = face / 2;
    Vec3 d;
    d[axis] = face % 2 ? 1.0 : -1.0;
    d[(axis + 1) % 3] = 2.0 * (row + 0.5) / side_ - 1.0;
    d[(axis + 2) % 3] = 2.0 * (column + 0.5) / side_ - 1.0;
    return d.normalized();
  }
  std::vector<double> extent_;
};

struct Direction {
  Vec3 d;
  double extent;
};

/// Directions to the generic head's points, thinned out evenly, the neck left out.
std::vector<Direction> generic_directions(const GenericFace& face) {
  std::vector<Direction> all;
  for (size_t i = 0; i < face.points.size(); ++i) {
    if (face.weights[i] <= 0.0) continue;
    const Vec3 from = face.points.points[i] - face.vault.centre;
    const Vec3 d = from.normalized();
    const bool is_crowded = std::any_of(
        all.begin(), all.end(), [&](const Direction& other) { return other.d.dot(d) > std::cos(0.16); });
    if (!is_crowded) all.push_back({d, from.norm() / face.vault.radius});
  }
  return all;
}

/// Rotations about 15 degrees apart: Fibonacci directions for where the face looks, times turns about it.
const std::vector<Mat3>& rotations() {
  static const std::vector<Mat3> all = [] {
    std::vector<Mat3> list;
    const int views = 180, turns = 24;
    for (int v = 0; v < views; ++v) {
      const double z = 1.0 - (2.0 * v + 1.0) / views, around = v * EIGEN_PI * (3.0 - std::sqrt(5.0));
      const double ring = std::sqrt(1.0 - z * z);
      const Vec3 view(ring * std::cos(around), ring * std::sin(around), z);
      const Mat3 turn = least_rotation(Vec3::UnitZ(), view).toRotationMatrix();
      for (int t = 0; t < turns; ++t)
        list.push_back(turn *
                       Eigen::AngleAxisd(2.0 * EIGEN_PI * t / turns, Vec3::UnitZ()).toRotationMatrix());
    }
    return list;
  }();
  return all;
}

double mismatch(const RadialMap& map, const std::vector<Direction>& generic, const Mat3& rotation,
                std::vector<double>& differences) {
  // A direction in which nothing is met says little against the head: scans have holes.
  const double missing = 0.12, most = 0.25;
  double sum = 0.0;
  differences.clear();
  for (const Direction& g : generic) {
    const double extent = map(rotation * g.d);
    if (extent < 0.0) continue;
    differences.push_back(extent - g.extent);
    sum += std::clamp(differences.back(), -0.3, 0.3);
  }
  if (differences.size() < generic.size() / 4) return 1.0;
  const double mean = sum / static_cast<double>(differences.size());
  double cost = missing * static_cast<double>(generic.size() - differences.size());
  for (double d : differences)
    cost += std::min(std::abs(d - mean), most);
  return cost / static_cast<double>(generic.size());
}

}  // namespace

std::vector<Guess> guess_placements(const GenericFace& face, const spatial::SurfaceQuery& surface,
                                    const Ball& lump, int count) {
  const RadialMap map(surface, lump);
  const std::vector<Direction> generic = generic_directions(face);
  const std::vector<Mat3>& turns = rotations();
  std::vector<double> cost(turns.size()), scratch;
  std::vector<size_t> order(turns.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto sort_by_cost = [&] {
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return cost[a] < cost[b]; });
  };
  // A third of the directions tells most turns to be wrong.
  std::vector<Direction> few;
  for (size_t i = 0; i < generic.size(); i += 3)
    few.push_back(generic[i]);
  for (size_t i : order)
    cost[i] = mismatch(map, few, turns[i], scratch);
  sort_by_cost();
  order.resize(turns.size() / 4);
  for (size_t i : order)
    cost[i] = mismatch(map, generic, turns[i], scratch);
  sort_by_cost();
  std::vector<Guess> guesses;
  for (size_t i : order) {
    if (static_cast<int>(guesses.size()) == count) break;
    const bool is_near = std::any_of(guesses.begin(), guesses.end(), [&](const Guess& g) {
      return (g.placement.rotation.transpose() * turns[i]).trace() >
             1.0 + 2.0 * std::cos(25.0 * EIGEN_PI / 180.0);
    });
    if (is_near) continue;
    Guess guess;
    guess.cost = cost[i];
    guess.placement.scale = lump.radius / face.vault.radius;
    guess.placement.rotation = turns[i];
    guess.placement.shift = lump.centre - guess.placement.scale * (turns[i] * face.vault.centre);
    guesses.push_back(guess);
  }
  return guesses;
}

}  // namespace fascia::landmarks
