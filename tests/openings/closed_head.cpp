#include "tests/openings/closed_head.h"

#include <algorithm>
#include <cmath>

#include "builder/landmarks/generic_face.h"
#include "geometry/connectivity.h"

namespace fascia::testing {

namespace {

/// A closed loop begun at its vertex of least x, on the right side of most x, upper side first: both sides
/// alike.
std::vector<int> in_order(const TriangleMesh& mesh, const std::vector<int>& loop) {
  const auto at = [&](int v) { return mesh.vertices[static_cast<size_t>(v)]; };
  double middle = 0.0;
  for (const int v : loop)
    middle += at(v).x();
  const double sign = middle < -1e-3 ? -1.0 : 1.0;
  const auto first = static_cast<size_t>(
      std::min_element(loop.begin(), loop.end(),
                       [&](int a, int b) { return sign * at(a).x() < sign * at(b).x(); }) -
      loop.begin());
  const size_t n = loop.size();
  std::vector<int> ordered;
  const bool is_forward = at(loop[(first + n / 4) % n]).y() > at(loop[(first + n - n / 4) % n]).y();
  for (size_t i = 0; i < n; ++i)
    ordered.push_back(loop[is_forward ? (first + i) % n : (first + n - i) % n]);
  return ordered;
}

/// Brings both sides of a loop together: `share` of the way is the upper side's.
void stitch(TriangleMesh& mesh, const std::vector<int>& loop, double share, std::vector<int>& stands_for) {
  const size_t n = loop.size();
  for (size_t i = 1; i < n / 2; ++i) {
    const auto upper = static_cast<size_t>(loop[i]), lower = static_cast<size_t>(loop[n - i]);
    const Vec3 meeting = (1.0 - share) * mesh.vertices[upper] + share * mesh.vertices[lower];
    mesh.vertices[upper] = mesh.vertices[lower] = meeting;
    stands_for[lower] = static_cast<int>(upper);
  }
}

/// Draws the upper lid over the globe so that its edge comes to lie on the lower one's.
void draw_lid_down(TriangleMesh& mesh, const std::vector<int>& loop, const Vec3& globe) {
  const size_t n = loop.size();
  std::vector<Vec3> edges, ways;
  for (size_t i = 1; i < n / 2; ++i) {
    edges.push_back(mesh.vertices[static_cast<size_t>(loop[i])]);
    ways.push_back(mesh.vertices[static_cast<size_t>(loop[n - i])] - edges.back());
  }
  for (Vec3& p : mesh.vertices) {
    if ((p - globe).norm() > 0.03 || p.z() < globe.z()) continue;
    size_t nearest = 0;
    for (size_t i = 1; i < edges.size(); ++i)
      if ((p - edges[i]).norm() < (p - edges[nearest]).norm()) nearest = i;
    const bool is_below = p.y() < edges[nearest].y() - 1e-4;
    if (is_below) continue;
    const double distance = (p - edges[nearest]).norm() / 0.007, radius = (p - globe).norm();
    p += std::exp(-distance * distance) * ways[nearest];
    p = globe + radius * (p - globe).normalized();
  }
}

}  // namespace

ClosedHead closed_head(const anatomy::GenericAnatomy& anatomy, bool lids) {
  const landmarks::GenericFace face = landmarks::generic_face(anatomy);
  TriangleMesh mesh = face.skin;
  std::vector<bool> keep(mesh.triangles.size());
  const auto is_behind = [&](size_t t, const std::string& word) {
    return face.region_names[static_cast<size_t>(face.region_of_triangle[t])].rfind(word, 0) == 0;
  };
  for (size_t t = 0; t < keep.size(); ++t)
    keep[t] = !is_behind(t, "mouth_lining") && !(lids && is_behind(t, "conjunctiva"));
  std::vector<int> map;
  TriangleMesh outer = submesh(mesh, keep, &map);
  ClosedHead head;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin) head.landmarks[landmark.name] = *landmark.skin;
  const Vec3 mouth = head.landmarks.at("stomion");
  std::vector<int> stands_for(outer.vertices.size());
  for (size_t v = 0; v < stands_for.size(); ++v)
    stands_for[v] = static_cast<int>(v);
  for (const auto& loop : boundary_loops(outer, connectivity(outer))) {
    Vec3 middle = Vec3::Zero();
    for (const int v : loop)
      middle += outer.vertices[static_cast<size_t>(v)] / static_cast<double>(loop.size());
    const bool is_left = middle.x() > 0.0;
    const Vec3 globe = is_left ? face.eye_left.centre : face.eye_right.centre;
    if ((middle - mouth).norm() < 0.02) {
      stitch(outer, in_order(outer, loop), 0.5, stands_for);
    } else if (lids && (middle - globe).norm() < 0.025) {
      const std::vector<int> ordered = in_order(outer, loop);
      draw_lid_down(outer, ordered, globe);
      stitch(outer, ordered, 1.0, stands_for);
    }
  }
  std::vector<bool> all(outer.triangles.size(), true);
  for (Triangle& t : outer.triangles)
    for (int& v : t)
      v = stands_for[static_cast<size_t>(v)];
  std::vector<int> compact;
  head.skin = submesh(outer, all, &compact);
  head.of_generic.assign(mesh.vertices.size(), -1);
  for (size_t v = 0; v < map.size(); ++v)
    if (map[v] >= 0)
      head.of_generic[v] = compact[static_cast<size_t>(stands_for[static_cast<size_t>(map[v])])];
  return head;
}

TriangleMesh eyes_in_one_piece(const anatomy::GenericAnatomy& anatomy) {
  const landmarks::GenericFace face = landmarks::generic_face(anatomy);
  std::vector<bool> keep(face.skin.triangles.size());
  for (size_t t = 0; t < keep.size(); ++t)
    keep[t] = face.region_names[static_cast<size_t>(face.region_of_triangle[t])].rfind("conjunctiva", 0) != 0;
  std::vector<int> map;
  TriangleMesh mesh = submesh(face.skin, keep, &map);
  for (const auto& loop : boundary_loops(mesh, connectivity(mesh)))
    for (const auto* eye : {&face.eye_left, &face.eye_right}) {
      Vec3 middle = Vec3::Zero();
      for (const int v : loop)
        middle += mesh.vertices[static_cast<size_t>(v)] / static_cast<double>(loop.size());
      if ((middle - eye->centre).norm() > 0.025) continue;
      const auto add = [&](const Vec3& direction) {
        mesh.vertices.push_back(eye->centre + eye->radius * direction.normalized());
        return mesh.vertex_count() - 1;
      };
      const Vec3 ahead = middle - eye->centre;
      const size_t n = loop.size();
      std::vector<int> last = loop;
      for (const double share : {0.06, 0.35, 0.68}) {
        std::vector<int> next;
        for (const int v : loop) {
          const Vec3 direction = mesh.vertices[static_cast<size_t>(v)] - eye->centre;
          next.push_back(add((1.0 - share) * direction + share * ahead));
        }
        for (size_t i = 0; i < n; ++i) {
          const size_t j = (i + 1) % n;
          mesh.triangles.push_back({last[j], last[i], next[i]});
          mesh.triangles.push_back({last[j], next[i], next[j]});
        }
        last = next;
      }
      const int apex = add(ahead);
      for (size_t i = 0; i < n; ++i)
        mesh.triangles.push_back({last[(i + 1) % n], last[i], apex});
    }
  return mesh;
}

std::string obj_text(const TriangleMesh& mesh) {
  std::string text = "o head\n";
  char line[128];
  for (const Vec3& p : mesh.vertices) {
    std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", 1e3 * p[0], 1e3 * p[1], 1e3 * p[2]);
    text += line;
  }
  for (const Vec3& p : mesh.vertices) {
    std::snprintf(line, sizeof line, "vt %.6f %.6f\n", 0.5 + 2.0 * p[0], 0.5 + 2.0 * p[1]);
    text += line;
  }
  for (const Triangle& t : mesh.triangles) {
    std::snprintf(line, sizeof line, "f %d/%d %d/%d %d/%d\n", t[0] + 1, t[0] + 1, t[1] + 1, t[1] + 1,
                  t[2] + 1, t[2] + 1);
    text += line;
  }
  return text;
}

}  // namespace fascia::testing
