#include "builder/smas/marching_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string>

#include "builder/smas/front.h"
#include "builder/smas/gaps.h"
#include "builder/smas/surface_probe.h"
#include "builder/smas/surface_quality.h"
#include "builder/smas/surroundings.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::smas {

namespace {

// Vertices that are moved onto the surface in the end may lie this part of an edge off it until then.
constexpr double kLooseTolerance = 2e-3;

ProbeOptions probe_options(const MarchingOptions& options) {
  const double shortest = options.min_edge_length > 0.0
                              ? std::min(options.min_edge_length, options.edge_length)
                              : options.edge_length;
  const double tolerance = options.improve ? std::max(options.tolerance, kLooseTolerance) : options.tolerance;
  return {options.edge_length, shortest, options.max_normal_turn,
          tolerance * (options.improve ? shortest : options.edge_length)};
}

class Marcher {
 public:
  Marcher(const ImplicitFunction& function, const MarchingOptions& options)
      : front(options.edge_length),
        options_(options),
        shortest_(probe_options(options).shortest),
        probe_(function, probe_options(options)),
        around_(front) {}

  bool start_from(const Vec3& seed);
  void grow();
  void close_gaps() { close_small_gaps(deferred_, options_.domain, &front); }
  long evaluations() const { return probe_.evaluations(); }

  Front front;

 private:
  bool allowed(const Vec3& point) const { return !options_.domain || options_.domain(point); }
  bool fill(int e, double reach);
  bool add_triangle(const EdgeFrame& frame);
  bool join(const EdgeFrame& frame, const std::vector<int>& partners, bool only_shapely);
  void push_new(size_t first) {
    for (size_t e = first; e < front.edges.size(); ++e)
      queue_.push_back(static_cast<int>(e));
  }

  const MarchingOptions& options_;
  const double shortest_;
  SurfaceProbe probe_;
  Surroundings around_;
  std::deque<int> queue_;
  std::vector<int> deferred_;
};

// Puts the triangle to the first of `partners` that fits on the edge.
bool Marcher::join(const EdgeFrame& frame, const std::vector<int>& partners, bool only_shapely) {
  for (int q : partners) {
    const Vec3 to_a = frame.pa - front.mesh.vertices[q], to_b = frame.pb - front.mesh.vertices[q];
    const double cosine = to_a.dot(to_b) / (to_a.norm() * to_b.norm());
    const bool shapely = cosine < 0.87 && std::max(to_a.norm(), to_b.norm()) < 1.6 * frame.size;
    if (only_shapely && !shapely) continue;
    if (around_.fits(front.mesh.vertices[q], front.normals[q], q) && front.connect(frame.e, q)) return true;
  }
  return false;
}

// Puts a triangle on front edge `e`, if one fits; looks for partners `reach` edge lengths around.
bool Marcher::fill(int e, double reach) {
  EdgeFrame frame;
  if (!frame.set(front, e)) return false;
  around_.gather(frame, reach * frame.size);
  // Where a vertex is in the way of what the normals foretell no new one is needed: no call of the function.
  const Vec3 foretold = probe_.foretell(front, frame);
  if (around_.blocked(foretold)) {
    const std::vector<int>& partners = around_.partners();
    if (join(frame, partners, true) || (allowed(foretold) && join(frame, partners, false))) return true;
  }

  double size = 0.0;
  const SurfaceProbe::Hit hit = probe_.apex(front, frame, &size);
  const bool inside = hit.found && allowed(hit.point);
  if (inside && !around_.blocked(hit.point) && around_.fits(hit.point, hit.normal, -1)) {
    const int p = front.add_vertex(hit.point, hit.normal, size);
    if (front.connect(frame.e, p)) return true;
  }
  // Outside the domain nothing must be filled: take only well-shaped triangles there.
  return join(frame, around_.partners(), hit.found && !inside);
}

bool Marcher::start_from(const Vec3& seed) {
  const double length = options_.edge_length;
  const SurfaceProbe::Hit first = probe_.descend(seed, 2.0 * length);
  if (!first.found || !allowed(first.point)) return false;
  std::vector<int> near;
  front.all.near(first.point, 0.85 * length, &near);
  for (int q : near)
    if (front.normals[q].dot(first.normal) > 0.0) return true;  // meshed already

  for (double step = length; step > 0.05 * shortest_; step *= 0.6) {
    const Vec3 along = first.normal.unitOrthogonal();
    const SurfaceProbe::Hit second = probe_.descend(first.point + step * along, step);
    const SurfaceProbe::Hit third =
        probe_.descend(first.point + step * (0.5 * along + 0.866 * first.normal.cross(along)), step);
    if (!second.found || !third.found) continue;
    const Vec3 facet = (second.point - first.point).cross(third.point - first.point);
    const double turn = std::min(second.normal.dot(first.normal), third.normal.dot(first.normal));
    const bool flat = step > 1.01 * shortest_ ? turn > std::cos(options_.max_normal_turn) : turn > 0.5;
    if (!flat || facet.dot(first.normal) < 0.3 * step * step) continue;
    if (!allowed(second.point) || !allowed(third.point)) continue;
    const double size = std::clamp(step, shortest_, length);
    const int a = front.add_vertex(first.point, first.normal, size);
    const int b = front.add_vertex(second.point, second.normal, size);
    const int c = front.add_vertex(third.point, third.normal, size);
    const int e = front.add_first_triangle(a, b, c);
    push_new(e);
    return true;
  }
  return false;
}

void Marcher::grow() {
  // Edges that nothing fits wait until their neighbours have moved, and then look further afield.
  for (double reach : {1.6, 1.6, 2.4, 3.5}) {
    bool progress = true;
    for (int round = 0; progress && round < 8; ++round) {
      progress = false;
      queue_.insert(queue_.end(), deferred_.begin(), deferred_.end());
      deferred_.clear();
      while (!queue_.empty()) {
        const int e = queue_.front();
        queue_.pop_front();
        if (!front.edges[e].alive) continue;
        const size_t first = front.edges.size();
        if (fill(e, reach)) {
          push_new(first);
          progress = true;
        } else {
          deferred_.push_back(e);
        }
        if (front.mesh.vertex_count() > options_.max_vertices)
          throw Error("marching triangles: the surface takes more than " +
                      std::to_string(options_.max_vertices) +
                      " vertices; limit its domain or take a larger edge length");
      }
    }
  }
}

void check(const MarchingOptions& options) {
  if (!(options.edge_length > 0.0) || !std::isfinite(options.edge_length))
    throw Error("marching triangles: edge_length must be a positive length");
  if (!(options.min_edge_length >= 0.0) || !(options.max_normal_turn > 0.01) || !(options.tolerance > 0.0))
    throw Error("marching triangles: min_edge_length, max_normal_turn or tolerance is out of range");
  if (options.seeds.empty())
    throw Error("marching triangles: no seeds; give at least one point near each part of the surface");
}

}  // namespace

MarchingResult marching_triangles(const ImplicitFunction& function, const MarchingOptions& options) {
  check(options);
  Marcher marcher(function, options);
  bool started = false;
  for (const Vec3& seed : options.seeds)
    if (seed.allFinite() && marcher.start_from(seed)) {
      started = true;
      marcher.grow();
      marcher.close_gaps();
    }
  if (!started)
    throw Error("marching triangles: none of the " + std::to_string(options.seeds.size()) +
                " seeds reaches the surface within its domain");
  MarchingResult result;
  result.mesh = std::move(marcher.front.mesh);
  result.normals = std::move(marcher.front.normals);
  result.sizes = std::move(marcher.front.sizes);
  result.evaluations = marcher.evaluations();
  if (options.improve) {
    QualityOptions quality;
    quality.tolerance = options.tolerance * options.edge_length;
    quality.passes = 2;
    result.evaluations += improve_triangles(function, quality, &result.mesh, &result.normals, &result.sizes);
  }
  components(result.mesh, &result.parts);
  const Connectivity links = connectivity(result.mesh);
  for (const auto& neighbours : links.neighbours)
    for (int neighbour : neighbours)
      result.boundary_edges += neighbour < 0;
  return result;
}

std::vector<Vec3> grid_seeds(const ImplicitFunction& function, const Bounds& box, double spacing) {
  if (!(spacing > 0.0)) throw Error("marching triangles: the spacing of seeds must be positive");
  const Vec3 size = box.size();
  if (!(size.minCoeff() >= 0.0) || !size.allFinite())
    throw Error("marching triangles: the box of the seeds is empty");
  std::array<int, 3> count;
  for (int k = 0; k < 3; ++k)
    count[k] = static_cast<int>(std::floor(size[k] / spacing)) + 2;
  if (static_cast<double>(count[0]) * count[1] * count[2] > 5e7)
    throw Error("marching triangles: too many seeds; take a larger spacing");
  const auto index = [&](int x, int y, int z) {
    return (static_cast<size_t>(z) * count[1] + y) * count[0] + x;
  };
  const auto point = [&](int x, int y, int z) { return Vec3(box.lower + spacing * Vec3(x, y, z)); };
  std::vector<double> values(static_cast<size_t>(count[0]) * count[1] * count[2]);
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x)
        values[index(x, y, z)] = function(point(x, y, z), nullptr);
  std::vector<Vec3> seeds;
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x)
        for (int k = 0; k < 3; ++k) {
          const std::array<int, 3> to = {x + (k == 0), y + (k == 1), z + (k == 2)};
          if (to[k] >= count[k]) continue;
          const double from = values[index(x, y, z)], there = values[index(to[0], to[1], to[2])];
          if ((from <= 0.0) == (there <= 0.0) || !std::isfinite(from) || !std::isfinite(there)) continue;
          const double part = from / (from - there);
          seeds.push_back(point(x, y, z) + part * (point(to[0], to[1], to[2]) - point(x, y, z)));
        }
  return seeds;
}

}  // namespace fascia::smas
