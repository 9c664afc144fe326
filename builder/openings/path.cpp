#include "builder/openings/path.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fascia::openings {

namespace {

constexpr double snap = 0.2;  // share of an edge

/// The line's level set on a mesh, one step at a time.
class Tracer {
 public:
  Tracer(const TriangleMesh& mesh, const Connectivity& links, const MeetingLine& line)
      : mesh_(mesh), links_(links), line_(line), above_(snapped_heights()) {}

  const std::vector<double>& above() const { return above_; }

  struct Segment {
    PathNode from, to;
    int triangle = -1;  // -1: along an edge of the mesh
  };

  /// The pieces of the level set in a triangle.
  std::vector<Segment> segments(int t) const {
    const Triangle& k = mesh_.triangles[static_cast<size_t>(t)];
    std::vector<PathNode> crossed, touched;
    for (size_t e = 0; e < 3; ++e) {
      const int a = k[e], b = k[(e + 1) % 3];
      if (height(a) * height(b) < 0.0) crossed.push_back(edge_node(a, b));
      if (height(a) == 0.0) touched.push_back({a, -1, 0.0});
    }
    if (crossed.size() == 2) return {{crossed[0], crossed[1], t}};
    if (crossed.size() == 1 && touched.size() == 1) return {{touched[0], crossed[0], t}};
    // Along an edge: the path runs where the triangles on its two sides lie on the two sides of the line.
    if (touched.size() == 2 && height(third(k, touched[0].a, touched[1].a)) > 0.0)
      return {{touched[0], touched[1], -1}};
    return {};
  }

  /// The next piece from `segment.to` on, in the direction `way` (+1 to the left, -1 to the right).
  std::optional<Segment> next(const Segment& segment, double way) const {
    std::optional<Segment> best;
    double best_score = -1e300;
    for (const int t : triangles_at(segment.to))
      for (const Segment& piece : segments(t)) {
        const bool is_forward = piece.from == segment.to;
        if (!is_forward && !(piece.to == segment.to)) continue;
        const Segment on = is_forward ? piece : Segment{piece.to, piece.from, piece.triangle};
        if (on.to == segment.from) continue;
        const Vec3 course = position(mesh_, on.to) - position(mesh_, on.from);
        const double length = course.norm();
        const double score = (length > 0.0 ? way * course.dot(line_.axes.col(0)) / length : 0.0) +
                             triangle_normal(mesh_, t).dot(line_.axes.col(2));
        if (score > best_score) {
          best_score = score;
          best = on;
        }
      }
    return best;
  }

 private:
  double height(int v) const { return above_[static_cast<size_t>(v)]; }
  static int third(const Triangle& k, int a, int b) {
    for (const int v : k)
      if (v != a && v != b) return v;
    return a;
  }

  PathNode edge_node(int a, int b) const {
    if (a > b) std::swap(a, b);
    return {a, b, height(a) / (height(a) - height(b))};
  }

  std::vector<int> triangles_at(const PathNode& node) const {
    std::vector<int> found;
    const auto first = static_cast<size_t>(links_.vertex_offsets[static_cast<size_t>(node.a)]),
               last = static_cast<size_t>(links_.vertex_offsets[static_cast<size_t>(node.a) + 1]);
    for (size_t i = first; i < last; ++i) {
      const int t = links_.vertex_triangles[i];
      const Triangle& k = mesh_.triangles[static_cast<size_t>(t)];
      if (node.is_vertex() || std::find(k.begin(), k.end(), node.b) != k.end()) found.push_back(t);
    }
    return found;
  }

  /// Heights over the line, 0 at vertices that it passes close by.
  std::vector<double> snapped_heights() const {
    std::vector<double> heights(mesh_.vertices.size());
    for (size_t v = 0; v < heights.size(); ++v)
      heights[v] = line_.above(mesh_.vertices[v]);
    struct Near {
      double share;
      int vertex;
    };
    std::vector<Near> near;
    for (const Triangle& k : mesh_.triangles)
      for (size_t e = 0; e < 3; ++e) {
        const int a = k[e], b = k[(e + 1) % 3];
        const double x = heights[static_cast<size_t>(a)], y = heights[static_cast<size_t>(b)];
        if (!(x * y < 0.0)) continue;
        const double share = x / (x - y);
        if (share < snap) near.push_back({share, a});
        if (share > 1.0 - snap) near.push_back({1.0 - share, b});
      }
    std::sort(near.begin(), near.end(), [](const Near& l, const Near& r) {
      return l.share != r.share ? l.share < r.share : l.vertex < r.vertex;
    });
    std::vector<double> result = heights;
    for (const Near& candidate : near)
      if (!flattens_triangle(result, candidate.vertex)) result[static_cast<size_t>(candidate.vertex)] = 0.0;
    return result;
  }

  /// Whether a triangle would lie on the line with all its corners if this one did.
  bool flattens_triangle(const std::vector<double>& heights, int v) const {
    const auto first = static_cast<size_t>(links_.vertex_offsets[static_cast<size_t>(v)]),
               last = static_cast<size_t>(links_.vertex_offsets[static_cast<size_t>(v) + 1]);
    for (size_t i = first; i < last; ++i) {
      int others = 0;
      for (const int w : mesh_.triangles[static_cast<size_t>(links_.vertex_triangles[i])])
        others += w != v && heights[static_cast<size_t>(w)] == 0.0 ? 1 : 0;
      if (others >= 2) return true;
    }
    return false;
  }

  const TriangleMesh& mesh_;
  const Connectivity& links_;
  const MeetingLine& line_;
  std::vector<double> above_;
};

/// The piece of the line nearest to where the surface shows in the middle.
std::optional<Tracer::Segment> seed(const Tracer& tracer, const TriangleMesh& mesh,
                                    const spatial::SurfaceQuery& surface, const MeetingLine& line) {
  const auto hit = surface.first_hit(line.place(0.0, 0.0, 1.2 * line.half_width), -line.axes.col(2));
  if (!hit) return std::nullopt;
  std::optional<Tracer::Segment> best;
  double nearest = 0.3 * line.half_width;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (const Tracer::Segment& piece : tracer.segments(t)) {
      const Vec3 middle = 0.5 * (position(mesh, piece.from) + position(mesh, piece.to));
      const double distance = (middle - hit->position).norm();
      if (distance < nearest && triangle_normal(mesh, t).dot(line.axes.col(2)) > -0.5) {
        nearest = distance;
        best = piece;
      }
    }
  if (!best) return best;
  const double course = (position(mesh, best->to) - position(mesh, best->from)).dot(line.axes.col(0));
  if (course < 0.0) std::swap(best->from, best->to);
  return best;
}

}  // namespace

Vec3 position(const TriangleMesh& mesh, const PathNode& node) {
  const Vec3& a = mesh.vertices[static_cast<size_t>(node.a)];
  return node.is_vertex()
             ? a
             : Vec3((1.0 - node.share) * a + node.share * mesh.vertices[static_cast<size_t>(node.b)]);
}

Path trace(const TriangleMesh& mesh, const Connectivity& links, const spatial::SurfaceQuery& surface,
           const MeetingLine& line, double end) {
  Path path;
  const Tracer tracer(mesh, links, line);
  const auto first = seed(tracer, mesh, surface, line);
  if (!first) return path;
  std::vector<Tracer::Segment> halves[2];  // to the right, to the left
  for (const bool is_left : {false, true}) {
    const double way = is_left ? 1.0 : -1.0;
    Tracer::Segment at = is_left ? *first : Tracer::Segment{first->to, first->from, first->triangle};
    std::vector<Tracer::Segment>& half = halves[is_left];
    while (way * line.along(position(mesh, at.to)) < end) {
      half.push_back(at);
      const auto on = tracer.next(at, way);
      if (!on || half.size() > 20000) return path;
      at = *on;
    }
    // End at the node that is nearest to where the line ends.
    if (way * line.along(position(mesh, at.to)) - end < end - way * line.along(position(mesh, at.from)))
      half.push_back(at);
  }
  if (halves[0].empty() || halves[1].empty()) return path;
  std::vector<Tracer::Segment> whole;
  for (size_t i = halves[0].size() - 1; i > 0; --i)  // the first is in both
    whole.push_back({halves[0][i].to, halves[0][i].from, halves[0][i].triangle});
  whole.insert(whole.end(), halves[1].begin(), halves[1].end());
  if (whole.size() < 2) return path;
  path.nodes.push_back(whole.front().from);
  for (const Tracer::Segment& segment : whole) {
    path.nodes.push_back(segment.to);
    path.triangles.push_back(segment.triangle);
  }
  path.above = tracer.above();
  return path;
}

}  // namespace fascia::openings
