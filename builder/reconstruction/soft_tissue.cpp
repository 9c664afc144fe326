#include "builder/reconstruction/soft_tissue.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "builder/skull/from_anatomy.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::reconstruction {

namespace {

constexpr double deepest = 0.035;  // metres: skin farther from the bone along its normal is not over it
constexpr double bone_deviation = 0.004;  // metres: of a depth that no table gives, between people
constexpr double smoothing = 300.0;       // 1/m, as FitOptions::smoothing of the skull fit
constexpr double spread = 0.011;          // metres between places of the bone
constexpr double eye_blend = 0.014;       // metres beyond the eyeball over which the similarity fades

/// Pairs of the thin plate, generic head's frame on both sides.
struct Pairs {
  std::vector<Vec3> from, to;
  std::vector<double> deviation;  // metres
  void add(const Vec3& generic, const Vec3& target, double sd) {
    from.push_back(generic);
    to.push_back(target);
    deviation.push_back(sd);
  }
};

/// How a direction of the generic skull has turned with the bone about `point`.
Vec3 turned(const splines::Warp& warp, const Vec3& point, const Vec3& direction) {
  const Vec3 tip = point + 0.004 * direction;
  const Vec3 way = warp(tip) - warp(point);
  return way.norm() > 0.0 ? Vec3(way.normalized()) : direction;
}

/// What the table says of depth beside what the generic head has: a factor at each landmark, in between by
/// inverse squared distance.
class DepthRatio {
 public:
  void add(const Vec3& skin, double ratio) { at_.push_back({skin, ratio}); }
  double operator()(const Vec3& skin) const {
    double sum = 0.0, total = 0.0;
    for (const auto& [place, ratio] : at_) {
      const double weight = 1.0 / std::pow(std::max(0.004, (place - skin).norm()), 3.0);
      sum += weight * ratio;
      total += weight;
    }
    return total > 0.0 ? sum / total : 1.0;
  }

 private:
  std::vector<std::pair<Vec3, double>> at_;
};

/// Places of the generic bone that met the scan, no two nearer than `spread`.
std::vector<size_t> places_on_bone(const SkullRegistration& skull) {
  std::vector<size_t> kept;
  for (size_t k = 0; k < skull.fit.used.size(); ++k) {
    if (!(skull.fit.residuals[k] < 0.005) || skull.fit.agreements[k] < 0.6) continue;
    const Vec3& p = skull.points.points.points[static_cast<size_t>(skull.fit.used[k])];
    const bool is_near = std::any_of(kept.begin(), kept.end(), [&](size_t other) {
      return (skull.points.points.points[static_cast<size_t>(skull.fit.used[other])] - p).norm() < spread;
    });
    if (!is_near) kept.push_back(k);
  }
  return kept;
}

void add_bone_places(const anatomy::GenericAnatomy& anatomy, const SkullRegistration& skull,
                     const DepthRatio& ratio, double factor, const DepthChoice& choice, Pairs& pairs) {
  const spatial::SurfaceQuery skin(anatomy.head_object("skin")->mesh);
  const std::vector<Vec3> before = pairs.from;
  for (size_t k : places_on_bone(skull)) {
    const auto i = static_cast<size_t>(skull.fit.used[k]);
    const Vec3 &bone = skull.points.points.points[i], &normal = skull.points.points.normals[i];
    const auto hit = skin.first_hit(bone, normal, deepest);
    if (!hit || hit->from_outside) continue;  // linings lie before the bone where no skin does
    const bool is_near = std::any_of(before.begin(), before.end(),
                                     [&](const Vec3& p) { return (p - hit->position).norm() < 0.006; });
    if (is_near) continue;
    const double depth = hit->distance * ratio(hit->position) * choice.tissue_scale * factor +
                         choice.deviations * bone_deviation * factor;
    const Vec3 way = turned(skull.fit.warp, bone, normal);
    pairs.add(hit->position, skull.fit.warp(bone) + std::max(0.001, depth) * way,
              std::hypot(bone_deviation, skull.fit.residuals[k]));
  }
}

double residual_near(const SkullRegistration& skull, const Vec3& bone) {
  double best = 0.012, residual = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < skull.fit.used.size(); ++k) {
    const double d = (skull.points.points.points[static_cast<size_t>(skull.fit.used[k])] - bone).norm();
    if (d >= best || !(skull.fit.residuals[k] < 1.0)) continue;
    best = d;
    residual = skull.fit.residuals[k];
  }
  return residual;
}

skull::BoneMap with_round_eyes(const anatomy::GenericAnatomy& anatomy, splines::Warp warp) {
  std::vector<skull::BoneMap::Patch> patches;
  for (const char* name : {"eye_left", "eye_right"}) {
    const anatomy::MeshObject* eye = anatomy.head_object(name);
    if (!eye || eye->mesh.empty()) continue;
    const std::vector<Vec3>& vertices = eye->mesh.vertices;
    const Bounds box = bounds(vertices);
    skull::BoneMap::Patch patch;
    patch.anchors = {box.centre()};
    patch.inner = 0.5 * box.size().norm() / std::sqrt(3.0) + 0.003;
    patch.outer = patch.inner + eye_blend;
    patch.similarity = similarity(vertices, warp(std::span<const Vec3>(vertices)));
    patches.push_back(std::move(patch));
  }
  return {std::move(warp), std::move(patches)};
}

}  // namespace

skull::BoneMap skin_map(const anatomy::GenericAnatomy& anatomy, const SkullRegistration& skull, double metres,
                        const Landmarks& known, const DepthChoice& choice,
                        std::vector<SkinOverBone>* landmarks) {
  if (!anatomy.head_object("skin")) throw Error("anatomy: the generic head has no skin");
  const skull::Generic generic = skull::from_anatomy(anatomy, choice.table);
  const landmarks::Placement& placement = skull.fit.placement;
  // Depths are absolute lengths; the plate works in the frame of the generic head, which has another scale.
  const double factor = 1.0 / (placement.scale * metres);
  Pairs pairs;
  DepthRatio ratio;
  for (const skull::GenericLandmark& landmark : generic.landmarks) {
    if (!landmark.has_bone) continue;
    const Vec3 along = landmark.skin - landmark.bone;
    if (along.norm() < 1e-4) continue;
    const auto given = known.find(landmark.name);
    const double residual = residual_near(skull, landmark.bone);
    const Vec3 bone = given != known.end() ? placement.inverse(given->second) : skull.fit.warp(landmark.bone);
    const Vec3 way = turned(skull.fit.warp, landmark.bone, along.normalized());
    const double depth = choice.tissue_scale * landmark.depth + choice.deviations * landmark.depth_sd;
    const Vec3 skin = bone + std::max(0.001, depth) * factor * way;
    const bool is_met = given != known.end() || residual < 0.006;
    if (is_met) {
      pairs.add(landmark.skin, skin, std::hypot(landmark.depth_sd, given != known.end() ? 0.0 : residual));
      ratio.add(landmark.skin, landmark.depth / along.norm());
    }
    if (landmarks)
      landmarks->push_back({landmark.name, placement(bone), placement(skin),
                            choice.tissue_scale * landmark.depth, landmark.depth_sd,
                            is_met ? residual : std::numeric_limits<double>::infinity(),
                            given != known.end()});
  }
  add_bone_places(anatomy, skull, ratio, factor, choice, pairs);
  if (pairs.from.size() < 12)
    throw Error("hardly any bone was recognised on the skull: give more landmarks on it with --landmarks");
  splines::WarpOptions plate;
  for (double sd : pairs.deviation)
    plate.weights.push_back(1.0 / (sd * sd));
  plate.lambda = smoothing;
  return with_round_eyes(anatomy, splines::fit_warp(pairs.from, pairs.to, plate));
}

}  // namespace fascia::reconstruction
