#include "tools/anatomy/head/head.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/anatomy/head/drape.h"
#include "tools/anatomy/head/rings.h"

namespace fascia::head_maker {

HalfHead make_half(const Figures& figures) {
  std::vector<char> fixed;
  HalfHead half = refine_cage(openings(figures), fixed);
  drape(SkinSurface(figures.sections), fixed, half);
  add_eye(figures, half);
  add_mouth(figures, half);
  add_nostril(figures, half);
  add_ear(figures, half);
  return half;
}

namespace {

std::string right_name(const std::string& name) {
  const std::string left = "_left";
  if (name.size() > left.size() && name.ends_with(left))
    return name.substr(0, name.size() - left.size()) + "_right";
  return name;
}

}  // namespace

PolygonMesh mirrored(const HalfHead& half, const std::vector<std::array<Vec2, 4>>& uv) {
  PolygonMesh out;
  out.name = "skin";
  out.vertices = half.vertices;
  std::vector<int> twin(half.vertices.size());
  for (std::size_t v = 0; v < half.vertices.size(); ++v) {
    twin[v] = static_cast<int>(v);
    if (half.midline[v]) continue;
    twin[v] = static_cast<int>(out.vertices.size());
    const Vec3& p = half.vertices[v];
    out.vertices.emplace_back(-p.x(), p.y(), p.z());
  }
  std::map<std::pair<double, double>, int> chart;
  const auto chart_index = [&](double u, double v) {
    const auto [entry, is_new] = chart.try_emplace({u, v}, static_cast<int>(out.uv.size()));
    if (is_new) out.uv.emplace_back(u, v);
    return entry->second;
  };
  const auto polygon = [](const Quad& q) {
    return q[2] == q[3] ? std::vector<int>{q[0], q[1], q[2]} : std::vector<int>(q.begin(), q.end());
  };
  for (std::size_t f = 0; f < half.quads.size(); ++f) {
    out.faces.push_back(polygon(half.quads[f]));
    std::vector<int> corners;
    for (std::size_t k = 0; k < out.faces.back().size(); ++k)
      corners.push_back(chart_index(uv[f][k].x(), uv[f][k].y()));
    out.face_uv.push_back(corners);
    out.region.push_back(half.region[f]);
  }
  for (std::size_t f = 0; f < half.quads.size(); ++f) {
    std::vector<int> face = polygon(half.quads[f]);
    for (int& v : face)
      v = twin[v];
    // Reversed from the second corner on, so that both sides are split into triangles alike.
    std::reverse(face.begin() + 1, face.end());
    out.faces.push_back(face);
    std::vector<int> corners;
    for (std::size_t j = face.size(), k = 0; j > 0; --j, k = j)
      corners.push_back(chart_index(1.0 - uv[f][k].x(), uv[f][k].y()));
    out.face_uv.push_back(corners);
    out.region.push_back(right_name(half.region[f]));
  }
  for (const auto& [name, loop] : half.loops) {
    if (name.size() == 1) continue;
    if (half.midline[loop.front()] && half.midline[loop.back()]) {
      std::vector<int> whole = loop;
      for (std::size_t k = loop.size() - 1; k-- > 1;)
        whole.push_back(twin[loop[k]]);
      out.loops[name] = whole;
      continue;
    }
    out.loops[name + "_left"] = loop;
    std::vector<int> right;
    for (int v : loop)
      right.push_back(twin[v]);
    out.loops[name + "_right"] = right;
  }
  return out;
}

PolygonMesh make_eyeball(const Figures& figures, bool left) {
  PolygonMesh out;
  out.name = left ? "eye_left" : "eye_right";
  constexpr int kAround = 16;
  const double radius = figures.eye_radius;
  const Vec3 centre(left ? figures.eye_centre.x() : -figures.eye_centre.x(), figures.eye_centre.y(),
                    figures.eye_centre.z());
  // Visible iris 12 mm wide (Forrester et al., The Eye, chapter 1), pupil 4 mm; the cornea rises above the
  // sphere.
  const double limbus = std::asin(6.0 / radius), pupil = std::asin(2.0 / radius);
  const double bulge = figures.cornea_front - (figures.eye_centre.z() + radius);
  const double angles[] = {0.5 * pupil, pupil, 0.5 * (pupil + limbus), limbus, 0.62, 0.85, 1.15, 1.5, 1.9,
                           2.3,         2.7};
  const auto place = [&](double a, double turn) {
    const double lift = a < limbus ? bulge * std::pow(std::cos(0.5 * std::numbers::pi * a / limbus), 2) : 0.0;
    const double r = radius + lift;
    return Vec3(centre + r * Vec3(std::sin(a) * std::cos(turn), std::sin(a) * std::sin(turn), std::cos(a)));
  };
  const auto chart = [&](double a, double turn) {
    const double r = 0.48 * a / std::numbers::pi;
    return Vec2(0.5 + r * std::cos(turn), 0.5 + r * std::sin(turn));
  };
  const auto add = [&](double a, double turn) {
    out.vertices.push_back(place(a, turn));
    out.uv.push_back(chart(a, turn));
    return static_cast<int>(out.vertices.size()) - 1;
  };
  const auto face = [&](std::vector<int> corners, const std::string& region) {
    out.faces.push_back(corners);
    out.face_uv.push_back(corners);
    out.region.push_back(region);
  };
  std::vector<int> last;
  const int front = add(0.0, 0.0);
  // Counted from the midline outward on both sides, so that one is the mirror image of the other.
  const auto turn_of = [&](int k) {
    const double t = 2.0 * std::numbers::pi * k / kAround;
    return left ? t : std::numbers::pi - t;
  };
  const auto oriented = [&](std::vector<int> corners) {
    if (!left) std::reverse(corners.begin() + 1, corners.end());
    return corners;
  };
  for (double a : angles) {
    std::vector<int> ring;
    for (int k = 0; k < kAround; ++k)
      ring.push_back(add(a, turn_of(k)));
    const std::string region = a <= pupil + 1e-9 ? "pupil" : a <= limbus + 1e-9 ? "iris" : "sclera";
    for (int k = 0; k < kAround; ++k) {
      const int next = (k + 1) % kAround;
      if (last.empty()) {
        if (k % 2 == 0) face(oriented({front, ring[k], ring[next], ring[(k + 2) % kAround]}), region);
      } else {
        face(oriented({last[k], ring[k], ring[next], last[next]}), region);
      }
    }
    last = ring;
  }
  // The back pole: its own chart corner for every face, on the rim of the disc.
  out.vertices.push_back(place(std::numbers::pi, 0.0));
  const int back = static_cast<int>(out.vertices.size()) - 1;
  for (int k = 0; k < kAround; k += 2) {
    out.uv.push_back(chart(std::numbers::pi, turn_of(k + 1)));
    const int tip = static_cast<int>(out.uv.size()) - 1;
    const int next = (k + 1) % kAround, far = (k + 2) % kAround;
    out.faces.push_back(oriented({last[k], back, last[far], last[next]}));
    out.face_uv.push_back(oriented({last[k], tip, last[far], last[next]}));
    out.region.push_back("sclera");
  }
  return out;
}

}  // namespace fascia::head_maker
