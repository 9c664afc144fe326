#include "fit/scan/scan.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "builder/spatial/surface_query.h"
#include "geometry/error.h"

namespace fascia::fit {

namespace {

constexpr double same_way = 0.6;     // least cosine between the normals of a match
constexpr double seen_from = 0.12;   // metres a vertex of the outer skin sees freely along its normal
constexpr double least_share = 0.1;  // of the samples that must meet the scan
constexpr double jaw_alone = 0.2,
                 coarse = 0.6;  // shares of the rounds in which other channels, or lips, are held
constexpr int normal_passes = 4;
constexpr double mutual_slack = 0.002;  // metres
constexpr double first_cost = 100.0;    // times the last round's costs of activations in the first
constexpr double still_weight = 4.0;    // of vertices no muscle moves, in the head's pose

/// The skin of the subject as one surface, by vertices of the subject.
struct Skin {
  std::vector<Triangle> triangles;
  std::vector<size_t> samples;  ///< outer vertices that are matched

  std::vector<Vec3> positions(const Subject& subject, const Eigen::VectorXd& displacements) const {
    std::vector<Vec3> all(subject.vertex_count());
    for (size_t v = 0; v < all.size(); ++v) {
      const auto at = static_cast<Eigen::Index>(3 * v);
      all[v] = subject.rest().segment<3>(at) + displacements.segment<3>(at);
    }
    return all;
  }
};

Skin skin_of(const Subject& subject, int most) {
  Skin skin;
  skin.triangles = subject.skin_triangles();
  if (skin.triangles.empty()) throw Error("the rig binds no skin: build it again");
  const TriangleMesh mesh{skin.positions(subject, Eigen::VectorXd::Zero(subject.rest().size())),
                          skin.triangles};
  const spatial::SurfaceQuery surface(mesh);
  const std::vector<Vec3> normals = vertex_normals(mesh);
  std::vector<size_t> outer;
  for (size_t v = 0; v < normals.size(); ++v)  // without a normal: no vertex of the skin
    if (!normals[v].isZero(0) &&
        !surface.blocked(mesh.vertices[v] + 2e-4 * normals[v], normals[v], seen_from))
      outer.push_back(v);
  // Every so many of those that move, and as many again of the others: the face tells more than the scalp.
  std::vector<size_t> moving, still;
  for (size_t v : outer)
    (subject.follows(v) ? moving : still).push_back(v);
  for (const auto& [list, share] : {std::pair{&moving, 0.8}, std::pair{&still, 0.2}}) {
    const size_t wanted = std::max<size_t>(1, static_cast<size_t>(share * most));
    const size_t stride = std::max<size_t>(1, (list->size() + wanted - 1) / wanted);
    for (size_t i = 0; i < list->size(); i += stride)
      skin.samples.push_back((*list)[i]);
  }
  if (skin.samples.size() < 50) throw Error("the rig's skin has too few vertices to match a scan");
  return skin;
}

struct Match {
  size_t vertex = 0;
  Vec3 from = Vec3::Zero(), foot = Vec3::Zero(), normal = Vec3::Zero();  ///< head's frame; normal of the scan
  double weight = 0.0;
  double off() const { return normal.dot(foot - from); }
};

/// Vertex normals evened out over a few rings of neighbours: scanners' noise turns single triangles by any
/// angle.
std::vector<Vec3> even_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals = vertex_normals(mesh);
  for (int pass = 0; pass < normal_passes; ++pass) {
    std::vector<Vec3> sums = normals;
    for (const Triangle& t : mesh.triangles)
      for (size_t k = 0; k < 3; ++k)
        sums[static_cast<size_t>(t[k])] +=
            normals[static_cast<size_t>(t[(k + 1) % 3])] + normals[static_cast<size_t>(t[(k + 2) % 3])];
    for (size_t v = 0; v < sums.size(); ++v)
      if (sums[v].norm() > 1e-9) normals[v] = sums[v].normalized();
  }
  return normals;
}

/// The scan as it was given, and which of its vertices lie on its edge.
class ScanSurface {
 public:
  ScanSurface(const TriangleMesh& scan, int samples)
      : surface_(scan), normals_(even_normals(scan)), is_edge_(scan.vertices.size(), false) {
    std::map<std::pair<int, int>, int> sides;
    for (const Triangle& t : scan.triangles)
      for (size_t k = 0; k < 3; ++k)
        ++sides[std::minmax(t[k], t[(k + 1) % 3])];
    for (const auto& [side, count] : sides)
      if (count == 1)
        is_edge_[static_cast<size_t>(side.first)] = is_edge_[static_cast<size_t>(side.second)] = true;
    const size_t stride = std::max<size_t>(1, scan.vertices.size() / static_cast<size_t>(samples));
    for (size_t v = 0; v < scan.vertices.size(); v += stride)
      if (!is_edge_[v] && !normals_[v].isZero(0)) samples_.push_back(v);
  }

  /// Matches of `skin` as it stands with the scan moved by `scan_to_head`: places of the scan next to
  /// vertices, and vertices next to places of the scan, so that a lip which is near neither lip of the scan
  /// is still drawn by its own.
  std::vector<Match> matches(const std::vector<size_t>& samples, const TriangleMesh& skin,
                             const Eigen::Isometry3d& scan_to_head, double reach) const {
    const spatial::SurfaceQuery own(skin);
    const std::vector<Vec3> normals = vertex_normals(skin);
    std::vector<bool> is_sample(skin.vertices.size(), false);
    for (size_t v : samples)
      is_sample[v] = true;
    std::vector<Match> found;
    add_forward(samples, skin, own, normals, scan_to_head, reach, found);
    add_backward(is_sample, skin, own, normals, scan_to_head, reach, found);
    weigh(found, reach);
    return found;
  }

 private:
  Vec3 normal_at(const SurfacePoint& place) const {
    const Triangle& t = surface_.mesh().triangles[static_cast<size_t>(place.triangle)];
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      sum += place.barycentric[k] * normals_[static_cast<size_t>(t[static_cast<size_t>(k)])];
    return sum.normalized();
  }

  /// From vertices to the scan. Each is mutual: the skin nearest to the place found is the skin it was found
  /// for, so that a lip is not taken for the other one.
  void add_forward(const std::vector<size_t>& samples, const TriangleMesh& skin,
                   const spatial::SurfaceQuery& own, const std::vector<Vec3>& normals,
                   const Eigen::Isometry3d& scan_to_head, double reach, std::vector<Match>& found) const {
    const Eigen::Isometry3d back = scan_to_head.inverse();
    for (size_t v : samples) {
      const Vec3& place = skin.vertices[v];
      const spatial::ClosestPoint foot = surface_.nearest_place(back * place, reach);
      if (!foot.found() || on_edge(foot)) continue;
      const Vec3 normal = scan_to_head.rotation() * normal_at(foot.surface);
      if (normal.dot(normals[v]) < same_way) continue;
      const Vec3 at = scan_to_head * foot.position;
      const spatial::ClosestPoint mutual = own.nearest_place(at, 2.0 * foot.distance + 1e-4);
      if (mutual.found() && (mutual.position - place).norm() > 0.5 * foot.distance + mutual_slack) continue;
      found.push_back({v, place, at, normal, 1.0});
    }
  }

  /// From the scan to vertices.
  void add_backward(const std::vector<bool>& is_sample, const TriangleMesh& skin,
                    const spatial::SurfaceQuery& own, const std::vector<Vec3>& normals,
                    const Eigen::Isometry3d& scan_to_head, double reach, std::vector<Match>& found) const {
    for (size_t s : samples_) {
      const Vec3 place = scan_to_head * surface_.mesh().vertices[s];
      const spatial::ClosestPoint foot = own.nearest_place(place, reach);
      if (!foot.found()) continue;
      const Triangle& t = skin.triangles[static_cast<size_t>(foot.surface.triangle)];
      int nearest = 0;
      foot.surface.barycentric.maxCoeff(&nearest);
      const auto v = static_cast<size_t>(t[static_cast<size_t>(nearest)]);
      const Vec3 normal = scan_to_head.rotation() * normals_[s];
      if (!is_sample[v] || normal.dot(normals[v]) < same_way) continue;
      found.push_back({v, skin.vertices[v], skin.vertices[v] + place - foot.position, normal, 1.0});
    }
  }

  /// Tukey's biweight of the distances.
  static void weigh(std::vector<Match>& found, double reach) {
    for (Match& match : found) {
      const double ratio = (match.foot - match.from).norm() / reach;
      match.weight = ratio < 1.0 ? (1 - ratio * ratio) * (1 - ratio * ratio) : 0.0;
    }
    std::erase_if(found, [](const Match& match) { return match.weight <= 0.0; });
  }

  bool on_edge(const spatial::ClosestPoint& foot) const {
    const Triangle& t = surface_.mesh().triangles[static_cast<size_t>(foot.surface.triangle)];
    for (int k = 0; k < 3; ++k)
      if (foot.surface.barycentric[k] > 1e-6 && !is_edge_[static_cast<size_t>(t[static_cast<size_t>(k)])])
        return false;
    return true;
  }

  spatial::SurfaceQuery surface_;
  std::vector<Vec3> normals_;
  std::vector<bool> is_edge_;
  std::vector<size_t> samples_;
};

/// The small rigid motion of the scan that brings its planes to the vertices.
Eigen::Isometry3d pose_step(const Subject& subject, const std::vector<Match>& matches) {
  Vec3 pivot = Vec3::Zero();
  for (const Match& match : matches)
    pivot += match.from / static_cast<double>(matches.size());
  Eigen::Matrix<double, 6, 6> left = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (const Match& match : matches) {
    Eigen::Matrix<double, 6, 1> row;
    row << (match.foot - pivot).cross(match.normal), match.normal;
    const double weight = match.weight * (subject.follows(match.vertex) ? 1.0 : still_weight);
    left += weight * row * row.transpose();
    right -= weight * match.off() * row;
  }
  left.diagonal().array() += 1e-9 * left.trace();
  const Eigen::Matrix<double, 6, 1> step = left.ldlt().solve(right);
  const Vec3 turn = step.head<3>();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(pivot + Vec3(step.tail<3>()));
  if (turn.norm() > 1e-12) motion.rotate(Eigen::AngleAxisd(std::min(turn.norm(), 0.3), turn.normalized()));
  motion.translate(-pivot);
  return motion;
}

Target target_of(const Subject& subject, const std::vector<Match>& matches,
                 const Eigen::VectorXd& displacements) {
  Target target{displacements, std::vector<double>(subject.vertex_count(), 0.0),
                Eigen::VectorXd::Zero(displacements.size())};
  // Several matches of a vertex are one of their weighted mean.
  std::vector<double> offs(subject.vertex_count(), 0.0);
  for (const Match& match : matches) {
    const auto at = static_cast<Eigen::Index>(3 * match.vertex);
    offs[match.vertex] += match.weight * match.off();
    target.normals.segment<3>(at) += match.weight * match.normal;
    target.confidence[match.vertex] += match.weight;
  }
  for (size_t v = 0; v < offs.size(); ++v) {
    if (target.confidence[v] <= 0.0) continue;
    const auto at = static_cast<Eigen::Index>(3 * v);
    const Vec3 normal = target.normals.segment<3>(at).normalized();
    target.normals.segment<3>(at) = normal;
    target.displacements.segment<3>(at) += offs[v] / target.confidence[v] * normal;
  }
  return target;
}

class ScanFitter {
 public:
  ScanFitter(Subject& subject, const TriangleMesh& scan, const FitOptions& fitting,
             const ScanOptions& options)
      : subject_(subject),
        options_(options),
        skin_(skin_of(subject, options.samples)),
        scan_(scan, options.samples),
        fitter_(subject, fitting),
        fitting_(fitting) {}

  ScanFit run() {
    displacements_ = Eigen::VectorXd::Zero(subject_.rest().size());
    if (options_.moves_head)
      for (int round = 0; round < 15; ++round)
        pose_ = pose_step(subject_, near(options_.reach)) * pose_;
    const std::vector<Match> before = near(options_.reach);
    ScanFit out;
    for (int round = 0; round < options_.rounds; ++round) {
      const double share = options_.rounds > 1 ? static_cast<double>(round) / (options_.rounds - 1) : 1.0;
      const double reach = options_.reach * std::pow(options_.last_reach / options_.reach, share);
      std::vector<Match> matches = near(reach);
      if (options_.moves_head && round > 0) {
        pose_ = pose_step(subject_, matches) * pose_;
        matches = near(reach);
      }
      FitOptions now = steps(fitting_, options_.caution * std::pow(first_cost, 1.0 - share));
      now.held = held(share);
      fitter_.set_options(now);
      out.result = fitter_.follow(target_of(subject_, matches, displacements_));
      displacements_ = out.result.displacements;
      out.result.iterations += iterations_;
      iterations_ = out.result.iterations;
    }
    out.scan_to_head = pose_.matrix();
    judge(before, out);
    return out;
  }

 private:
  /// The jaw comes first, lips last: before the jaw is open the lower lip lies next to the scan's upper one.
  std::vector<uint32_t> held(double share) const {
    std::vector<uint32_t> list;
    for (uint32_t c = 0; c < subject_.channels().size(); ++c) {
      const rig::Channel& channel = subject_.channels()[c];
      const bool is_jaw = channel.group == "jaw";
      const bool is_fine = channel.group == "lip" || channel.group == "pressure" ||
                           channel.name.find("compressor") == 0 || channel.name.find("orbicularis_oris") == 0;
      if ((share < jaw_alone && !is_jaw) || (share < coarse && is_fine)) list.push_back(c);
    }
    return list;
  }

  static FitOptions steps(FitOptions fitting, double cost) {
    fitting.ridge *= cost;
    fitting.sparsity *= cost;
    fitting.iterations = 3;  // new correspondences matter more than converging this round
    fitting.smoothness = 0.0;
    return fitting;
  }

  std::vector<Match> near(double reach) const {
    std::vector<Match> matches = scan_.matches(
        skin_.samples, {skin_.positions(subject_, displacements_), skin_.triangles}, pose_, reach);
    if (static_cast<double>(matches.size()) < least_share * static_cast<double>(skin_.samples.size()))
      throw Error(
          "hardly anything of the scan lies on the rig's head: give it in the head's axes and units, with "
          "its "
          "normals outward");
    return matches;
  }

  /// Distances from the scan's surface, before and after, of the vertices matched at the end.
  void judge(const std::vector<Match>& before, ScanFit& out) const {
    const std::vector<Match> after = near(options_.last_reach);
    out.distance.assign(subject_.vertex_count(), std::numeric_limits<double>::quiet_NaN());
    std::map<size_t, double> first;
    for (const Match& match : before)
      first[match.vertex] = match.off();
    double left = 0.0, whole = 0.0, squares = 0.0, sum = 0.0;
    std::set<size_t> met;
    for (const Match& match : after) {
      met.insert(match.vertex);
      out.distance[match.vertex] = match.off();
      sum += std::abs(match.off());
      squares += match.off() * match.off();
      const auto at = first.find(match.vertex);
      if (at == first.end() || !subject_.follows(match.vertex)) continue;
      left += match.off() * match.off();
      whole += at->second * at->second;
    }
    out.target = target_of(subject_, after, displacements_);
    const auto count = static_cast<double>(after.size());
    out.result.share = whole > 0.0 ? 1.0 - left / whole : 1.0;
    out.result.error_mm = 1e3 * sum / count;
    out.result.rms_mm = 1e3 * std::sqrt(squares / count);
    out.matched_share = static_cast<double>(met.size()) / static_cast<double>(skin_.samples.size());
  }

  Subject& subject_;
  ScanOptions options_;
  Skin skin_;
  ScanSurface scan_;
  Fitter fitter_;
  FitOptions fitting_;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  Eigen::VectorXd displacements_;
  int iterations_ = 0;
};

}  // namespace

ScanFit fit_scan(Subject& subject, const TriangleMesh& scan, const FitOptions& fitting,
                 const ScanOptions& options) {
  return ScanFitter(subject, scan, fitting, options).run();
}

}  // namespace fascia::fit
