#include "builder/smas/gaps.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "builder/smas/surface_probe.h"

namespace fascia::smas {

namespace {

constexpr size_t kLongestLoop = 24;

// The loop through front edge `e`, empty when it is longer than a gap.
std::vector<int> small_loop(const Front& front, int e) {
  std::vector<int> loop;
  for (int at = e; loop.empty() || at != e; at = front.edges[at].next) {
    loop.push_back(at);
    if (loop.size() > kLongestLoop) return {};
  }
  return loop;
}

// A loop about the end of the domain is meant to stay.
bool ends_domain(const Front& front, const std::vector<int>& loop,
                 const std::function<bool(const Vec3&)>& domain) {
  for (int e : loop) {
    EdgeFrame frame;
    if (domain && frame.set(front, e) && !domain(frame.mid + 0.7 * frame.size * frame.o)) return true;
  }
  return false;
}

// Of `count` edges of a loop from `first` on, the one that makes the sharpest upright ear with the next.
int sharpest_ear(const Front& front, int first, size_t count) {
  int best = -1, e = first;
  double best_score = -2.0;
  for (size_t k = 0; k < count; ++k, e = front.edges[e].next) {
    const Front::Edge &edge = front.edges[e], &next = front.edges[edge.next];
    const Vec3 &a = front.mesh.vertices[edge.from], &b = front.mesh.vertices[edge.to],
               &c = front.mesh.vertices[next.to];
    const bool upright = (a - b).cross(c - b).dot(front.normals[edge.to]) > 0.0;
    const double score = (a - b).normalized().dot((c - b).normalized()) + (upright ? 2.0 : 0.0);
    if (score > best_score) best_score = score, best = e;
  }
  return best;
}

}  // namespace

void close_small_gaps(std::vector<int> left_over, const std::function<bool(const Vec3&)>& domain,
                      Front* front) {
  std::sort(left_over.begin(), left_over.end());
  for (int start : left_over) {
    if (!front->edges[start].alive) continue;
    const std::vector<int> loop = small_loop(*front, start);
    if (loop.empty() || ends_domain(*front, loop, domain)) continue;
    int at = start;
    for (size_t left = loop.size(); left >= 3; --left) {
      const int ear = sharpest_ear(*front, at, left);
      const size_t fresh = front->edges.size();
      if (!front->connect(ear, front->edges[front->edges[ear].next].to) || front->edges.size() == fresh)
        break;
      at = static_cast<int>(fresh);
    }
  }
}

}  // namespace fascia::smas
