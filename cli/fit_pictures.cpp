#include "cli/fit_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>

#include "cli/landmark_frames.h"
#include "cli/progress.h"
#include "fit/live/tracker.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

constexpr size_t fewest = 6;    // landmarks that tell where a head is before a camera
constexpr int most_steps = 30;  // of a picture

/// The landmarks that files show, on the rig's skin.
struct SeenLandmarks {
  std::vector<std::string> names;
  std::vector<fit::SkinPlace> places;
  size_t left_out = 0;

  SeenLandmarks(const LandmarkFrames& file, const fit::Subject& subject) {
    std::set<std::string> shown;
    for (const LandmarkFrame& frame : file.frames)
      for (const auto& [name, point] : frame.points)
        shown.insert(name);
    for (const std::string& name : shown) {
      const auto place = fit::place_of_landmark(subject.file(), subject.level(), name);
      if (!place) continue;
      names.push_back(name);
      places.push_back(*place);
    }
    left_out = shown.size() - names.size();
  }

  std::vector<fit::Landmark> carried(const fit::Subject& subject) const {
    std::vector<fit::Landmark> landmarks;
    for (const fit::SkinPlace& place : places)
      landmarks.push_back(fit::landmark_at(subject.file(), subject.level(), place));
    return landmarks;
  }
};

/// One picture's points in the order of the landmarks, and which of them are there.
struct SeenPoints {
  std::vector<Vec3> points;
  std::vector<double> weights;

  SeenPoints(const SeenLandmarks& landmarks, const Landmarks& named) {
    for (const std::string& name : landmarks.names) {
      const auto at = named.find(name);
      points.push_back(at == named.end() ? Vec3(Vec3::Zero()) : at->second);
      weights.push_back(at == named.end() ? 0.0 : 1.0);
    }
  }
};

fit::TrackerOptions tracker_options(const fit::FitOptions& chosen, const fit::Camera& camera) {
  const fit::FitOptions usual;
  fit::TrackerOptions options;
  if (chosen.ridge != usual.ridge) options.ridge = chosen.ridge;
  if (chosen.sparsity != usual.sparsity) options.sparsity = chosen.sparsity;
  if (chosen.smoothness != usual.smoothness) options.smoothness = chosen.smoothness;
  options.camera = camera;
  options.iterations = most_steps;
  options.may_take_time = true;
  return options;
}

/// A frame's result and, where its landmarks should be on the posed skin, its target.
struct PictureFrame {
  fit::FitResult result;
  fit::Target target;
  double motion = 0.0;
};

PictureFrame measured(fit::Subject& subject, const SeenLandmarks& landmarks, const SeenPoints& seen,
                      const fit::Tracked& tracked, const fit::Camera& camera, bool is_next) {
  PictureFrame out;
  fit::FitResult& result = out.result;
  result.activations = tracked.activations;
  subject.pose(result.activations, is_next);
  result.displacements = subject.displacements(result.activations);
  out.target = {result.displacements, std::vector<double>(subject.vertex_count(), 0.0), {}};
  fit::Misses misses;
  for (size_t l = 0; l < landmarks.places.size(); ++l) {
    if (!(seen.weights[l] > 0.0)) continue;
    const Vec3 gap = camera.across(seen.points[l], tracked.landmarks[l]) / tracked.head.scale;
    const double moved = camera.across(seen.points[l], tracked.at_rest[l]).norm() / tracked.head.scale;
    misses.add(gap.norm(), moved);
    const fit::SkinPlace& place = landmarks.places[l];
    for (size_t k = 0; k < 3; ++k) {
      const size_t vertex = subject.first_vertex(place.primitive) + place.vertices[k];
      if (place.shares[k] <= 0.0 || out.target.confidence[vertex] > 0.0) continue;
      out.target.displacements.segment<3>(static_cast<Eigen::Index>(3 * vertex)) +=
          tracked.head.rotation.transpose() * gap;
      out.target.confidence[vertex] = 1.0;
    }
  }
  misses.write(result);
  out.motion = misses.motion();
  return out;
}

void take_neutral(fit::Tracker& tracker, const SeenLandmarks& landmarks, const std::filesystem::path& path) {
  const LandmarkFrames file = read_landmark_frames(path);
  const SeenPoints seen(landmarks, file.frames.front().points);
  if (!file.is_flat || !tracker.take_neutral(seen.points, seen.weights))
    throw Error("'" + path.string() + "': it has too few points of two numbers to tell where the head is");
}

}  // namespace

fit::Camera camera_of(const std::string& words) {
  double focal = 0.0, x = 0.0, y = 0.0;
  char more = 0;
  if (std::sscanf(words.c_str(), "%lf,%lf,%lf%c", &focal, &x, &y, &more) != 3 || !std::isfinite(x) ||
      !std::isfinite(y) || !(focal > 0.0) || !std::isfinite(focal))
    throw Error("--camera '" + words +
                "' is not FOCAL,X,Y: focal length and centre of the picture in pixels, as 1400,640,360");
  return {focal, focal, x, y};
}

PictureFit fit_pictures(const Common& common, const std::filesystem::path& path,
                        const std::filesystem::path& neutral, const fit::Camera& camera,
                        fit::Subject& subject, const fit::FitOptions& options) {
  const LandmarkFrames file = read_landmark_frames(path);
  if (!file.is_flat)
    throw Error("'" + path.string() + "': its points have three numbers: they need no --camera");
  const SeenLandmarks landmarks(file, subject);
  if (landmarks.names.size() < fewest)
    throw Error("'" + path.string() +
                "': fewer than six of its landmarks lie on the rig's skin; 'fascia "
                "export --part landmarks' writes those that do, by name");
  if (landmarks.left_out > 0)
    common.warn(std::to_string(landmarks.left_out) + " landmarks are not among the rig's: left out");
  fit::Tracker tracker(subject.model(), subject.realtime_model(), subject.file().rig.actuation,
                       landmarks.carried(subject), tracker_options(options, camera));
  if (!neutral.empty()) take_neutral(tracker, landmarks, neutral);
  PictureFit out;
  out.targets.kind = file.is_take ? FitTargets::Kind::take : FitTargets::Kind::mesh;
  const auto targets = std::make_shared<std::vector<fit::Target>>();
  Progress progress(common, "fit", file.frames.size());
  for (size_t f = 0; f < file.frames.size(); ++f) {
    progress.step();
    const SeenPoints seen(landmarks, file.frames[f].points);
    const std::string name = file.is_take ? "frame " + std::to_string(f) : path.filename().string();
    tracker.follow(seen.points, seen.weights);
    if (f == 0 && tracker.result().seen == 0)
      throw Error("'" + path.string() + "': " + name + " has too few landmarks to tell where the head is");
    PictureFrame frame = measured(subject, landmarks, seen, tracker.result(), camera, f > 0);
    frame.result.iterations = tracker.result().steps;
    frame.result.converged = tracker.result().is_settled;
    if (!frame.result.converged) common.warn(name + ": still moving; what is found so far is written");
    out.targets.names.push_back(name);
    if (file.is_take) out.targets.times.push_back(file.frames[f].time);
    out.results.push_back(std::move(frame.result));
    out.motion.push_back(frame.motion);
    targets->push_back(std::move(frame.target));
  }
  out.targets.target = [targets](size_t index) { return (*targets)[index]; };
  return out;
}

}  // namespace fascia::cli
