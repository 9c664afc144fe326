#include "builder/geodesics/funnel.h"

#include <algorithm>

#include "builder/geodesics/cross.h"

namespace fascia::geodesics {

namespace {

using Node = Workspace::Node;

/// Positive when `c` lies to the left of the line from `a` to `b`.
double side(const Node& a, const Node& b, const Node& c) {
  return cross(b.place - a.place, c.place - a.place);
}

/// Third corner of the triangle left of `half_edge`, which is laid from `origin` to `target`.
inline Vec2 unfold(const Surface& surface, int half_edge, const Vec2& origin, const Vec2& target) {
  const Vec2 along = target - origin;
  const Vec2& apex = surface.apex[half_edge];
  return origin + apex[0] * along + apex[1] * Vec2(-along[1], along[0]);
}

void set_node(Node& node, const Vec2& place, int first, bool left) {
  node.place = place;
  node.first = node.last = first;
  node.parent = -1;
  node.left = left;
}

/// Nodes of the unfolded strip: node 0 is `from`, the last `to`, one a vertex and stay in the strip.
void unfold_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                  Workspace& workspace) {
  const std::vector<int>& strip = workspace.strip;
  const int count = static_cast<int>(strip.size());
  workspace.nodes.resize(static_cast<size_t>(count) + 3);
  workspace.left_node.resize(count);
  workspace.right_node.resize(count);
  Node* const nodes = workspace.nodes.data();
  // Facing the way out of a triangle, the half-edge's target is on the left, its origin on the right.
  const int h = strip[0];
  const Vec2 right(0.0, 0.0), left(surface.length[h], 0.0);
  const Vec2 behind = unfold(surface, h, right, left);
  const Vec3& weights = from.barycentric;
  set_node(nodes[0],
           weights[h % 3] * right + weights[Surface::next(h) % 3] * left +
               weights[Surface::previous(h) % 3] * behind,
           -1, false);
  set_node(nodes[1], right, 0, false);
  set_node(nodes[2], left, 0, true);
  int r = 1, l = 2;
  workspace.right_node[0] = r;
  workspace.left_node[0] = l;
  for (int k = 1; k < count; ++k) {
    const int entered = surface.twin[strip[k - 1]];
    const Vec2 ahead = unfold(surface, entered, nodes[l].place, nodes[r].place);
    const bool turns_right = strip[k] == Surface::next(entered);  // the vertex ahead stays on the left
    set_node(nodes[k + 2], ahead, k, turns_right);
    (turns_right ? l : r) = k + 2;
    workspace.left_node[k] = l;
    workspace.right_node[k] = r;
    nodes[l].last = nodes[r].last = k;
  }
  const int entered = surface.twin[strip[count - 1]];
  const Vec2 ahead = unfold(surface, entered, nodes[l].place, nodes[r].place);
  const Vec3& w = to.barycentric;
  set_node(nodes[count + 2],
           w[entered % 3] * nodes[l].place + w[Surface::next(entered) % 3] * nodes[r].place +
               w[Surface::previous(entered) % 3] * ahead,
           count, false);
}

/// The funnel: nodes of the left chain from its far end to the apex, then the right chain outwards.
class Funnel {
 public:
  Funnel(Workspace& workspace, size_t reach) : nodes_(workspace.nodes), chain_(workspace.funnel) {
    chain_.resize(2 * reach + 1);
    low_ = apex_ = high_ = static_cast<int>(reach);
    chain_[apex_] = 0;
  }

  void add(int added) {
    if (nodes_[added].left)
      add_left(added);
    else
      add_right(added);
  }

  /// Hangs the end of the path onto the funnel without extending it.
  void finish(int added) { add_left(added); }

 private:
  // A node in line with the chain stays, so that a vertex the path runs straight over is seen.
  void add_left(int added) {
    while (low_ < apex_ && side(node(low_ + 1), node(low_), nodes_[added]) < 0.0)
      ++low_;
    if (low_ == apex_)
      while (apex_ < high_ && side(node(apex_), node(apex_ + 1), nodes_[added]) <= 0.0)
        low_ = ++apex_;
    nodes_[added].parent = chain_[low_];
    chain_[--low_] = added;
  }

  void add_right(int added) {
    while (high_ > apex_ && side(node(high_ - 1), node(high_), nodes_[added]) > 0.0)
      --high_;
    if (high_ == apex_)
      while (apex_ > low_ && side(node(apex_), node(apex_ - 1), nodes_[added]) >= 0.0)
        high_ = --apex_;
    nodes_[added].parent = chain_[high_];
    chain_[++high_] = added;
  }

  const Node& node(int at) const { return nodes_[chain_[at]]; }

  std::vector<Node>& nodes_;
  std::vector<int>& chain_;
  int low_, apex_, high_;
};

}  // namespace

double pull_taut(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                 Workspace& workspace) {
  unfold_strip(surface, from, to, workspace);
  const int count = static_cast<int>(workspace.nodes.size());
  Funnel funnel(workspace, static_cast<size_t>(count) + 1);
  for (int i = 1; i < count - 1; ++i)
    funnel.add(i);
  funnel.finish(count - 1);
  workspace.taut.clear();
  double length = 0.0;
  for (int i = count - 1; i >= 0; i = workspace.nodes[i].parent) {
    workspace.taut.push_back(i);
    if (i > 0) length += (workspace.nodes[i].place - workspace.nodes[workspace.nodes[i].parent].place).norm();
  }
  std::reverse(workspace.taut.begin(), workspace.taut.end());
  return length;
}

}  // namespace fascia::geodesics
