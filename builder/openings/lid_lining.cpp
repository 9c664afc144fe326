#include "builder/openings/lid_lining.h"
#include "geometry/alignment.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace fascia::openings {

namespace {

/// A ring about the globe: how far from the front, and how far outside of the globe as a share of its radius.
/// The fornices lie near the equator (Gray's Anatomy); behind, the ring only closes the socket.
struct GlobeRing {
  double edge;   ///< share of the way from the cut to the circle below, as an angle
  double angle;  ///< radians from the front
  double clearance;
};
constexpr std::array<GlobeRing, 7> globe_rings = {{{0.0, 1.2, 0.03},
                                                   {0.3, 1.2, 0.03},
                                                   {0.7, 1.2, 0.035},
                                                   {1.0, 1.35, 0.05},
                                                   {1.0, 1.75, 0.06},
                                                   {1.0, 2.3, 0.06},
                                                   {1.0, 2.8, 0.06}}};

}  // namespace

Lining lid_lining(const Rim& rim, int first, const MeetingLine& line, const prepare::Eyeball& globe) {
  const Vec3 front = line.axes.col(2);
  const auto place = [&](int ring, double around) {
    const GlobeRing& shape = globe_rings[static_cast<size_t>(ring) - 1];
    const double turn = EIGEN_PI * (1.0 - around);  // pi at the right corner, 0 at the left, then below
    const Vec3 circle =
        std::cos(shape.angle) * front +
        std::sin(shape.angle) * (std::cos(turn) * line.axes.col(0) + std::sin(turn) * line.axes.col(1));
    const Vec3 edge = (rim.at(around) - globe.centre).normalized();
    const Eigen::Quaterniond way = least_rotation(edge, circle);
    const Vec3 direction = Eigen::Quaterniond::Identity().slerp(shape.edge, way) * edge;
    return Vec3(globe.centre + (1.0 + shape.clearance) * globe.radius * direction);
  };
  return span_lining(rim, first, static_cast<int>(globe_rings.size()), lining_columns(rim), place,
                     globe.centre - 1.06 * globe.radius * front);
}

}  // namespace fascia::openings
