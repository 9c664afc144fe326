#include "builder/openings/mouth_lining.h"

#include <algorithm>
#include <cmath>

#include "builder/splines/warp.h"
#include "geometry/error.h"

namespace fascia::openings {

namespace {

/// The generic lining as rings from the lips' contact inward; each begins at the right corner and runs over
/// the upper side. `end` is the point that closes it.
struct GenericLining {
  std::vector<std::vector<Vec3>> rings;
  Vec3 end = Vec3::Zero();
};

// Of vertices as far to the side the lower one counts, on both sides alike.
constexpr double lower_first = 1e-3;

/// `ring` (closed, in order) begun at its rightmost vertex, upper side first.
std::vector<Vec3> in_order(const std::vector<Vec3>& ring) {
  const size_t count = ring.size();
  const auto by_x = [](const Vec3& a, const Vec3& b) {
    return a.x() + lower_first * a.y() < b.x() + lower_first * b.y();
  };
  const auto first = static_cast<size_t>(std::min_element(ring.begin(), ring.end(), by_x) - ring.begin());
  double side[2] = {0.0, 0.0};
  for (size_t i = 1; i < count / 2; ++i) {
    side[0] += ring[(first + i) % count].y();
    side[1] += ring[(first + count - i) % count].y();
  }
  std::vector<Vec3> ordered;
  for (size_t i = 0; i < count; ++i)
    ordered.push_back(ring[side[0] >= side[1] ? (first + i) % count : (first + count - i) % count]);
  return ordered;
}

/// Where a ring that begins at its rightmost vertex has its leftmost one.
size_t leftmost(const std::vector<Vec3>& ring) {
  const auto by_x = [](const Vec3& a, const Vec3& b) {
    return a.x() - lower_first * a.y() < b.x() - lower_first * b.y();
  };
  return static_cast<size_t>(std::max_element(ring.begin(), ring.end(), by_x) - ring.begin());
}

GenericLining generic_lining(const landmarks::GenericFace& face) {
  std::vector<bool> keep(face.skin.triangles.size(), false);
  for (size_t t = 0; t < keep.size(); ++t)
    keep[t] = face.region_names[static_cast<size_t>(face.region_of_triangle[t])] == "mouth_lining";
  std::vector<int> map;
  TriangleMesh left_over = submesh(face.skin, keep, &map);
  GenericLining lining;
  // Ring after ring: the border of what is left.
  while (!left_over.empty()) {
    const auto loops = boundary_loops(left_over, connectivity(left_over));
    if (loops.size() != 1) break;
    std::vector<Vec3> ring;
    std::vector<bool> on_ring(left_over.vertices.size(), false);
    for (const int v : loops[0]) {
      ring.push_back(left_over.vertices[static_cast<size_t>(v)]);
      on_ring[static_cast<size_t>(v)] = true;
    }
    lining.rings.push_back(in_order(ring));
    std::vector<bool> inside(left_over.triangles.size());
    int within = -1;
    for (size_t t = 0; t < inside.size(); ++t) {
      inside[t] = true;
      for (const int v : left_over.triangles[t]) {
        inside[t] = inside[t] && !on_ring[static_cast<size_t>(v)];
        if (!on_ring[static_cast<size_t>(v)]) within = v;
      }
    }
    if (within >= 0) lining.end = left_over.vertices[static_cast<size_t>(within)];
    left_over = submesh(left_over, inside, &map);
  }
  if (lining.rings.size() < 3) throw Error("the anatomy's head has no lining of the mouth in rings");
  return lining;
}

/// A place on a closed ring, `around` from 0 to 2 in even steps of the vertices of its upper and lower side.
Vec3 place_on(const std::vector<Vec3>& ring, double around) {
  const auto left = static_cast<double>(leftmost(ring)), all = static_cast<double>(ring.size());
  const double x = around < 1.0 ? around * left : left + (around - 1.0) * (all - left);
  const auto i = static_cast<size_t>(x);
  const double t = x - static_cast<double>(i);
  return (1.0 - t) * ring[i % ring.size()] + t * ring[(i + 1) % ring.size()];
}

/// From the generic head to this one, so that the edge of the generic lips' contact comes to lie on the rim.
splines::Warp warp_onto(const GenericLining& generic, const anatomy::GenericAnatomy& anatomy,
                        const Landmarks& landmarks, const Rim& rim) {
  const std::vector<Vec3>& contact = generic.rings[0];
  const size_t half = leftmost(contact);
  std::vector<Vec3> from = contact, to;
  std::vector<double> lengths(contact.size() + 1, 0.0);
  for (size_t i = 0; i < contact.size(); ++i)
    lengths[i + 1] = lengths[i] + (contact[(i + 1) % contact.size()] - contact[i]).norm();
  for (size_t i = 0; i < contact.size(); ++i)
    to.push_back(rim.at(i <= half ? lengths[i] / lengths[half]
                                  : 1.0 + (lengths[i] - lengths[half]) / (lengths.back() - lengths[half])));
  // The lips' own landmarks stand too near to the cut to say more than it does.
  constexpr double near = 0.006;
  const size_t anchors = from.size();
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    const auto at = landmarks.find(landmark.name);
    if (!landmark.skin || at == landmarks.end()) continue;
    bool is_near = false;
    for (size_t i = 0; i < from.size(); ++i)
      is_near = is_near || (from[i] - *landmark.skin).norm() < (i < anchors ? near : 1e-4);
    if (is_near) continue;
    from.push_back(*landmark.skin);
    to.push_back(at->second);
  }
  splines::WarpOptions options;
  options.lambda = 1e-4;
  return splines::fit_warp(from, to, options);
}

/// `p` brought back until at least `least` of the lip lies before it.
Vec3 behind_skin(const spatial::SurfaceQuery& skin, Vec3 p, const Vec3& front, double least) {
  for (int step = 0; step < 24; ++step) {
    const auto hit = skin.first_hit(p, front, 40.0 * least);
    if (hit && !hit->from_outside && hit->distance >= least) break;
    if (!hit && step == 0 && skin.closest(p).signed_distance < -least) break;
    p -= 0.4 * least * front;
  }
  return p;
}

}  // namespace

Lining mouth_lining(const landmarks::GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                    const Landmarks& landmarks, const spatial::SurfaceQuery& skin, const MeetingLine& line,
                    const Rim& rim, int first) {
  const GenericLining generic = generic_lining(face);
  const splines::Warp warp = warp_onto(generic, anatomy, landmarks, rim);
  const int rings = static_cast<int>(generic.rings.size()) - 1;
  const double lip = 0.06 * line.half_width;  // metres: some 1.5 mm on a grown person
  const auto place = [&](int ring, double around) {
    const Vec3 p = warp(place_on(generic.rings[static_cast<size_t>(ring)], around));
    return ring <= 4 ? behind_skin(skin, p, line.axes.col(2), (ring == 1 ? 0.6 : 1.0) * lip) : p;
  };
  return span_lining(rim, first, rings, lining_columns(rim), place, warp(generic.end));
}

}  // namespace fascia::openings
