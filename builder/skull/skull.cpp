#include "builder/skull/skull.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "builder/skull/clearance.h"
#include "builder/skull/procrustes.h"
#include "builder/skull/teeth.h"
#include "geometry/error.h"

namespace fascia::skull {
namespace {

using splines::Sites;
using splines::Spline;
using splines::SplineOptions;
using splines::Warp;

constexpr double evidence_sd = 0.0005;  // m, of teeth that are seen and of clearance constraints

// One correspondence of the bone warp.
struct Anchor {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double sd = 0.001;
};

struct Pair {
  const GenericLandmark* generic = nullptr;
  TargetLandmark target;
  Vec3 skin_normal = Vec3::Zero();
  Vec3 direction = Vec3::Zero();
  double depth = 0;  // scaled, m
  Vec3 bone_target() const { return target.skin - depth * direction; }
};

void check_options(const FitOptions& options) {
  if (!(options.tissue_scale >= 0.05 && options.tissue_scale <= 10))
    throw Error("skull: tissue scale " + std::to_string(options.tissue_scale) +
                " is outside 0.05 to 10; 1 is an adult");
  if (!(options.smoothing >= 0)) throw Error("skull: smoothing must not be negative");
  if (!(options.clearance_share >= 0 && options.clearance_share < 1))
    throw Error("skull: clearance share must be in [0, 1)");
}

// Mean skin normal over a few millimetres: one triangle of a lip or wrinkle would mislead.
Vec3 skin_normal(const Exterior& skin, const Vec3& point) {
  constexpr double radius = 0.004;
  const auto closest = skin.surface.closest(point);
  const Vec3 normal = skin.surface.smooth_normal(closest.surface);
  const Vec3 side = std::abs(normal.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 u = (side - side.dot(normal) * normal).normalized(), v = normal.cross(u);
  Vec3 sum = normal;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * M_PI / 4;
    const Vec3 beside = closest.position + radius * (std::cos(angle) * u + std::sin(angle) * v);
    sum += skin.surface.smooth_normal(skin.surface.closest(beside).surface);
  }
  return sum.normalized();
}

std::vector<Pair> match(const Generic& generic, const Exterior& skin,
                        const std::map<std::string, TargetLandmark>& given, const FitOptions& options,
                        std::vector<std::string>& warnings) {
  std::vector<Pair> out;
  std::map<std::string, const GenericLandmark*> known;
  for (const GenericLandmark& landmark : generic.landmarks)
    known[landmark.name] = &landmark;
  for (const auto& [name, target] : given) {
    const auto at = known.find(name);
    if (at == known.end()) {
      warnings.push_back("landmark " + name + " is not one of the generic skull's; it is not used");
      continue;
    }
    if (!target.skin.allFinite()) throw Error("skull: landmark " + name + " is not finite");
    if (!(target.confidence > 0 && target.confidence <= 1))
      throw Error("skull: landmark " + name + " has confidence " + std::to_string(target.confidence) +
                  "; it must be in (0, 1]");
    Pair pair;
    pair.generic = at->second;
    pair.target = target;
    if (pair.generic->has_bone) pair.skin_normal = skin_normal(skin, target.skin);
    const auto own = options.depth_scale.find(name);
    pair.depth =
        options.tissue_scale * pair.generic->depth * (own == options.depth_scale.end() ? 1.0 : own->second);
    out.push_back(pair);
  }
  return out;
}

Mat4 start_pose(const std::vector<Pair>& pairs) {
  std::vector<Vec3> from, to;
  std::vector<double> weights;
  for (const Pair& pair : pairs) {
    from.push_back(pair.generic->skin);
    to.push_back(pair.target.skin);
    weights.push_back(pair.target.confidence);
  }
  return similarity(from, to, weights);
}

// Depth runs along the generic's own bone-to-skin line as it arrives on this head, leaning to the skin's
// normal.
void aim(std::vector<Pair>& pairs, const std::vector<Mat3>& jacobians, double skin_share) {
  for (size_t i = 0; i < pairs.size(); ++i) {
    Pair& pair = pairs[i];
    if (!pair.generic->has_bone) continue;
    Vec3 carried = jacobians[i] * (pair.generic->skin - pair.generic->bone);
    carried = carried.norm() > 1e-9 ? Vec3(carried.normalized()) : pair.skin_normal;
    const double share = carried.dot(pair.skin_normal) > 0.2 ? skin_share : 0;
    pair.direction = ((1 - share) * carried + share * pair.skin_normal).normalized();
  }
}

std::vector<Anchor> landmark_anchors(const std::vector<Pair>& pairs) {
  std::vector<Anchor> out;
  for (const Pair& pair : pairs) {
    if (!pair.generic->has_bone) continue;
    // An uncertain landmark is off along the skin as well, by up to about 6 mm.
    const double placement = 0.006 * (1 - pair.target.confidence);
    out.push_back({pair.generic->bone, pair.bone_target(),
                   std::hypot(std::max(pair.generic->depth_sd, 1e-4), placement)});
  }
  return out;
}

Warp bone_warp(const std::vector<Anchor>& anchors, double smoothing) {
  std::vector<Vec3> from, to;
  splines::WarpOptions options;
  options.lambda = smoothing;
  for (const Anchor& anchor : anchors) {
    from.push_back(anchor.from);
    to.push_back(anchor.to);
    options.weights.push_back(1 / (anchor.sd * anchor.sd));
  }
  return splines::fit_warp(from, to, options);
}

void check_spread(const std::vector<Pair>& pairs) {
  std::vector<Vec3> bones;
  for (const Pair& pair : pairs)
    if (pair.generic->has_bone) bones.push_back(pair.generic->bone);
  if (bones.size() < 4)
    throw Error("skull: only " + std::to_string(bones.size()) +
                " landmarks with bone under them match; at least 4 are needed, such as nasion, pogonion, "
                "zygion_left and zygion_right");
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : bones)
    centre += p / static_cast<double>(bones.size());
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : bones)
    scatter += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(scatter / static_cast<double>(bones.size()));
  if (std::sqrt(std::max(0.0, eigen.eigenvalues()[0])) < 0.002)
    throw Error(
        "skull: the landmarks lie on a plane, so they say nothing about depth; add one off it, such as "
        "zygion_left or gonion_left");
}

double distance_to(const std::vector<Vec3>& points, const Vec3& from) {
  double squared = std::numeric_limits<double>::infinity();
  for (const Vec3& p : points)
    squared = std::min(squared, (p - from).squaredNorm());
  return std::sqrt(squared);
}

// Points spread over `mesh` and their mirror images: the generic is symmetric in x, the choice must be too.
std::vector<Vec3> symmetric_points(const TriangleMesh& mesh, int count) {
  std::vector<Vec3> out;
  for (const Vec3& p : spread_points(mesh, count)) {
    out.push_back(p);
    out.push_back(Vec3(-p.x(), p.y(), p.z()));
  }
  return out;
}

// Teeth and joints: everything near them, on whichever bone, moves by one similarity.
std::vector<BoneMap::Patch> make_patches(const Generic& generic, const Mat4* upper_match,
                                         const Mat4* lower_match) {
  std::vector<BoneMap::Patch> out;
  const auto add_teeth = [&](std::vector<Vec3> anchors, const Mat4* fixed) {
    if (anchors.empty()) return;
    // Full strength wherever there is a tooth.
    double reach = 0.003;
    for (const TriangleMesh* mesh : {&generic.teeth_upper, &generic.teeth_lower})
      for (const Vec3& v : mesh->vertices)
        reach = std::max(reach, std::min(0.008, distance_to(anchors, v)));
    out.push_back({std::move(anchors), reach + 1e-6, reach + 0.012, fixed ? *fixed : Mat4(Mat4::Zero())});
  };
  std::vector<Vec3> upper = spread_points(generic.teeth_upper, 40),
                    lower = spread_points(generic.teeth_lower, 40);
  if (upper_match || lower_match) {
    add_teeth(upper, upper_match ? upper_match : lower_match);
    add_teeth(lower, lower_match ? lower_match : upper_match);
  } else {
    upper.insert(upper.end(), lower.begin(), lower.end());
    add_teeth(upper, nullptr);
  }
  for (const Vec3& condyle : {generic.condyle_left, generic.condyle_right})
    if ((generic.condyle_left - generic.condyle_right).norm() > 0.01)
      out.push_back({{condyle}, 0.012, 0.026, Mat4::Zero()});
  return out;
}

// Similarities that follow the warp (all but those fixed by evidence).
void settle_patches(const Warp& warp, const std::vector<BoneMap::Patch>& fixed,
                    std::vector<BoneMap::Patch>& patches) {
  patches = fixed;
  for (BoneMap::Patch& patch : patches) {
    if (patch.similarity(3, 3) != 0) continue;
    std::vector<Vec3> from = patch.anchors;
    if (from.size() == 1)  // a joint: the ball around it
      for (int axis = 0; axis < 3; ++axis)
        for (double side : {-0.012, 0.012})
          from.push_back(patch.anchors[0] + side * Vec3::Unit(axis));
    patch.similarity = similarity(from, warp(std::span<const Vec3>(from)));
  }
}

// All vertices that must stay under the skin: cranium, mandible, upper teeth, lower teeth.
struct Bones {
  std::vector<Vec3> generic;
  std::vector<double> clearance;  // m
  size_t teeth = 0;               // first of the teeth
};

Bones gather(const Generic& generic, const FitOptions& options) {
  Bones out;
  for (const TriangleMesh* mesh : {&generic.cranium, &generic.mandible})
    out.generic.insert(out.generic.end(), mesh->vertices.begin(), mesh->vertices.end());
  out.teeth = out.generic.size();
  out.clearance = clearances(depth_field(generic, out.generic), options);
  for (const TriangleMesh* mesh : {&generic.teeth_upper, &generic.teeth_lower})
    out.generic.insert(out.generic.end(), mesh->vertices.begin(), mesh->vertices.end());
  out.clearance.resize(out.generic.size(), options.clearance_floor * std::min(1.0, options.tissue_scale));
  return out;
}

// Turns the worst violations, spread apart, into anchors; false when there is none worth one.
bool add_clearance_anchors(ClearanceCheck& check, const Bones& bones, const std::vector<Vec3>& placed,
                           std::vector<Anchor>& anchors, size_t first) {
  constexpr double spacing = 0.010, worth = 0.0003;
  std::vector<Violation> found = check(placed);
  std::erase_if(found, [&](const Violation& violation) {
    return static_cast<size_t>(violation.vertex) >= bones.teeth;
  });
  std::stable_sort(found.begin(), found.end(),
                   [](const Violation& a, const Violation& b) { return a.missing > b.missing; });
  // Equals, such as the two sides of a symmetric head, are taken together or not at all: only clearly worse
  // violations keep off one that is taken.
  constexpr double equal = 1e-6;  // m
  std::vector<std::pair<Vec3, double>> taken;
  const size_t known = anchors.size();
  for (const Violation& violation : found) {
    if (violation.missing < worth) break;
    if (taken.size() >= 80 && violation.missing + equal < taken.back().second) break;
    const Vec3& from = bones.generic[violation.vertex];
    // On the midplane the nearest skin may be a tie between left and right; the neighbours of both sides
    // decide.
    if (std::abs(from.x()) < 1e-4) continue;
    const auto keeps_off = [&](const std::pair<Vec3, double>& other) {
      return other.second > violation.missing + equal && (other.first - from).norm() < spacing;
    };
    if (std::any_of(taken.begin(), taken.end(), keeps_off)) continue;
    taken.emplace_back(from, violation.missing);
    const Anchor anchor{from, placed[violation.vertex] + (1.1 * violation.missing) * violation.inward,
                        evidence_sd};
    const auto same =
        std::find_if(anchors.begin() + static_cast<long>(first), anchors.begin() + static_cast<long>(known),
                     [&](const Anchor& other) { return other.from == from; });
    if (same != anchors.begin() + static_cast<long>(known))
      *same = anchor;
    else
      anchors.push_back(anchor);
  }
  return !taken.empty();
}

// Anchors that coincide leave the system singular without smoothing: the earlier one stays.
void drop_coincident(std::vector<Anchor>& anchors, double distance) {
  std::vector<Anchor> out;
  for (const Anchor& anchor : anchors)
    if (std::none_of(out.begin(), out.end(),
                     [&](const Anchor& a) { return (a.from - anchor.from).norm() < distance; }))
      out.push_back(anchor);
  anchors = std::move(out);
}

JawFrame jaw_frame(const Generic& generic, const BoneMap& map, const Mat4& pose) {
  JawFrame jaw;
  jaw.condyle_left = map(generic.condyle_left);
  jaw.condyle_right = map(generic.condyle_right);
  jaw.origin = 0.5 * (jaw.condyle_left + jaw.condyle_right);
  const Vec3 across = jaw.condyle_left - jaw.condyle_right;
  const Mat3 turn = pose.topLeftCorner<3, 3>();
  jaw.hinge = across.norm() > 1e-6 ? Vec3(across.normalized()) : Vec3((turn * Vec3::UnitX()).normalized());
  const Vec3 front = (turn * Vec3::UnitZ()).normalized();
  jaw.forward = (front - front.dot(jaw.hinge) * jaw.hinge).normalized();
  // The articular eminence slopes about 35 degrees down from the Frankfort plane.
  jaw.glide = Eigen::AngleAxisd(35 * M_PI / 180, jaw.hinge) * jaw.forward;
  const double scale = std::cbrt(std::abs(turn.determinant()));
  jaw.glide_limit *= scale;
  jaw.forward_limit *= scale;
  jaw.lateral_limit *= scale;
  return jaw;
}

// Teeth keep their shape: when they come through the lips, the whole row and the bone about it step back.
void retract_teeth(ClearanceCheck& check, const Bones& bones, BoneMap& map) {
  if (bones.teeth == bones.generic.size()) return;
  for (int round = 0; round < 4; ++round) {
    Vec3 way = Vec3::Zero();
    double missing = 0;
    for (const Violation& violation : check(map(std::span<const Vec3>(bones.generic)))) {
      if (static_cast<size_t>(violation.vertex) < bones.teeth) continue;
      way += violation.missing * violation.inward;
      missing = std::max(missing, violation.missing);
    }
    if (!(way.norm() > 0)) return;
    for (BoneMap::Patch& patch : map.patches())
      if (patch.anchors.size() > 1) patch.similarity.topRightCorner<3, 1>() += missing * way.normalized();
  }
}

// One map for skin and bone: skin landmarks and points spread over the bones, both where they arrived.
Warp head_warp(const Generic& generic, const std::vector<Pair>& pairs, const BoneMap& map) {
  std::vector<Anchor> anchors;
  for (const Pair& pair : pairs) {
    if (pair.generic->has_bone) anchors.push_back({pair.generic->bone, map(pair.generic->bone), evidence_sd});
  }
  for (const Pair& pair : pairs)
    anchors.push_back({pair.generic->skin, pair.target.skin,
                       std::hypot(evidence_sd, 0.004 * (1 - pair.target.confidence))});
  for (const TriangleMesh* mesh : {&generic.cranium, &generic.mandible})
    for (const Vec3& point : symmetric_points(*mesh, mesh == &generic.cranium ? 50 : 25)) {
      // Of two so near the midplane one would be dropped.
      if (std::abs(point.x()) < 0.002) continue;
      anchors.push_back({point, map(point), evidence_sd});
    }
  drop_coincident(anchors, 0.003);
  return bone_warp(anchors, 100);
}

void report(const std::vector<Pair>& pairs, const BoneMap& map, FitResult& out) {
  double sum = 0;
  for (const Pair& pair : pairs) {
    if (!pair.generic->has_bone) continue;
    FittedLandmark landmark;
    landmark.name = pair.generic->name;
    landmark.skin = pair.target.skin;
    landmark.bone = map(pair.generic->bone);
    landmark.target = pair.bone_target();
    landmark.direction = pair.direction;
    landmark.depth = (landmark.skin - landmark.bone).norm();
    landmark.table_depth = pair.depth;
    landmark.residual = (landmark.bone - landmark.target).norm();
    landmark.confidence = pair.target.confidence;
    sum += landmark.residual * landmark.residual;
    out.landmark_max = std::max(out.landmark_max, landmark.residual);
    out.landmarks.push_back(landmark);
  }
  out.landmark_rms = std::sqrt(sum / static_cast<double>(out.landmarks.size()));
}

// Maps every mesh, corrects what is still too near to the skin, and counts what is left.
void place_meshes(ClearanceCheck& check, const Generic& generic, const Bones& bones, FitResult& out) {
  constexpr int rounds = 24;
  TriangleMesh whole{out.bone_map(std::span<const Vec3>(bones.generic)), {}};
  const std::array<const TriangleMesh*, 4> sources{&generic.cranium, &generic.mandible, &generic.teeth_upper,
                                                   &generic.teeth_lower};
  int offset = 0;
  for (const TriangleMesh* mesh : sources) {
    for (const Triangle& t : mesh->triangles)
      whole.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    offset += mesh->vertex_count();
  }
  out.corrected_vertices = push_inside(check, whole, rounds, out.corrected_max);
  for (const Violation& violation : check(whole.vertices))
    ++(violation.outside ? out.bone_outside_skin : out.bone_within_clearance);
  auto next = whole.vertices.begin();
  const std::array<TriangleMesh*, 4> results{&out.cranium, &out.mandible, &out.teeth_upper, &out.teeth_lower};
  for (size_t k = 0; k < results.size(); ++k) {
    const auto end = next + sources[k]->vertex_count();
    *results[k] = {{next, end}, sources[k]->triangles};
    next = end;
  }
  if (out.bone_outside_skin > 0)
    out.warnings.push_back(
        std::to_string(out.bone_outside_skin) +
        " bone vertices could not be brought inside the skin; look at the landmarks near them");
}

}  // namespace

FitResult fit(const Generic& generic, const Exterior& skin,
              const std::map<std::string, TargetLandmark>& landmarks, const FitOptions& options) {
  check_options(options);
  FitResult out;
  std::vector<Pair> pairs = match(generic, skin, landmarks, options, out.warnings);
  check_spread(pairs);
  out.similarity = start_pose(pairs);

  // Teeth that can be seen say more about the jaws than any depth table.
  TeethMatch upper, lower;
  std::vector<Anchor> teeth;
  const auto register_teeth = [&](const TriangleMesh& from, const TriangleMesh* to,
                                  TeethMatch& found) -> const Mat4* {
    if (!to || to->empty() || from.empty()) return nullptr;
    found = match_teeth(from, *to, out.similarity);
    for (const Vec3& point : spread_points(from, 10))
      teeth.push_back({point, transform(found.similarity, point), evidence_sd});
    return &found.similarity;
  };
  const Mat4* upper_match = register_teeth(generic.teeth_upper, options.teeth_upper, upper);
  const Mat4* lower_match = register_teeth(generic.teeth_lower, options.teeth_lower, lower);

  // Directions and warp in turn: each needs the other.
  std::vector<Mat3> jacobians(pairs.size(), Mat3(out.similarity.topLeftCorner<3, 3>()));
  std::vector<Anchor> anchors;
  Warp warp;
  for (int pass = 0; pass <= std::max(0, options.normal_passes); ++pass) {
    const std::vector<Anchor> before = anchors;
    aim(pairs, jacobians, options.skin_normal_share);
    anchors = landmark_anchors(pairs);
    anchors.insert(anchors.end(), teeth.begin(), teeth.end());
    double change = before.empty() ? 1 : 0;
    for (size_t i = 0; i < before.size(); ++i)
      change = std::max(change, (before[i].to - anchors[i].to).norm());
    if (change < options.normal_tolerance) break;
    warp = bone_warp(anchors, options.smoothing);
    for (size_t i = 0; i < pairs.size(); ++i)
      if (pairs[i].generic->has_bone) jacobians[i] = warp.jacobian(pairs[i].generic->bone);
  }

  const Bones bones = gather(generic, options);
  ClearanceCheck check(skin, bones.clearance);
  const std::vector<BoneMap::Patch> pattern = make_patches(generic, upper_match, lower_match);
  const size_t given = anchors.size();
  std::vector<BoneMap::Patch> patches;
  for (int round = 0;; ++round) {
    settle_patches(warp, pattern, patches);
    out.bone_map = BoneMap(warp, patches);
    if (round == 3) break;
    const std::vector<Vec3> placed = out.bone_map(std::span<const Vec3>(bones.generic));
    if (!add_clearance_anchors(check, bones, placed, anchors, given)) break;
    warp = bone_warp(anchors, std::max(options.smoothing, 1.0));
  }
  retract_teeth(check, bones, out.bone_map);
  place_meshes(check, generic, bones, out);
  report(pairs, out.bone_map, out);
  out.jaw = jaw_frame(generic, out.bone_map, out.similarity);
  out.warp = head_warp(generic, pairs, out.bone_map);
  return out;
}

FitResult fit(const Generic& generic, const TriangleMesh& skin,
              const std::map<std::string, TargetLandmark>& landmarks, const FitOptions& options) {
  return fit(generic, exterior(skin), landmarks, options);
}

}  // namespace fascia::skull
