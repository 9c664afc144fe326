#include "bench/fit/scans.h"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <set>

#include "fit/scan/scan.h"
#include "formats/scene.h"
#include "geometry/connectivity.h"
#include "rig/read/read.h"

namespace fascia::bench {

namespace {

/// The middles of the posed skin's edges, joined within and across its triangles: no vertex is the rig's.
TriangleMesh remeshed(const fit::Subject& subject, const Eigen::VectorXd& moved) {
  TriangleMesh mesh, rest{{}, subject.skin_triangles()};
  for (size_t v = 0; v < subject.vertex_count(); ++v)
    rest.vertices.push_back(subject.rest().segment<3>(static_cast<Eigen::Index>(3 * v)));
  std::vector<int> welded;  // seams of textures part no skin
  weld(rest, 1e-7, &welded);
  std::vector<int> first_of(rest.vertices.size(), -1);
  for (size_t v = welded.size(); v-- > 0;)
    first_of[static_cast<size_t>(welded[v])] = static_cast<int>(v);
  std::map<std::pair<int, int>, int> middles;
  std::map<int, std::map<int, int>> around;  // a vertex's middles: each with the next, as triangles turn
  const auto place = [&](int v) -> Vec3 {
    const Eigen::Index at = 3 * v;
    return subject.rest().segment<3>(at) + moved.segment<3>(at);
  };
  const auto middle = [&](int a, int b) {
    const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), mesh.vertex_count());
    if (is_new) mesh.vertices.push_back(0.5 * (place(a) + place(b)));
    return entry->second;
  };
  for (Triangle t : rest.triangles) {
    for (int& v : t)
      v = first_of[static_cast<size_t>(welded[static_cast<size_t>(v)])];
    const Triangle inner = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
    mesh.triangles.push_back(inner);
    for (size_t k = 0; k < 3; ++k)
      around[t[k]][inner[k]] = inner[(k + 2) % 3];
  }
  for (const auto& [vertex, next] : around) {  // a fan where the vertex was
    const int first = next.begin()->first;
    int at = next.begin()->second;
    for (size_t step = 0; step < next.size(); ++step) {
      const auto after = next.find(at);
      if (after == next.end() || after->second == first || at == first) break;
      mesh.triangles.push_back({first, at, after->second});
      at = after->second;
    }
  }
  return mesh;
}

}  // namespace

void find_scans(const SculptedHead& head, const std::string& level, const std::set<std::string>& only,
                const fit::FitOptions& options) {
  const std::filesystem::path rig = rig_of(head, level);
  fit::Subject subject(rig::read(formats::read_bytes(rig), rig.string()), level);
  const std::vector<Triangle> triangles = subject.skin_triangles();
  std::set<int> skin;
  for (const Triangle& t : triangles)
    skin.insert(t.begin(), t.end());
  TriangleMesh surface{{}, triangles};
  surface.vertices.resize(subject.vertex_count());
  double sum_share = 0.0, seconds = 0.0;
  int count = 0;
  for (const rig::NamedSet& set : subject.file().rig.actuation.sets) {
    if (set.name != "arkit") continue;
    for (size_t m = 0; m < set.members.size(); ++m) {
      if (!only.empty() && !only.contains(set.members[m])) continue;
      std::vector<float> values;
      for (const rig::Channel& channel : subject.channels())
        values.push_back(channel.rest);
      for (size_t e = 0; e < set.weights.size(); ++e)
        if (set.member_indices[e] == m) values[set.channel_indices[e]] += 0.8F * set.weights[e];
      subject.pose(values, false);
      const Eigen::VectorXd truth = subject.displacements(values);
      if (truth.norm() == 0.0) continue;  // of what the rig has not
      const std::clock_t start = std::clock();
      const fit::ScanFit found = fit::fit_scan(subject, remeshed(subject, truth), options);
      seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      for (const int v : skin)
        surface.vertices[static_cast<size_t>(v)] =
            subject.rest().segment<3>(3 * v) + truth.segment<3>(static_cast<Eigen::Index>(3 * v));
      const std::vector<Vec3> normals = vertex_normals(surface);
      double whole = 0.0, across = 0.0, along = 0.0;
      for (const int v : skin) {
        const Eigen::Index at = 3 * v;
        const Vec3 missed = (found.result.displacements - truth).segment<3>(at);
        const double off = normals[static_cast<size_t>(v)].dot(missed);
        whole += truth.segment<3>(at).squaredNorm();
        across += off * off;
        along += missed.squaredNorm() - off * off;
      }
      std::printf("%-16s %-20s share %6.3f; missed across the surface %.3f, along it %.3f; matched %.2f\n",
                  head.name.c_str(), set.members[m].c_str(), 1.0 - (across + along) / whole, across / whole,
                  along / whole, found.matched_share);
      sum_share += 1.0 - (across + along) / whole;
      ++count;
    }
  }
  std::printf("%-16s mean of %d scans: share %.3f, %.2f s of CPU each\n", head.name.c_str(), count,
              sum_share / std::max(1, count), seconds / std::max(1, count));
  std::fflush(stdout);
}

}  // namespace fascia::bench
