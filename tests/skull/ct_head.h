#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/landmarks/complete.h"
#include "builder/skull/skull.h"
#include "geometry/landmarks.h"

/// The truth of a real person: skin and bone of one head, from a CT scan.
namespace fascia::testing {

/// The CT head as a user would bring it, and its bone in the same frame. Metres, rig frame.
struct CtHead {
  TriangleMesh skin, bone;
  Mat4 scan_to_rig = Mat4::Identity();                   ///< from the scan's own millimetres
  Landmarks given;                                       ///< placed by hand
  std::map<std::string, skull::TargetLandmark> targets;  ///< these and the ones carried over
};

/// True when the scan is in `measured`/data/ct.
bool has_ct_head(const std::filesystem::path& measured);

/// Reads the scan and prepares it through the same stages as any head. `landmarks` is the file of placed
/// points.
CtHead read_ct_head(const std::filesystem::path& measured, const std::filesystem::path& landmarks,
                    const anatomy::GenericAnatomy& anatomy);

/// The targets that follow when only `given` is placed.
std::map<std::string, skull::TargetLandmark> complete_targets(const TriangleMesh& skin,
                                                              const Landmarks& given,
                                                              const anatomy::GenericAnatomy& anatomy);

/// A point of the skin over the facial skeleton, and how deep the true bone lies under it.
struct DepthSample {
  std::string region;
  Vec3 skin = Vec3::Zero(), inward = Vec3::Zero();
  double depth = 0;  ///< m along `inward`
};

/// Samples of the outer skin, about one a 4 mm cell, over the facial skeleton: a sample belongs to the region
/// of the nearest landmark. Left out are eyelids, soft nose, lips, ears and neck, 14 mm about the tube in the
/// mouth, 5 mm along the crop, and places where no bone lies within 30 mm.
std::vector<DepthSample> depth_samples(const CtHead& head);

/// How far a fitted skull is off, in metres.
struct DepthError {
  int samples = 0, missed = 0;  ///< missed: the ray met no fitted bone; the nearest counts
  double mean = 0;              ///< of |fitted depth - true depth|
  double bias = 0;              ///< of fitted depth - true depth: positive where the fit lies too deep
  double ninth_decile = 0;
};

/// By region, and under "all".
std::map<std::string, DepthError> depth_errors(const std::vector<DepthSample>& samples,
                                               const skull::FitResult& fit);

}  // namespace fascia::testing
