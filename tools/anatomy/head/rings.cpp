#include "tools/anatomy/head/rings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace fascia::head_maker {

namespace {

using Ring = std::vector<Vec3>;

/// Smooth numbers along a loop (1 2 1)/4, `times` over; the ends of an open one stay.
std::vector<double> smoothed(std::vector<double> values, bool closed, int times) {
  const int n = static_cast<int>(values.size());
  for (int t = 0; t < times; ++t) {
    const std::vector<double> old = values;
    for (int i = 0; i < n; ++i) {
      if (!closed && (i == 0 || i == n - 1)) continue;
      values[i] = 0.25 * old[(i + n - 1) % n] + 0.5 * old[i] + 0.25 * old[(i + 1) % n];
    }
  }
  return values;
}

std::vector<double> marks(const std::vector<Profile>& fan, const std::string& name) {
  std::vector<double> out;
  for (const Profile& profile : fan)
    out.push_back(profile.at(name));
  return out;
}

std::vector<int> append_ring(HalfHead& head, const Ring& ring, bool closed) {
  std::vector<int> out;
  for (std::size_t i = 0; i < ring.size(); ++i)
    out.push_back(head.add_vertex(ring[i], !closed && (i == 0 || i + 1 == ring.size())));
  return out;
}

/// Quads between an outer and an inner ring. The loops of the openings run clockwise when seen from outside.
void strip(HalfHead& head, const std::vector<int>& outer, const std::vector<int>& inner, bool closed,
           const std::function<std::string(int)>& region) {
  const int n = static_cast<int>(outer.size());
  for (int i = 0; i < (closed ? n : n - 1); ++i) {
    const int j = (i + 1) % n;
    head.add_quad({outer[i], inner[i], inner[j], outer[j]}, region(i));
  }
}

/// Close a ring by quads that pair its edges around one centre vertex.
void cap(HalfHead& head, const std::vector<int>& ring, const Vec3& centre, bool closed,
         const std::string& region) {
  const int n = static_cast<int>(ring.size()), middle = head.add_vertex(centre, !closed);
  for (int i = 0; i + (closed ? 1 : 2) < n; i += 2)
    head.add_quad({ring[i], middle, ring[(i + 2) % n], ring[i + 1]}, region);
}

Ring mean_of_neighbours(const Ring& ring, double amount, bool closed) {
  Ring out = ring;
  const int n = static_cast<int>(ring.size());
  for (int i = 0; i < n; ++i) {
    if (!closed && (i == 0 || i == n - 1)) continue;
    out[i] = (1 - amount) * ring[i] + 0.5 * amount * (ring[(i + n - 1) % n] + ring[(i + 1) % n]);
  }
  return out;
}

/// Part the upper and the lower half of a lip ring (open, symmetric in number) by at least `gap` mm of
/// height.
void keep_apart(Ring& ring, double gap) {
  const int n = static_cast<int>(ring.size());
  for (int k = 0; k < n / 2; ++k) {
    Vec3 &upper = ring[k], &lower = ring[n - 1 - k];
    const double lacking = gap - (upper.y() - lower.y());
    if (lacking <= 0.0) continue;
    upper.y() += 0.5 * lacking;
    lower.y() -= 0.5 * lacking;
  }
}

/// Regions of a ring around the eye: index 0 is medial, then over the upper lid.
std::string upper_lower(int i, int half, const std::string& upper, const std::string& lower) {
  return i < half ? upper : lower;
}

}  // namespace

std::map<char, std::vector<Vec3>> openings(const Figures& figures) {
  std::map<char, std::vector<Vec3>> out;
  const std::map<char, std::string> fans = {{'E', "eye"}, {'M', "mouth"}, {'O', "nostril"}, {'A', "ear"}};
  for (const auto& [letter, name] : fans)
    for (const Profile& profile : figures.fans.at(name))
      out[letter].push_back(profile.points.front());
  return out;
}

void add_eye(const Figures& figures, HalfHead& head) {
  const auto& fan = figures.fans.at("eye");
  const int n = static_cast<int>(fan.size());
  const auto margin = smoothed(marks(fan, "margin_outer"), true, 2),
             inner = smoothed(marks(fan, "margin_inner"), true, 2);
  std::vector<int> last = head.loops.at("E");
  const auto skin = [n](int i) { return upper_lower(i, n / 2, "lid_upper_left", "lid_lower_left"); };
  const auto around = [n](int i) {
    return upper_lower(i, n / 2, "orbital_upper_left", "orbital_lower_left");
  };
  const auto add = [&](const Ring& ring, const std::function<std::string(int)>& region) {
    const std::vector<int> next = append_ring(head, ring, true);
    strip(head, last, next, true, region);
    last = next;
  };
  const double across[] = {0.18, 0.35, 0.50, 0.63, 0.75, 0.85, 0.93, 1.0};
  for (double f : across) {
    Ring ring;
    for (int i = 0; i < n; ++i)
      ring.push_back(fan[i].point(f * margin[i]));
    if (f == 1.0) ring = mean_of_neighbours(ring, 0.25, true);
    if (f < 0.4)
      add(ring, around);
    else
      add(ring, skin);
  }
  head.loops["lid_margin"] = last;
  for (double f : {0.5, 1.0}) {
    Ring ring;
    for (int i = 0; i < n; ++i)
      ring.push_back(fan[i].point(margin[i] + f * (inner[i] - margin[i])));
    add(mean_of_neighbours(ring, 0.25, true), skin);
  }
  head.loops["lid_margin_inner"] = last;
  const auto sac = [](int) { return std::string("conjunctiva_left"); };
  // Behind the margin the sac is a sphere a little wider than the eyeball.
  const double radius = figures.eye_radius + 1.3;
  const Vec3 forward = Vec3::UnitZ();
  for (double angle : {48.0, 72.0, 100.0, 130.0, 156.0}) {
    Ring ring;
    for (int i = 0; i < n; ++i) {
      const Vec3 rim = head.vertices[head.loops["lid_margin_inner"][i]] - figures.eye_centre;
      const Vec3 side = Vec3(rim.x(), rim.y(), 0).normalized();
      const double own = std::atan2(std::hypot(rim.x(), rim.y()), rim.z()) * 180 / std::numbers::pi;
      const double a = std::max(angle, own + 10.0 * angle / 48.0) * std::numbers::pi / 180;
      ring.push_back(figures.eye_centre + radius * (std::cos(a) * forward + std::sin(a) * side));
    }
    add(ring, sac);
  }
  cap(head, last, figures.eye_centre - radius * forward, true, "conjunctiva_left");
}

namespace {

/// Half width, bottom and top of the mouth cavity at depth z.
Vec3 mouth_slice(const Figures& figures, double z) {
  const auto& slices = figures.mouth_slices;
  for (std::size_t i = 1; i < slices.size(); ++i)
    if (z <= slices[i][0] || i + 1 == slices.size()) {
      const double t = std::clamp((z - slices[i - 1][0]) / (slices[i][0] - slices[i - 1][0]), 0.0, 1.0);
      return (slices[i - 1] * (1 - t) + slices[i] * t).tail<3>();
    }
  return slices.back().tail<3>();
}

}  // namespace

void add_mouth(const Figures& figures, HalfHead& head) {
  const auto& fan = figures.fans.at("mouth");
  const int n = static_cast<int>(fan.size()), corner = n / 2;
  const auto border = smoothed(marks(fan, "vermilion_border"), false, 1),
             contact = smoothed(marks(fan, "contact"), false, 0);
  std::vector<int> last = head.loops.at("M");
  const auto add = [&](const Ring& ring, const std::function<std::string(int)>& region) {
    const std::vector<int> next = append_ring(head, ring, false);
    strip(head, last, next, false, region);
    last = next;
    return next;
  };
  const auto skin = [](int) { return std::string("perioral"); };
  const auto lip = [corner](int i) { return upper_lower(i, corner, "lip_upper", "lip_lower"); };
  const auto lining = [](int) { return std::string("mouth_lining"); };
  const auto ring_at = [&](const std::function<double(int)>& s) {
    Ring ring;
    for (int i = 0; i < n; ++i)
      ring.push_back(fan[i].point(s(i)));
    // Planes beside the corner run along the lips: take the middle of their neighbours instead.
    for (int k : {corner - 1, corner + 1})
      ring[k] = 0.5 * (ring[k - 1] + ring[k + 1]);
    keep_apart(ring, 0.3);
    return ring;
  };
  for (double f : {0.35, 0.7, 1.0})
    add(ring_at([&](int i) { return f * border[i]; }), skin);
  head.loops["vermilion_border"] = last;
  for (double f : {0.2, 0.42, 0.65, 0.85, 1.0}) {
    Ring ring = ring_at([&](int i) { return border[i] + f * (contact[i] - border[i]); });
    keep_apart(ring, 0.3 + 1.5 * (1.0 - f));
    add(ring, lip);
  }
  head.loops["lip_contact"] = last;
  // Behind the contact line each profile goes on over the inner lip into the vestibule; the corner, which has
  // no profile of its own there, lies between its neighbours.
  for (double beyond : {2.5, 6.5, 12.0, 19.0}) {
    Ring ring = ring_at([&](int i) { return contact[i] + beyond; });
    for (int k : {corner - 1, corner + 1}) {
      const int outer = k < corner ? k - 1 : k + 1;
      ring[k] = 0.5 * (ring[k] + ring[outer]);
    }
    ring[corner] = 0.5 * (ring[corner - 1] + ring[corner + 1]);
    add(ring, lining);
  }
  const Ring start = [&] {
    Ring ring;
    for (int v : last)
      ring.push_back(head.vertices[v]);
    return ring;
  }();
  for (const auto& [z, blend] :
       {std::pair(84.0, 0.6), std::pair(66.0, 1.0), std::pair(46.0, 1.0), std::pair(26.0, 1.0)}) {
    Ring ring;
    const Vec3 slice = mouth_slice(figures, z);
    for (int i = 0; i < n; ++i) {
      const double t = std::numbers::pi * (0.5 - static_cast<double>(i) / (n - 1));
      const double c = std::pow(std::abs(std::cos(t)), 0.6),
                   s = std::copysign(std::pow(std::abs(std::sin(t)), 0.75), std::sin(t));
      const double middle = 0.5 * (slice[1] + slice[2]), half = 0.5 * (slice[2] - slice[1]);
      const Vec3 there(slice[0] * c, middle + half * s, z);
      const Vec3 own(start[i].x(), start[i].y(), std::min(start[i].z(), z + 6.0));
      ring.push_back(blend * there + (1 - blend) * own);
    }
    add(ring, lining);
  }
  cap(head, last, Vec3(0, -38, 12), false, "mouth_lining");
}

void add_nostril(const Figures& figures, HalfHead& head) {
  const auto& fan = figures.fans.at("nostril");
  const int n = static_cast<int>(fan.size());
  const auto rim = smoothed(marks(fan, "rim"), true, 1);
  std::vector<int> last = head.loops.at("O");
  const auto add = [&](const Ring& ring, const std::string& region) {
    const std::vector<int> next = append_ring(head, ring, true);
    strip(head, last, next, true, [&](int) { return region; });
    last = next;
  };
  const auto ring_at = [&](double f, double beyond) {
    Ring ring;
    for (int i = 0; i < n; ++i)
      ring.push_back(fan[i].point(f * rim[i] + beyond));
    return ring;
  };
  add(ring_at(0.5, 0), "nose");
  add(mean_of_neighbours(ring_at(1.0, 0), 0.5, true), "nose");
  head.loops["nostril_rim"] = last;
  Ring ring;
  for (double beyond : {1.2, 3.0, 6.0}) {
    ring = ring_at(1.0, beyond);
    for (int k = 0; k < 3; ++k)
      ring = mean_of_neighbours(ring, 0.5, true);
    add(ring, "nostril_left");
  }
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : ring)
    centre += p / n;
  const Vec3 upward = Vec3(-0.05, 0.8, -0.6).normalized();
  for (Vec3& p : ring)
    p = centre + 0.6 * (p - centre) + 4.0 * upward;
  add(ring, "nostril_left");
  cap(head, last, centre + 6.0 * upward, true, "nostril_left");
}

void add_ear(const Figures& figures, HalfHead& head) {
  const auto& fan = figures.fans.at("ear");
  const int n = static_cast<int>(fan.size());
  const auto crest = smoothed(marks(fan, "crest"), true, 8);
  std::vector<double> fractions = {0.15, 0.3, 0.45, 0.6, 0.74, 0.88, 1.0};
  const int outer_rings = static_cast<int>(fractions.size());
  const std::vector<double> within = {0.06, 0.13, 0.22, 0.32, 0.43, 0.55, 0.68, 0.82, 1.0};
  std::vector<std::vector<double>> at;
  for (double f : fractions) {
    at.emplace_back();
    for (int i = 0; i < n; ++i)
      at.back().push_back(f * crest[i]);
  }
  for (double f : within) {
    at.emplace_back();
    for (int i = 0; i < n; ++i)
      at.back().push_back(crest[i] + f * (fan[i].length() - crest[i]));
  }
  // Slide the rings along their profiles until those of neighbouring profiles lie side by side.
  const int rings = static_cast<int>(at.size());
  for (int iteration = 0; iteration < 40; ++iteration)
    for (int r = 0; r + 1 < rings; ++r) {
      if (r == outer_rings - 1) continue;
      const std::vector<double> old = at[r];
      for (int i = 0; i < n; ++i) {
        const Vec3 here = fan[i].point(old[i]);
        const int before = (i + n - 1) % n, after = (i + 1) % n;
        const Vec3 target = 0.5 * (fan[before].point(old[before]) + fan[after].point(old[after]));
        const Vec3 tangent = (fan[i].point(old[i] + 0.5) - fan[i].point(old[i] - 0.5)).normalized();
        const double low = r == 0 ? 0.0 : at[r - 1][i], high = at[r + 1][i];
        const double even = 0.5 * (low + high);
        double s = old[i] + 0.3 * tangent.dot(target - here) + 0.15 * (even - old[i]);
        at[r][i] = std::clamp(s, low + 0.25 * (even - low), high - 0.25 * (high - even));
      }
    }
  std::vector<int> last = head.loops.at("A");
  std::vector<std::vector<int>> floor;  // the rings of the concha
  for (int r = 0; r < rings; ++r) {
    Ring ring;
    for (int i = 0; i < n; ++i)
      ring.push_back(fan[i].point(at[r][i]));
    for (int k = 0; k < 2; ++k)
      ring = mean_of_neighbours(ring, 0.5, true);
    // The lobule hangs across its profiles, which meet its edge at jumping depths.
    for (int k = 0; k < 10; ++k) {
      const Ring even = mean_of_neighbours(ring, 0.5, true);
      for (int i = 5 * n / 8; i <= 7 * n / 8 + 1; ++i)
        ring[i] = even[i];
    }
    const std::vector<int> next = append_ring(head, ring, true);
    strip(head, last, next, true, [](int) { return std::string("ear_left"); });
    last = next;
    if (r + 4 >= rings) floor.push_back(next);
    if (r == outer_rings - 1) head.loops["helix"] = last;
  }
  for (int iteration = 0; iteration < 6; ++iteration)
    for (int r = 1; r < 4; ++r)
      for (int i = 0; i < n; ++i) {
        const auto& v = head.vertices;
        const int across = r < 3 ? floor[r + 1][i] : floor[r][(n / 2 - i + n) % n];
        const Vec3 mean =
            0.25 * (v[floor[r][(i + 1) % n]] + v[floor[r][(i + n - 1) % n]] + v[floor[r - 1][i]] + v[across]);
        head.vertices[floor[r][i]] += 0.5 * (mean - v[floor[r][i]]);
      }
  // The last ring lies along a short upright line: close it across. Index 0 is in front, n / 4 at the top.
  for (int k = -n / 4; k < n / 4; ++k) {
    const int a = (k + n) % n, b = (k + 1 + n) % n, c = (n / 2 - k - 1 + n) % n, d = (n / 2 - k + n) % n;
    if (a == d)
      head.add_quad({last[a], last[c], last[b], last[b]}, "ear_left");
    else if (b == c)
      head.add_quad({last[a], last[d], last[b], last[b]}, "ear_left");
    else
      head.add_quad({last[a], last[d], last[c], last[b]}, "ear_left");
  }
}

}  // namespace fascia::head_maker
