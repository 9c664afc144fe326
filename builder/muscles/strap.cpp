#include <algorithm>
#include <cmath>

#include "builder/muscles/order.h"
#include "builder/muscles/parts.h"
#include "builder/muscles/tangents.h"

namespace fascia::muscles {

namespace {

std::vector<SurfacePoint> projected(const Carrier& smas, const std::vector<Vec3>& points) {
  std::vector<SurfacePoint> places;
  for (const Vec3& point : points)
    places.push_back(smas.closest(point));
  return places;
}

/// Where the fibres of a muscle begin and end on the SMAS, in order side by side.
struct Ends {
  std::vector<Vec3> origin, insertion;
};

/// Between two hulls: from arc to arc, both run from the right tangent to the left one.
Ends ends_between(const Hull& origin, const Hull& insertion, const FacingArcs& arcs,
                  const anatomy::Muscle& muscle, const Options& options) {
  const double width =
      0.5 * (std::max(arc_length(origin, arcs.first_near), arc_length(origin, arcs.first_far)) +
             std::max(arc_length(insertion, arcs.second_near), arc_length(insertion, arcs.second_far)));
  const int count = fibre_count(0.7 * width, muscle, options);
  const auto at_share = [&](double region_share) {
    Ends ends;
    for (int i = 0; i < count; ++i) {
      const double s = (i + 0.5) / count;
      const auto between = [&](const Hull& hull, const Arc& near, const Arc& far) {
        return Vec3((1.0 - region_share) * along_arc(hull, near, s) + region_share * along_arc(hull, far, s));
      };
      ends.origin.push_back(between(origin, arcs.first_near, arcs.first_far));
      ends.insertion.push_back(between(insertion, arcs.second_near, arcs.second_far));
    }
    return ends;
  };
  Ends ends = at_share(options.region_share);
  // Where the regions overlap their facing sides lie behind each other: then the fibres run across both.
  const Vec3 onward = insertion.middle() - origin.middle();
  for (int i = 0; i < count; ++i)
    if ((ends.insertion[i] - ends.origin[i]).dot(onward) <= 0.0) return at_share(1.0);
  return ends;
}

/// One region inside the other: fibres from the inner outline straight out to the outer one.
Ends ends_radial(const Hull& origin, const Hull& insertion, const anatomy::Muscle& muscle,
                 const Options& options) {
  const auto around = [](const Hull& hull, const Vec3& centre, const Vec3& direction) {
    int best = 0;
    for (int i = 1; i < hull.size(); ++i)
      if ((hull.positions[i] - centre).normalized().dot(direction) >
          (hull.positions[best] - centre).normalized().dot(direction))
        best = i;
    return hull.positions[best];
  };
  const auto outline = [](const Hull& hull) {
    Arc arc;
    for (int i = 0; i <= hull.size(); ++i)
      arc.push_back(i % hull.size());
    return arc;
  };
  const bool origin_larger = arc_length(origin, outline(origin)) > arc_length(insertion, outline(insertion));
  const Hull &outer = origin_larger ? origin : insertion, &inner = origin_larger ? insertion : origin;
  const Vec3 centre = inner.middle();
  const Arc ring = outline(outer);
  const int count = fibre_count(arc_length(outer, ring), muscle, options);
  Ends ends;
  for (int i = 0; i < count; ++i) {
    const Vec3 out = along_arc(outer, ring, double(i) / count);
    const Vec3 in = around(inner, centre, (out - centre).normalized());
    ends.origin.push_back(origin_larger ? out : in);
    ends.insertion.push_back(origin_larger ? in : out);
  }
  return ends;
}

Ends find_ends(Carrier& smas, const Course& course, const Options& options,
               std::vector<std::string>& warnings) {
  const auto hull_of = [&](const Place& place, const char* end) {
    const std::string what = course.muscle.name + ": " + end;
    Hull hull = geodesic_hull(smas, projected(smas, place.polygon), what);
    if (hull.kept < 1.0)
      warnings.push_back(what + ": the region covers half of the SMAS or more and was drawn in to " +
                         std::to_string(std::lround(100.0 * hull.kept)) +
                         " % of its extent; check the landmarks near it, or draw it in --edits");
    return hull;
  };
  const Hull origin = hull_of(course.origin, "origin"), insertion = hull_of(course.insertion, "insertion");
  const auto left = mutual_tangent(smas, origin, insertion, HullSide::right, HullSide::right);
  const auto right = mutual_tangent(smas, origin, insertion, HullSide::left, HullSide::left);
  if (!left || !right) return ends_radial(origin, insertion, course.muscle, options);
  return ends_between(origin, insertion, facing_arcs(origin, insertion, *left, *right), course.muscle,
                      options);
}

/// The carrier's polyline from `from` over `through` to `to`, geodesic leg by leg.
std::vector<Vec3> geodesic_course(Carrier& smas, const Vec3& from, const std::vector<Vec3>& through,
                                  const Vec3& to) {
  std::vector<Vec3> line;
  SurfacePoint at = smas.closest(from);
  const auto leg = [&](const Vec3& goal) {
    const SurfacePoint next = smas.closest(goal);
    const geodesics::Path& path = smas.connect(at, next);
    line.insert(line.end(), path.positions.begin() + (line.empty() ? 0 : 1), path.positions.end());
    at = next;
  };
  for (const Vec3& point : through)
    leg(point);
  leg(to);
  return line;
}

/// Rounds off the corners that waypoints leave, ends fixed.
void smooth(std::vector<Vec3>& line, int rounds) {
  std::vector<Vec3> last;
  for (int round = 0; round < rounds; ++round) {
    last = line;
    for (size_t i = 1; i + 1 < line.size(); ++i)
      line[i] = 0.5 * last[i] + 0.25 * (last[i - 1] + last[i + 1]);
  }
}

/// Whether an opening of the SMAS lies in the way, so that a line over it goes a long way round.
bool goes_round(const std::vector<Vec3>& line, const Vec3& from, const std::vector<Vec3>& through,
                const Vec3& to) {
  std::vector<Vec3> direct = {from};
  direct.insert(direct.end(), through.begin(), through.end());
  direct.push_back(to);
  constexpr double most = 1.5, least = 0.004;  // metres
  const double length = polyline_length(direct);
  return polyline_length(line) > most * length + least;
}

}  // namespace

std::vector<Fibre> lay_on_smas(Carrier& smas, const Depths& depths, const Course& course,
                               const Options& options, std::vector<std::string>& warnings) {
  const Ends ends = find_ends(smas, course, options, warnings);
  const size_t count = ends.origin.size();
  const Vec3 &middle_origin = ends.origin[count / 2], &middle_insertion = ends.insertion[count / 2];
  std::vector<Fibre> fibres;
  for (size_t i = 0; i < count; ++i) {
    std::vector<Vec3> through;
    for (size_t k = 0; k < course.waypoints.size(); ++k) {
      // A neighbour of the central fibre passes the waypoint as far to the side as its ends lie.
      const double share = double(k + 1) / double(course.waypoints.size() + 1);
      through.push_back(course.waypoints[k] + (1.0 - share) * (ends.origin[i] - middle_origin) +
                        share * (ends.insertion[i] - middle_insertion));
    }
    std::vector<Vec3> line = geodesic_course(smas, ends.origin[i], through, ends.insertion[i]);
    if (goes_round(line, ends.origin[i], through, ends.insertion[i])) return {};
    const int points = point_count(polyline_length(line), options);
    line = resampled(line, points);
    if (!through.empty()) {
      smooth(line, 2 + points / 2);
      line = resampled(line, points);
    }
    Fibre fibre;
    fibre.bundle = static_cast<int>(i) * course.muscle.bundles / static_cast<int>(count);
    for (int k = 0; k < points; ++k)
      fibre.points.push_back(
          depths.at(smas.closest(line[k]), sampled(course.muscle.depth_fraction, double(k) / (points - 1))));
    const auto fasten = [&](const Place& place, FibrePoint& end) {
      if (place.bone) end = unbound(smas, place.bone->closest(end.position).position);
    };
    fasten(course.origin, fibre.points.front());
    fasten(course.insertion, fibre.points.back());
    fibres.push_back(std::move(fibre));
  }
  const int left = put_in_order(fibres, smas.query, [&](const Vec3& position, double share) {
    return depths.near(position, sampled(course.muscle.depth_fraction, share));
  });
  if (left > 0) fibres.clear();
  return fibres;
}

}  // namespace fascia::muscles
