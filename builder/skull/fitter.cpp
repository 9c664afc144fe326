#include "builder/skull/fitter.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/skull/bone_system.h"
#include "builder/skull/coverage.h"
#include "builder/skull/curve_points.h"
#include "builder/skull/head_warp.h"
#include "builder/skull/jaw_frame.h"
#include "builder/skull/landmark_pairs.h"
#include "builder/skull/patches.h"
#include "builder/skull/placement.h"
#include "builder/skull/teeth.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::skull {
namespace {

void check_scale(double scale, const std::string& what) {
  if (!(scale >= 0.05 && scale <= 10))
    throw Error("skull: " + what + " " + std::to_string(scale) + " is outside 0.05 to 10; 1 is an adult");
}

void check_options(const FitOptions& options) {
  check_scale(options.tissue_scale, "tissue scale");
  for (const auto& [name, scale] : options.depth_scale)
    check_scale(scale, "depth scale of " + name);
  if (!(options.smoothing >= 0)) throw Error("skull: smoothing must not be negative");
  if (!(options.clearance_share >= 0 && options.clearance_share < 1))
    throw Error("skull: clearance share must be in [0, 1)");
  if (!(options.normal_deviation >= 0)) throw Error("skull: the normals' deviation must not be negative");
  if (options.normal_deviation > 0 && !(options.exponent > 2))
    throw Error("skull: normals as data need a kernel exponent above 2; set it to 3");
  if (!(options.curve_spacing >= 0)) throw Error("skull: the spacing of curve points must not be negative");
}

}  // namespace

struct Fitter::State {
  Generic generic;
  Exterior skin;
  FitOptions options;
  std::vector<LandmarkPair> pairs;
  std::vector<CurvePoint> curves;
  std::vector<Observation> teeth, clearance;  // of the teeth that are seen; of bone held inside the skin
  std::vector<BoneMap::Patch> patches;
  Bones bones;
  std::optional<ClearanceCheck> check;
  VertexMap vertex_map;
  BoneSystem system;
  HeadWarp head_warp;
  std::optional<Coverage> covered;
  bool moving = false;  // landmarks are being moved: the basis at the vertices is worth its memory
  std::vector<Observation> observations;
  splines::Warp warp;
  FitResult result;

  State(Generic g, Exterior s, const FitOptions& o) : generic(std::move(g)), skin(std::move(s)), options(o) {}

  void register_teeth();
  std::vector<Mat3> jacobians(bool first) const;
  std::vector<TangentObservation> tangents(bool first) const;
  void gather_observations(bool first, const std::vector<Mat3>& turns);
  void factor(const std::vector<TangentObservation>& rows);
  void solve(int passes);
  void hold_inside();
  void follow_skin();
  void finish();
  void report_landmarks();
  const FitResult& update();
};

// Teeth that can be seen say more about the jaws than any depth table.
void Fitter::State::register_teeth() {
  const auto match = [&](const TriangleMesh& from, const TriangleMesh* to) -> std::optional<Mat4> {
    if (!to || to->empty() || from.empty()) return std::nullopt;
    const Mat4 found = match_teeth(from, *to, result.similarity).similarity;
    for (const Vec3& point : symmetric_points(from, 6)) {
      Observation observation;
      observation.from = point;
      observation.to = transform_point(found, point);
      observation.sd = options.teeth_deviation;
      teeth.push_back(observation);
    }
    return found;
  };
  const auto upper = match(generic.teeth_upper, options.teeth_upper);
  const auto lower = match(generic.teeth_lower, options.teeth_lower);
  constexpr double firm = 0.001;  // m
  const bool replaced = options.teeth_deviation <= firm;
  patches = make_patches(generic, replaced ? upper : std::nullopt, replaced ? lower : std::nullopt);
  options.teeth_upper = options.teeth_lower = nullptr;
}

// Of each pair, then of each curve point.
std::vector<Mat3> Fitter::State::jacobians(bool first) const {
  if (first) return std::vector<Mat3>(pairs.size() + curves.size(), result.similarity.topLeftCorner<3, 3>());
  std::vector<Mat3> out;
  for (const LandmarkPair& pair : pairs)
    out.push_back(warp.jacobian(pair.generic->bone));
  for (const CurvePoint& point : curves)
    out.push_back(warp.jacobian(point.bone));
  return out;
}

std::vector<TangentObservation> Fitter::State::tangents(bool first) const {
  if (!(options.normal_deviation > 0)) return {};
  return tangent_observations(pairs, jacobians(first), options.normal_deviation);
}

// Depth directions and targets as the map stands: landmarks, seen teeth, curve points, clearance, in this
// order.
void Fitter::State::gather_observations(bool first, const std::vector<Mat3>& turns) {
  aim(pairs, turns, options.skin_normal_share);
  observations = landmark_observations(pairs);
  observations.insert(observations.end(), teeth.begin(), teeth.end());
  if (!curves.empty()) {
    std::vector<Vec3> at;
    for (const CurvePoint& point : curves)
      at.push_back(first ? transform_point(result.similarity, point.bone) : point.bone);
    if (!first) at = warp(std::span<const Vec3>(at));
    aim(curves, at, std::vector<Mat3>(turns.begin() + static_cast<long>(pairs.size()), turns.end()), skin,
        options.tissue_scale, options.skin_normal_share);
    append_observations(curves, observations);
  }
  observations.insert(observations.end(), clearance.begin(), clearance.end());
}

void Fitter::State::factor(const std::vector<TangentObservation>& rows) {
  // Clearance constraints may contradict landmarks: only smoothing can reconcile them.
  const double smoothing = clearance.empty() ? options.smoothing : std::max(options.smoothing, 1.0);
  system = BoneSystem(observations, rows, smoothing, options.exponent);
}

// Directions and warp in turn: each needs the other.
void Fitter::State::solve(int passes) {
  std::vector<Mat3> turns;
  for (int pass = 0; pass < passes; ++pass) {
    const bool first = warp.identity();
    // A moved landmark turns little within its two passes.
    if (!moving || pass == 0) turns = jacobians(first);
    const std::vector<Observation> before = observations;
    gather_observations(first, turns);
    double change = before.size() == observations.size() ? 0 : 1;
    for (size_t i = 0; i < before.size() && change < 1; ++i)
      if (observations[i].used) change = std::max(change, (before[i].to - observations[i].to).norm());
    if (!first && change < options.normal_tolerance) break;
    const std::vector<TangentObservation> rows = tangents(first);
    if (first) factor(rows);
    warp = system.warp(system.displacements(observations, rows));
  }
}

// Where bone would come too near to the skin, points of it are held inside; then the same map again.
void Fitter::State::hold_inside() {
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    const BoneMap map(warp, settled_patches(warp, patches));
    const std::vector<Vec3> placed = vertex_map(bones, map, warp(std::span<const Vec3>(bones.generic)));
    const size_t first = observations.size() - clearance.size();
    if (!add_clearance_observations(*check, bones, placed, observations, first)) return;
    clearance.assign(observations.begin() + static_cast<long>(first), observations.end());
    const std::vector<TangentObservation> rows = tangents(false);
    factor(rows);
    warp = system.warp(system.displacements(observations, rows));
  }
}

// After a move, held points go on being held, under the skin that is now nearest.
void Fitter::State::follow_skin() {
  const auto& allowed = check->clearance();
  std::vector<Vec3> points;
  for (const Observation& held : clearance)
    points.push_back(held.from);
  points = warp(std::span<const Vec3>(points));
  for (size_t i = 0; i < clearance.size(); ++i) {
    Observation& held = clearance[i];
    const auto at = std::find(bones.generic.begin(), bones.generic.end(), held.from);
    const Vec3& now = points[i];
    const spatial::ClosestPoint closest = skin.closest(now);
    if (!closest.found() || at == bones.generic.end()) continue;
    const double least = allowed[static_cast<size_t>(at - bones.generic.begin())];
    // Where it is, but no nearer to the skin than it may be: it moves on with the map.
    held.to =
        closest.signed_distance > -least ? Vec3(closest.position - 1.05 * least * closest.pseudonormal) : now;
  }
}

void Fitter::State::report_landmarks() {
  double sum = 0, total = 0;
  std::vector<Vec3> bone;
  for (const LandmarkPair& pair : pairs)
    if (pair.generic->has_bone) bone.push_back(pair.generic->bone);
  bone = result.bone_map(std::span<const Vec3>(bone));
  result.landmarks.clear();
  result.landmark_max = 0;
  for (const LandmarkPair& pair : pairs) {
    if (!pair.generic->has_bone) continue;
    FittedLandmark landmark;
    landmark.name = pair.generic->name;
    landmark.skin = pair.target.skin;
    landmark.bone = bone[result.landmarks.size()];
    landmark.target = pair.bone_target();
    landmark.direction = pair.direction;
    landmark.depth = (landmark.skin - landmark.bone).norm();
    landmark.table_depth = pair.depth;
    landmark.table_deviation = pair.generic->depth_sd;
    landmark.residual = (landmark.bone - landmark.target).norm();
    landmark.confidence = pair.target.confidence;
    sum += landmark.confidence * landmark.residual * landmark.residual;
    total += landmark.confidence;
    if (landmark.confidence >= 0.5) result.landmark_max = std::max(result.landmark_max, landmark.residual);
    result.landmarks.push_back(landmark);
  }
  result.landmark_rms = std::sqrt(sum / total);
}

// Everything that follows from the warp.
void Fitter::State::finish() {
  constexpr double teeth_limit = 0.004;  // m; more would be a head whose lips are open
  const std::vector<Vec3> warped =
      moving ? system.positions(warp) : warp(std::span<const Vec3>(bones.generic));
  result.bone_map = BoneMap(warp, settled_patches(warp, patches));
  std::vector<Vec3> placed = vertex_map(bones, result.bone_map, warped);
  retract_teeth(*check, bones, vertex_map, warped, teeth_limit, result.bone_map, placed);
  place_meshes(*check, generic, bones, std::move(placed), result);
  report_landmarks();
  result.jaw = jaw_frame(generic, result.bone_map, result.similarity);
  result.warp = head_warp(pairs, result.bone_map);
  result.curve_points = static_cast<int>(curves.size());
  result.curve_points_used = static_cast<int>(
      std::count_if(curves.begin(), curves.end(), [](const CurvePoint& point) { return point.used; }));
  if (options.trim_uncovered) {
    if (!covered) covered = coverage(generic, bones, result.warp, skin);
    result.uncovered_share = covered->uncovered_share;
    trim(*covered, result);
  }
}

const FitResult& Fitter::State::update() {
  if (!moving) system.prepare(bones.generic);
  moving = true;
  result.similarity = start_pose(pairs);
  follow_skin();
  solve(2);
  finish();
  return result;
}

Fitter::Fitter(Generic generic, Exterior skin, const std::map<std::string, TargetLandmark>& landmarks,
               const FitOptions& options) {
  check_options(options);
  state_ = std::make_unique<State>(std::move(generic), std::move(skin), options);
  State& s = *state_;
  s.pairs = match_landmarks(s.generic, s.skin, landmarks, options, s.result.warnings);
  check_spread(s.pairs);
  s.result.similarity = start_pose(s.pairs);
  s.register_teeth();
  s.bones = gather(s.generic);
  s.check.emplace(s.skin, clearances(s.bones, s.patches, options),
                  outward_directions(s.bones, s.result.similarity));
  s.vertex_map = VertexMap(s.bones, s.patches);
  s.curves = curve_points(s.generic, options.curve_spacing);
  s.solve(std::max(0, options.normal_passes) + 1);
  s.hold_inside();
  s.head_warp = HeadWarp(s.generic, s.pairs);
  s.finish();
  if (s.result.bone_outside_skin > 0)
    s.result.warnings.push_back(
        std::to_string(s.result.bone_outside_skin) +
        " bone vertices could not be brought inside the skin; look at the landmarks near them");
  if (s.result.uncovered_share > 0)
    s.result.warnings.push_back(
        "the scan ends where " +
        std::to_string(static_cast<int>(std::lround(100 * s.result.uncovered_share))) +
        " % of the skull would lie; that part was left out");
}

Fitter::~Fitter() = default;
Fitter::Fitter(Fitter&&) noexcept = default;
Fitter& Fitter::operator=(Fitter&&) noexcept = default;

const FitResult& Fitter::result() const {
  return state_->result;
}

const FitResult& Fitter::move_landmark(const std::string& name, const Vec3& position) {
  if (!position.allFinite()) throw Error("skull: landmark " + name + " is not finite");
  for (LandmarkPair& pair : state_->pairs) {
    if (pair.generic->name != name) continue;
    pair.target.skin = position;
    if (pair.generic->has_bone) pair.skin_normal = mean_skin_normal(state_->skin.surface, position);
    return state_->update();
  }
  throw Error("skull: landmark " + name + " is not one of this fit's; make a new Fitter with it");
}

const FitResult& Fitter::set_tissue_scale(double scale) {
  check_scale(scale, "tissue scale");
  State& s = *state_;
  s.options.tissue_scale = scale;
  for (LandmarkPair& pair : s.pairs)
    pair.depth = scaled_depth(*pair.generic, s.options);
  s.check->set_clearance(clearances(s.bones, s.patches, s.options));
  return s.update();
}

const FitResult& Fitter::set_depth_scale(const std::string& name, double scale) {
  check_scale(scale, "depth scale of " + name);
  State& s = *state_;
  for (LandmarkPair& pair : s.pairs) {
    if (pair.generic->name != name) continue;
    s.options.depth_scale[name] = scale;
    pair.depth = scaled_depth(*pair.generic, s.options);
    return s.update();
  }
  throw Error("skull: landmark " + name + " is not one of this fit's; make a new Fitter with it");
}

FitResult fit(const Generic& generic, const Exterior& skin,
              const std::map<std::string, TargetLandmark>& landmarks, const FitOptions& options) {
  return Fitter(generic, skin, landmarks, options).result();
}

FitResult fit(const Generic& generic, const TriangleMesh& skin,
              const std::map<std::string, TargetLandmark>& landmarks, const FitOptions& options) {
  return fit(generic, exterior(skin), landmarks, options);
}

}  // namespace fascia::skull
