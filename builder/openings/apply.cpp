#include "builder/openings/apply.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

namespace fascia::openings {

namespace {

/// The welded skin after cut and lining.
struct NewSkin {
  TriangleMesh mesh;
  std::vector<int> of;  ///< vertex of cut or lining (as Lining::triangles number them) -> vertex, or -1
};

NewSkin new_skin(const TriangleMesh& skin, const Cut& cut, const Lining& lining) {
  NewSkin next;
  next.mesh.vertices = skin.vertices;
  next.of.assign(static_cast<size_t>(cut.count()) + lining.vertices.size(), -1);
  for (int v = 0; v < cut.vertex_count; ++v)
    next.of[static_cast<size_t>(v)] = v;
  const auto place = [&](int vertex) {
    if (int& at = next.of[static_cast<size_t>(vertex)]; at < 0) {
      at = next.mesh.vertex_count();
      Vec3 p = vertex < cut.count() ? position(skin, cut.node_of(vertex))
                                    : lining.vertices[static_cast<size_t>(vertex - cut.count())];
      if (vertex < cut.count() && cut.is_lower(vertex)) p += cut.apart;
      next.mesh.vertices.push_back(p);
    }
    return next.of[static_cast<size_t>(vertex)];
  };
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const auto pieces = cut.triangles.find(t);
    if (pieces == cut.triangles.end())
      next.mesh.triangles.push_back(skin.triangles[static_cast<size_t>(t)]);
    else
      for (const Triangle& piece : pieces->second)
        next.mesh.triangles.push_back({place(piece[0]), place(piece[1]), place(piece[2])});
  }
  for (const Triangle& t : lining.triangles)
    next.mesh.triangles.push_back({place(t[0]), place(t[1]), place(t[2])});
  return next;
}

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// One of the user's meshes while it is being cut.
class MeshCutter {
 public:
  MeshCutter(const Cut& cut, const NewSkin& skin, const Mat4& to_file, prepare::PreparedMesh& head,
             formats::SceneMesh& scene, formats::MeshExtension& extension, bool is_inside_out)
      : cut_(cut),
        skin_(skin),
        to_file_(to_file),
        head_(head),
        scene_(scene),
        extension_(extension),
        is_inside_out_(is_inside_out) {}

  /// Cuts all triangles that lie on those of `by_corners` (sorted corners -> triangle of the old skin).
  void cut(const std::map<Triangle, int>& by_corners, const TriangleMesh& old_skin) {
    const size_t count = scene_.triangles.size();
    for (size_t t = 0; t < count; ++t) {
      const Triangle own = scene_.triangles[t];
      const auto at = by_corners.find(sorted(skin_corners(own)));
      if (at == by_corners.end()) continue;
      const Triangle& skin_triangle = old_skin.triangles[static_cast<size_t>(at->second)];
      bool is_first = true;
      for (const Triangle& piece : cut_.triangles.at(at->second)) {
        Triangle corners;
        for (size_t k = 0; k < 3; ++k)
          corners[k] = vertex_of(piece[k], own, skin_triangle);
        if (runs_against(skin_corners(own), skin_triangle)) std::swap(corners[1], corners[2]);
        put(corners, static_cast<int>(t), is_first);
        is_first = false;
      }
    }
  }

  /// Removes triangles that the welded skin lacks, being without height or folded flat onto one another, and
  /// that would hold both sides of the cut together. `skin_triangles`: sorted corners of the old skin's
  /// triangles beside the cut, in order.
  void remove_bridges(const std::vector<Triangle>& skin_triangles, const std::set<int>& beside_cut) {
    std::map<Triangle, int> copies;  // of those that span the cut
    for (const Triangle& t : scene_.triangles)
      if (const Triangle corners = skin_corners(t); cut_spans(corners, beside_cut)) ++copies[sorted(corners)];
    size_t kept = 0;
    for (size_t t = 0; t < scene_.triangles.size(); ++t) {
      const Triangle corners = sorted(skin_corners(scene_.triangles[t]));
      const auto spanning = copies.find(corners);
      const bool is_bridge = spanning != copies.end() &&
                             (spanning->second > 1 || is_flat(scene_.triangles[t])) &&
                             !std::binary_search(skin_triangles.begin(), skin_triangles.end(), corners);
      if (is_bridge) continue;
      scene_.triangles[kept] = scene_.triangles[t];
      extension_.origin[kept++] = extension_.origin[t];
    }
    scene_.triangles.resize(kept);
    extension_.origin.resize(kept);
  }

  /// The user's vertex that stands for one of the cut or lining; appended when there is none yet.
  int lining_vertex(int vertex, const Lining& lining) {
    if (const auto at = any_.find(vertex); at != any_.end()) return at->second;
    const bool is_lining = vertex >= cut_.count();
    if (vertex < cut_.vertex_count) {
      for (size_t v = 0; v < head_.skin_vertices.size(); ++v)
        if (head_.skin_vertices[v] == vertex) return any_[vertex] = static_cast<int>(v);
    }
    int like = 0;  // whose looks it takes
    if (is_lining) {
      like = lining_vertex(lining.like[static_cast<size_t>(vertex - cut_.count())], lining);
    } else if (!any_.empty()) {
      like = any_.begin()->second;
    }
    return any_[vertex] = append(vertex, {like, like, 0.0, std::nullopt});
  }

  void add_lining(const Lining& lining) {
    const size_t first = scene_.positions.size();
    for (const Triangle& t : lining.triangles) {
      Triangle corners;
      for (size_t k = 0; k < 3; ++k)
        corners[k] = lining_vertex(t[k], lining);
      if (is_inside_out_) std::swap(corners[1], corners[2]);
      put(corners, -1, false);
    }
    const std::vector<Vec3> normals = vertex_normals({scene_.positions, scene_.triangles});
    for (size_t v = first; v < normals.size(); ++v)
      extension_.vertices[v - static_cast<size_t>(extension_.vertices_before)].normal = normals[v];
  }

  /// How many of the cut's vertices, or of those that the lining hangs on, this mesh has.
  size_t share(const Lining& lining) const {
    if (!cut_.path.nodes.empty()) return any_.size();
    const std::set<int> own(head_.skin_vertices.begin(), head_.skin_vertices.end());
    return static_cast<size_t>(
        std::count_if(lining.like.begin(), lining.like.end(), [&](int v) { return own.count(v) > 0; }));
  }

 private:
  Triangle skin_corners(const Triangle& t) const {
    return {head_.skin_vertices[static_cast<size_t>(t[0])], head_.skin_vertices[static_cast<size_t>(t[1])],
            head_.skin_vertices[static_cast<size_t>(t[2])]};
  }

  bool is_flat(const Triangle& t) const {
    constexpr double lowest = 2e-5;  // metres
    const auto corner = [&](size_t k) -> const Vec3& { return head_.positions[static_cast<size_t>(t[k])]; };
    return triangle_height(corner(0), corner(1), corner(2)) <= lowest;
  }

  /// Whether of the corners beside the cut some lie below it and others on it or above. A corner that the
  /// skin lacks may lie on either side.
  bool cut_spans(const Triangle& corners, const std::set<int>& beside_cut) const {
    bool is_below = false, is_above = false, is_unknown = false;
    for (const int v : corners) {
      is_unknown = is_unknown || v < 0;
      if (beside_cut.count(v) == 0) continue;
      (cut_.path.above[static_cast<size_t>(v)] < 0.0 ? is_below : is_above) = true;
    }
    return (is_below && is_above) || (is_unknown && (is_below || is_above));
  }

  static bool runs_against(const Triangle& a, const Triangle& b) {
    for (size_t k = 0; k < 3; ++k)
      if (a[0] == b[k]) return a[1] != b[(k + 1) % 3];
    return false;
  }

  void put(const Triangle& corners, int triangle, bool in_place) {
    const int origin = triangle < 0 ? -1 : extension_.origin[static_cast<size_t>(triangle)];
    if (in_place) {
      scene_.triangles[static_cast<size_t>(triangle)] = corners;
    } else {
      scene_.triangles.push_back(corners);
      extension_.origin.push_back(origin);
    }
  }

  int vertex_of(int vertex, const Triangle& own, const Triangle& skin_triangle) {
    const auto own_corner = [&](int skin_vertex) {
      const Triangle corners = skin_corners(own);
      for (size_t k = 0; k < 3; ++k)
        if (corners[k] == skin_vertex) return own[k];
      return own[0];
    };
    (void)skin_triangle;
    if (vertex < cut_.vertex_count) {
      const int corner = own_corner(vertex);
      any_.emplace(vertex, corner);
      return corner;
    }
    const PathNode& node = cut_.node_of(vertex);
    int a = own_corner(node.a), b = node.is_vertex() ? a : own_corner(node.b);
    double share = node.share;
    if (a > b) {
      std::swap(a, b);
      share = 1.0 - share;
    }
    const auto [at, is_new] = made_.try_emplace({vertex, a, b}, -1);
    if (is_new) at->second = append(vertex, {a, b, share, std::nullopt});
    any_.emplace(vertex, at->second);
    return at->second;
  }

  int append(int vertex, const formats::AppendedVertex& looks) {
    const int skin_vertex = skin_.of[static_cast<size_t>(vertex)];
    const Vec3& p = skin_.mesh.vertices[static_cast<size_t>(skin_vertex)];
    const auto a = static_cast<size_t>(looks.a), b = static_cast<size_t>(looks.b);
    head_.positions.push_back(p);
    head_.parts.push_back(prepare::Part::skin);
    head_.skin_vertices.push_back(skin_vertex);
    scene_.positions.push_back(transform_point(to_file_, p));
    if (!scene_.uvs.empty())
      scene_.uvs.push_back((1.0 - looks.share) * scene_.uvs[a] + looks.share * scene_.uvs[b]);
    if (!scene_.colours.empty())
      scene_.colours.push_back((1.0 - looks.share) * scene_.colours[a] + looks.share * scene_.colours[b]);
    extension_.vertices.push_back(looks);
    return static_cast<int>(scene_.positions.size()) - 1;
  }

  const Cut& cut_;
  const NewSkin& skin_;
  const Mat4 to_file_;
  prepare::PreparedMesh& head_;
  formats::SceneMesh& scene_;
  formats::MeshExtension& extension_;
  bool is_inside_out_;
  std::map<std::tuple<int, int, int>, int> made_;  // (vertex of the cut, the user's ends of its edge)
  std::map<int, int> any_;                         // vertex of cut or lining -> one of the user's
};

}  // namespace

int apply(const Cut& cut, const Lining& lining, prepare::PreparedHead& head, OpenedHead& opened,
          bool is_inside_out) {
  const NewSkin skin = new_skin(head.skin, cut, lining);
  std::map<Triangle, int> by_corners;
  std::set<int> beside_cut;
  for (const auto& [t, pieces] : cut.triangles) {
    const Triangle& corners = head.skin.triangles[static_cast<size_t>(t)];
    by_corners[sorted(corners)] = t;
    beside_cut.insert(corners.begin(), corners.end());
  }
  std::vector<Triangle> skin_triangles;
  for (const Triangle& t : head.skin.triangles)
    if (std::any_of(t.begin(), t.end(), [&](int v) { return beside_cut.count(v) > 0; }))
      skin_triangles.push_back(sorted(t));
  std::sort(skin_triangles.begin(), skin_triangles.end());
  const Mat4 to_file = head.input_to_metres.inverse();
  std::vector<MeshCutter> cutters;
  int before = 0, after = 0;
  size_t main = 0;
  for (size_t m = 0; m < opened.extensions.size(); ++m) {
    before += static_cast<int>(opened.scene.meshes[m].positions.size());
    cutters.emplace_back(cut, skin, to_file, head.meshes[m], opened.scene.meshes[m], opened.extensions[m],
                         is_inside_out);
    cutters.back().remove_bridges(skin_triangles, beside_cut);
    cutters.back().cut(by_corners, head.skin);
    if (cutters.back().share(lining) > cutters[main].share(lining)) main = m;
  }
  cutters[main].add_lining(lining);
  for (size_t m = 0; m < opened.extensions.size(); ++m) {
    head.meshes[m].triangles = opened.scene.meshes[m].triangles;
    if (is_inside_out)
      for (Triangle& t : head.meshes[m].triangles)
        std::swap(t[1], t[2]);
    after += static_cast<int>(opened.scene.meshes[m].positions.size());
  }
  head.skin = skin.mesh;
  head.surface.emplace(head.skin);
  return after - before;
}

}  // namespace fascia::openings
