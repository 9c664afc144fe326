#pragma once

#include <vector>

#include "fit/fit.h"

namespace fascia::fit {

struct ScanOptions {
  int rounds = 8;          ///< iterations of closest points
  bool moves_head = true;  ///< the scan's rigid motion is solved simultaneously
  double reach = 0.02;     ///< metres: farther points of the scan are not matched in the first iteration...
  double last_reach = 0.005;  ///< ...and in the last
  int samples = 4000;         ///< vertices matched, at most
  /// Times the penalties on activations: a scan's triangles are off its surface by more than nothing, the
  /// same way over whole regions, and so are matches that slide.
  double caution = 5.0;
};

struct ScanFit {
  Target target;     ///< the last round's matches
  FitResult result;  ///< its share, error and rms are of distances from the scan's surface
  Mat4 scan_to_head = Mat4::Identity();  ///< rigid motion of the scan onto the rig's head
  std::vector<double>
      distance;  ///< #vertices, metres across the scan's surface; not a number where not matched
  double matched_share = 0.0;  ///< of the outer skin's vertices, those that met the scan
};

/// Fits a face to a scan of any topology: iterative closest points with compatible normals, the head's pose
/// by point-to-plane distances (Chen & Medioni 1992), and Gauss-Newton steps in which matched vertices slide
/// over the scan. Matches are weighted by Tukey's biweight of their distance; points on the edge of the scan
/// are not matched.
///
/// `scan`: metres, rig frame, about where the head is (a few centimetres and some 20 degrees off at most),
/// normals outward. Throws fascia::Error when hardly anything of it lies near the head.
ScanFit fit_scan(Subject& subject, const TriangleMesh& scan, const FitOptions& fitting = {},
                 const ScanOptions& options = {});

}  // namespace fascia::fit
