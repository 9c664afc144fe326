#include "cli/fit_landmarks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "builder/rigging/gltf_source.h"
#include "builder/spatial/surface_query.h"
#include "cli/landmark_frames.h"
#include "cli/still_landmarks.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

/// Where our landmarks lie on the rig's skin.
class SkinLandmarks {
 public:
  struct Place {
    Vec3 rest = Vec3::Zero();          ///< metres
    std::array<size_t, 3> vertices{};  ///< of the subject
    Vec3 shares = Vec3::Zero();
    bool is_still = false;
  };

  explicit SkinLandmarks(const fit::Subject& subject) {
    TriangleMesh skin;
    for (size_t v = 0; v < subject.vertex_count(); ++v)
      skin.vertices.push_back(subject.rest().segment<3>(static_cast<Eigen::Index>(3 * v)));
    skin.triangles = subject.skin_triangles();
    const spatial::SurfaceQuery surface(skin);
    for (const rig::Landmark& landmark : subject.file().rig.skull.landmarks) {
      const spatial::ClosestPoint foot = surface.nearest_place(landmark.skin.cast<double>(), 0.01);
      if (!foot.found()) continue;
      Place place;
      place.rest = foot.position;
      place.shares = foot.surface.barycentric;
      const Triangle& t = skin.triangles[static_cast<size_t>(foot.surface.triangle)];
      for (size_t k = 0; k < 3; ++k)
        place.vertices[k] = static_cast<size_t>(t[k]);
      place.is_still =
          std::find(still_landmarks.begin(), still_landmarks.end(), landmark.name) != still_landmarks.end();
      places_[landmark.name] = place;
    }
  }

  const Place* find(const std::string& name) const {
    const auto at = places_.find(name);
    return at == places_.end() ? nullptr : &at->second;
  }

 private:
  std::map<std::string, Place> places_;
};

class LandmarkTargetMaker {
 public:
  LandmarkTargetMaker(const fit::Subject& subject, bool takes_out_head)
      : subject_(&subject),
        places_(subject),
        takes_out_head_(takes_out_head),
        offset_(rigging::input_offset(subject.file().source)),
        to_metres_(subject.file().rig.input_to_metres.cast<double>()) {}

  /// The file's points in metres, those only that the rig's skin has.
  Landmarks in_metres(const Landmarks& file, const std::string& units) const {
    double scale = 1.0;  // from the file's units to the head file's
    const double head_unit = to_metres_.topLeftCorner<3, 1>().norm();
    for (const auto& [name, value] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}})
      if (units == name) scale = value / head_unit;
    Landmarks out;
    for (const auto& [name, p] : file)
      if (places_.find(name)) out[name] = transform_point(to_metres_, scale * p - offset_);
    return out;
  }

  /// `points` against the face at rest: `neutral` where it is given, else the rig's own landmarks.
  fit::Target target(Landmarks points, const Landmarks& neutral) const {
    if (takes_out_head_) take_out_head(points, neutral);
    fit::Target out{Eigen::VectorXd::Zero(subject_->rest().size()),
                    std::vector<double>(subject_->vertex_count(), 0.0),
                    {}};
    for (const auto& [name, p] : points) {
      const SkinLandmarks::Place& place = *places_.find(name);
      const auto rest = neutral.find(name);
      if (!neutral.empty() && rest == neutral.end()) continue;
      const Vec3 moved = p - (neutral.empty() ? place.rest : rest->second);
      for (size_t k = 0; k < 3; ++k) {
        const double share = place.shares[static_cast<Eigen::Index>(k)];
        if (share <= 0.0) continue;
        const auto at = static_cast<Eigen::Index>(3 * place.vertices[k]);
        double& confidence = out.confidence[place.vertices[k]];
        out.displacements.segment<3>(at) =
            (confidence * Vec3(out.displacements.segment<3>(at)) + share * moved) / (confidence + share);
        confidence += share;
      }
    }
    return out;
  }

 private:
  void take_out_head(Landmarks& points, const Landmarks& neutral) const {
    std::vector<Vec3> from, to;
    for (const auto& [name, p] : points) {
      const SkinLandmarks::Place& place = *places_.find(name);
      if (!place.is_still) continue;
      const auto rest = neutral.find(name);
      if (!neutral.empty() && rest == neutral.end()) continue;
      from.push_back(p);
      to.push_back(neutral.empty() ? place.rest : rest->second);
    }
    if (from.size() < 4) return;
    const Mat4 back = rigid_motion(from, to);
    for (auto& [name, p] : points)
      p = transform_point(back, p);
  }

  const fit::Subject* subject_;
  SkinLandmarks places_;
  bool takes_out_head_;
  Vec3 offset_;  ///< of the rig's input, in its units
  Mat4 to_metres_;
};

}  // namespace

FitTargets landmark_targets(const Common& common, const std::filesystem::path& path,
                            const std::filesystem::path& neutral, const fit::Subject& subject,
                            const FitTargetOptions& options) {
  const auto maker = std::make_shared<LandmarkTargetMaker>(subject, options.head_pose != "fixed");
  const auto file = std::make_shared<LandmarkFrames>(read_landmark_frames(path));
  if (file->is_flat)
    throw Error("'" + path.string() +
                "': its points have two numbers, as those of a picture: say by --camera what took it");
  const auto rest = std::make_shared<Landmarks>();
  if (!neutral.empty()) {
    const LandmarkFrames at_rest = read_landmark_frames(neutral);
    *rest = maker->in_metres(at_rest.frames.front().points, at_rest.units);
    if (rest->size() < 4)
      throw Error("'" + neutral.string() + "': fewer than four of its landmarks are known");
  }
  const size_t known = maker->in_metres(file->frames.front().points, file->units).size();
  if (known < 4)
    throw Error("'" + path.string() +
                "': fewer than four of its landmarks lie on the rig's skin; 'fascia export --part "
                "landmarks' writes those that do, by name");
  if (known < file->frames.front().points.size())
    common.warn(std::to_string(file->frames.front().points.size() - known) +
                " landmarks are not among the rig's: left out");
  FitTargets targets;
  targets.kind = file->is_take ? FitTargets::Kind::take : FitTargets::Kind::mesh;
  for (size_t f = 0; f < file->frames.size(); ++f) {
    targets.names.push_back(file->is_take ? "frame " + std::to_string(f) : path.filename().string());
    if (file->is_take) targets.times.push_back(file->frames[f].time);
  }
  targets.target = [maker, file, rest](size_t f) {
    return maker->target(maker->in_metres(file->frames[f].points, file->units), *rest);
  };
  return targets;
}

}  // namespace fascia::cli
