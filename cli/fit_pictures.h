#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/fit_target.h"
#include "fit/live/head_pose.h"

namespace fascia::cli {

/// A camera from what the user says, FOCAL,X,Y: focal length and the centre of its picture in pixels. Throws
/// fascia::Error.
fit::Camera camera_of(const std::string& words);

/// What pictures of a face have told.
struct PictureFit {
  FitTargets targets;  ///< landmarks where the camera sees them, at the fitted face's depth
  std::vector<fit::FitResult> results;
  std::vector<double> motion;  ///< of the landmarks, by frame, square metres
};

/// Finds the activations behind landmarks in a picture, or in those of a take, with the head's pose before
/// the camera (fit::Tracker). `path` and `neutral` are files as `landmark_targets` takes them, their points
/// of two numbers: pixels to the right and down. A picture is followed until its activations settle, those
/// after it for two frames each. Misses are across the camera's rays, at the head's depth. Costs that
/// `options` leaves at their defaults are the tracker's own. `subject` must outlive the result. Throws
/// fascia::Error naming file and entry.
PictureFit fit_pictures(const Common& common, const std::filesystem::path& path,
                        const std::filesystem::path& neutral, const fit::Camera& camera,
                        fit::Subject& subject, const fit::FitOptions& options);

}  // namespace fascia::cli
