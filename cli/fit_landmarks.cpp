#include "cli/fit_landmarks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "builder/rigging/gltf_source.h"
#include "builder/spatial/surface_query.h"
#include "cli/still_landmarks.h"
#include "fit/live/landmark_sets.h"
#include "formats/landmark_file.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

using PlainJson = nlohmann::json;
using Points = std::map<std::string, Vec3>;

struct Frame {
  double time = 0.0;
  Points points;  ///< file's units
};

/// Frames of a file of landmarks; one for a file of one face.
struct LandmarkFrames {
  std::string units;
  std::vector<Frame> frames;
  bool is_take = false;
};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {}

  LandmarkFrames read() const {
    const std::vector<uint8_t> bytes = formats::read_bytes(path_);
    const PlainJson content = PlainJson::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (!content.is_object()) fail("it is not a JSON object");
    LandmarkFrames out;
    if (content.contains("frames")) {
      out.units = content.value("units", PlainJson()).is_string() ? content["units"].get<std::string>()
                                                                  : std::string();
      out.is_take = true;
      if (!content["frames"].is_array() || content["frames"].empty())
        fail("'frames' is not a list with entries");
      for (const PlainJson& entry : content["frames"])
        out.frames.push_back(frame(entry, "frame " + std::to_string(out.frames.size())));
      for (size_t f = 1; f < out.frames.size(); ++f)
        if (!(out.frames[f].time > out.frames[f - 1].time))
          fail("the times of its frames do not rise at frame " + std::to_string(f));
    } else if (content.contains("points")) {
      out.units = content.value("units", PlainJson()).is_string() ? content["units"].get<std::string>()
                                                                  : std::string();
      out.frames = {{0.0, by_number(content["points"], "'points'")}};
    } else {
      const formats::LandmarkFile file = formats::read_landmarks(path_);
      out.units = file.units;
      out.frames = {{0.0, file.points}};
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error("'" + path_.string() + "': " + what); }

  Vec3 point(const PlainJson& value, const std::string& where) const {
    Vec3 p = Vec3::Zero();
    if (!value.is_array() || value.size() != 3) fail(where + " is not three numbers");
    for (size_t k = 0; k < 3; ++k) {
      if (!value[k].is_number()) fail(where + " is not three numbers");
      p[static_cast<Eigen::Index>(k)] = value[k].get<double>();
    }
    if (!p.allFinite()) fail(where + " is not three finite numbers");
    return p;
  }

  /// The landmarks that a detector's points show; one whose points it has not all seen (null) is left out.
  Points by_number(const PlainJson& list, const std::string& where) const {
    static const auto sets = fit::landmark_sets();
    const auto set = std::find_if(sets.begin(), sets.end(), [&](const fit::LandmarkSet& known) {
      return list.is_array() && known.points == list.size();
    });
    if (set == sets.end())
      fail(where +
           " are not the 68 points of iBUG or the 478 of MediaPipe; give others by our names under "
           "'landmarks'");
    Points points;
    for (const fit::LandmarkSet::Entry& entry : set->entries) {
      if (std::any_of(entry.points.begin(), entry.points.end(),
                      [&](uint32_t p) { return list[p].is_null(); }))
        continue;
      Vec3 sum = Vec3::Zero();
      for (const uint32_t p : entry.points)
        sum += point(list[p], where + " " + std::to_string(p));
      points[entry.landmark] = sum / static_cast<double>(entry.points.size());
    }
    return points;
  }

  Frame frame(const PlainJson& entry, const std::string& where) const {
    if (!entry.is_object() || !entry.contains("time") || !entry["time"].is_number())
      fail(where + " has no 'time' in seconds");
    Frame out{entry["time"].get<double>(), {}};
    if (entry.contains("points"))
      out.points = by_number(entry["points"], "the points of " + where);
    else if (entry.contains("landmarks") && entry["landmarks"].is_object())
      for (const auto& [name, value] : entry["landmarks"].items())
        out.points[name] = point(value, "landmark '" + name + "' of " + where);
    else
      fail(where + " has neither 'points' nor 'landmarks'");
    return out;
  }

  std::filesystem::path path_;
};

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
  Points in_metres(const Points& file, const std::string& units) const {
    double scale = 1.0;  // from the file's units to the head file's
    const double head_unit = to_metres_.topLeftCorner<3, 1>().norm();
    for (const auto& [name, value] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}})
      if (units == name) scale = value / head_unit;
    Points out;
    for (const auto& [name, p] : file)
      if (places_.find(name)) out[name] = transform_point(to_metres_, scale * p - offset_);
    return out;
  }

  /// `points` against the face at rest: `neutral` where it is given, else the rig's own landmarks.
  fit::Target target(Points points, const Points& neutral) const {
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
        double& trust = out.trust[place.vertices[k]];
        out.displacements.segment<3>(at) =
            (trust * Vec3(out.displacements.segment<3>(at)) + share * moved) / (trust + share);
        trust += share;
      }
    }
    return out;
  }

 private:
  void take_out_head(Points& points, const Points& neutral) const {
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
  const auto file = std::make_shared<LandmarkFrames>(Reader(path).read());
  const auto rest = std::make_shared<Points>();
  if (!neutral.empty()) {
    const LandmarkFrames at_rest = Reader(neutral).read();
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
