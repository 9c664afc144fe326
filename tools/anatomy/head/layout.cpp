#include "tools/anatomy/head/layout.h"

#include <cmath>
#include <set>

#include "geometry/error.h"

namespace fascia::head_maker {

std::string numbered(char letter, int k) {
  std::string name(1, letter);
  name += std::to_string(k);
  return name;
}

int HalfHead::add_vertex(const Vec3& point, bool on_midline) {
  vertices.push_back(on_midline ? Vec3(0.0, point.y(), point.z()) : point);
  midline.push_back(on_midline ? 1 : 0);
  return static_cast<int>(vertices.size()) - 1;
}

void HalfHead::add_quad(const Quad& quad, const std::string& name) {
  quads.push_back(quad);
  region.push_back(name);
}

namespace {

/// Refines the patches of the cage, sharing the vertices of nodes and edges.
class Refiner {
 public:
  Refiner(const std::map<char, std::vector<Vec3>>& openings, HalfHead& head, std::vector<char>& fixed)
      : head_(head), fixed_(fixed) {
    for (const auto& [letter, points] : openings)
      add_opening(letter, points);
    for (const CageNode& node : cage_nodes()) {
      node_[node.name] = add(node.guess, node.guess.x() == 0.0, node.anchored ? 1 : 0);
    }
  }

  void add_patch(const CagePatch& patch) {
    const auto& c = patch.corners;
    const std::vector<int> bottom = edge(c[0], c[1]), right = edge(c[1], c[2]), top = edge(c[3], c[2]),
                           left = edge(c[0], c[3]);
    int grid[kSplit + 1][kSplit + 1];
    for (int i = 0; i <= kSplit; ++i)
      for (int j = 0; j <= kSplit; ++j) {
        if (j == 0)
          grid[i][j] = bottom[i];
        else if (j == kSplit)
          grid[i][j] = top[i];
        else if (i == 0)
          grid[i][j] = left[j];
        else if (i == kSplit)
          grid[i][j] = right[j];
        else
          grid[i][j] = add(coons(bottom, right, top, left, i, j), false, 0);
      }
    for (int i = 0; i < kSplit; ++i)
      for (int j = 0; j < kSplit; ++j)
        head_.add_quad({grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]}, patch.region);
  }

  std::vector<int> edge(const std::string& from, const std::string& to) {
    if (to < from) {
      std::vector<int> way = edge(to, from);
      return {way.rbegin(), way.rend()};
    }
    auto& way = edge_[{from, to}];
    if (!way.empty()) return way;
    const int a = node(from), b = node(to);
    const bool on_midline = head_.midline[a] && head_.midline[b];
    way.push_back(a);
    for (int k = 1; k < kSplit; ++k) {
      const double t = static_cast<double>(k) / kSplit;
      way.push_back(add(head_.vertices[a] * (1 - t) + head_.vertices[b] * t, on_midline, 0));
    }
    way.push_back(b);
    return way;
  }

 private:
  int add(const Vec3& point, bool on_midline, char fixed) {
    fixed_.push_back(fixed);
    return head_.add_vertex(point, on_midline);
  }

  int node(const std::string& name) const {
    const auto found = node_.find(name);
    if (found == node_.end()) throw Error("head cage: no node " + name);
    return found->second;
  }

  void add_opening(char letter, const std::vector<Vec3>& points) {
    std::vector<int> loop;
    const bool closed = letter != 'M';
    for (std::size_t i = 0; i < points.size(); ++i)
      loop.push_back(add(points[i], !closed && (i == 0 || i + 1 == points.size()), 2));
    const int spans = static_cast<int>(closed ? points.size() : points.size() - 1) / kSplit;
    for (int s = 0; s <= spans; ++s) {
      if (closed && s == spans) break;
      node_[numbered(letter, s)] = loop[s * kSplit];
    }
    for (int s = 0; s < spans; ++s) {
      const std::string from = numbered(letter, s);
      const std::string to = numbered(letter, closed ? (s + 1) % spans : s + 1);
      std::vector<int> way;
      for (int k = 0; k <= kSplit; ++k)
        way.push_back(loop[(s * kSplit + k) % loop.size()]);
      if (to < from) way = {way.rbegin(), way.rend()};
      edge_[{std::min(from, to), std::max(from, to)}] = way;
    }
    head_.loops[std::string(1, letter)] = loop;
  }

  Vec3 coons(const std::vector<int>& bottom, const std::vector<int>& right, const std::vector<int>& top,
             const std::vector<int>& left, int i, int j) const {
    const auto& v = head_.vertices;
    const double s = static_cast<double>(i) / kSplit, t = static_cast<double>(j) / kSplit;
    const Vec3 across = v[left[j]] * (1 - s) + v[right[j]] * s;
    const Vec3 along = v[bottom[i]] * (1 - t) + v[top[i]] * t;
    const Vec3 corners = (v[bottom[0]] * (1 - s) + v[bottom[kSplit]] * s) * (1 - t) +
                         (v[top[0]] * (1 - s) + v[top[kSplit]] * s) * t;
    return across + along - corners;
  }

  HalfHead& head_;
  std::vector<char>& fixed_;
  std::map<std::string, int> node_;
  std::map<std::pair<std::string, std::string>, std::vector<int>> edge_;
};

}  // namespace

HalfHead refine_cage(const std::map<char, std::vector<Vec3>>& openings, std::vector<char>& fixed) {
  HalfHead head;
  fixed.clear();
  Refiner refiner(openings, head, fixed);
  for (const CagePatch& patch : cage_patches())
    refiner.add_patch(patch);
  std::vector<int>& end = head.loops["neck_end"];
  for (int k = 0; k < 9; ++k) {
    const auto way = refiner.edge(numbered('U', k), numbered('U', k + 1));
    end.insert(end.end(), way.begin() + (k > 0), way.end());
  }
  return head;
}

}  // namespace fascia::head_maker
